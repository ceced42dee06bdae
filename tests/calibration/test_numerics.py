"""Lengths of polylines, correlated errors and robust standard deviations."""

from __future__ import annotations

import numpy as np
import pytest

from calibration._numerics import arc_length, gaussian_correlation, robust_sd


def test_arc_length_is_summed_along_the_line_not_from_its_start() -> None:
    square = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 0.0], [0.0, 0.0]])
    np.testing.assert_allclose(arc_length(square), [0.0, 5.0, 9.0, 12.0], rtol=1e-15)
    assert arc_length(square[:1]).tolist() == [0.0]


def test_errors_a_correlation_length_apart_have_the_gaussian_s_value() -> None:
    found = gaussian_correlation(np.array([0.0, 2.0, 6.0]), 2.0)
    wanted = np.exp(-0.5 * np.square([[0.0, 1.0, 3.0], [1.0, 0.0, 2.0], [3.0, 2.0, 0.0]]))
    np.testing.assert_allclose(found, wanted, rtol=1e-14)
    np.testing.assert_array_equal(gaussian_correlation(np.arange(3.0), 0.0), np.eye(3))


def test_the_robust_sd_is_that_of_normal_errors_with_outliers_left_aside() -> None:
    errors = 0.3 * np.random.default_rng(5).standard_normal((2, 40_000))
    assert robust_sd(errors, axis=1) == pytest.approx([0.3, 0.3], rel=0.02)
    errors[:, :400] = 1e6
    assert float(robust_sd(errors)) == pytest.approx(0.3, rel=0.03)
