"""Profiled nuisances against the full covariance; an estimated delay against the true one."""

from __future__ import annotations

import numpy as np
import pytest

from calibration.measurements.release.objective import best_delay, profiled


def test_chi_square_is_that_of_the_whole_covariance():
    rng = np.random.default_rng(3)
    r, B = rng.normal(size=20), rng.normal(size=(20, 4))
    found = profiled(r, B)
    assert found.shape == (24,)
    assert found @ found == pytest.approx(r @ np.linalg.solve(np.eye(20) + B @ B.T, r), rel=1e-12)


def test_delay_past_the_neighbouring_periods():
    t = np.linspace(0.0, 1.0, 200)
    data = np.exp(-3.0 * (t - 0.0123)) * np.cos(40.0 * (t - 0.0123))
    found, left = best_delay(
        lambda d: data - np.exp(-3.0 * (t - d)) * np.cos(40.0 * (t - d)), -0.2, 0.2, 0.01
    )
    assert found == pytest.approx(0.0123, abs=1e-8)
    assert np.abs(left).max() < 1e-6
