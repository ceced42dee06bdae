from __future__ import annotations

import numpy as np
import pytest

from calibration.experiment.model import Registration, TracedOutline
from calibration.measurements._noise import Noise
from calibration.measurements.outlines._edges import Projection, project
from calibration.measurements.outlines._noise import (
    FLOOR,
    Nuisances,
    contour_root,
    registration_columns,
)


def straight(n: int = 30, length: float = 0.1) -> TracedOutline:
    x = np.linspace(0.006, length, n)
    return TracedOutline(
        upper=np.column_stack([x, np.full(n, 0.01)]),
        lower=np.column_stack([x, np.full(n, -0.01)]),
        sd=1e-4,
        correlation=5e-3,
        registration=Registration(shift=1e-4, roll=np.radians(0.15), scale=0.003),
    )


def test_the_covariance_is_that_of_the_format() -> None:
    outline = straight()
    root = contour_root(outline)
    C = root @ root.T
    s = outline.upper[:, 0]
    assert C[0, 0] == pytest.approx(1e-8 * (1 + FLOOR**2))
    assert C[3, 7] == pytest.approx(1e-8 * np.exp(-((s[7] - s[3]) ** 2) / (2 * 5e-3**2)), rel=1e-9)
    assert C[3, 30 + 3] == 0.0  # the two edges are independent draws


def test_arc_length_counts_not_x() -> None:
    outline = straight()
    steep = np.column_stack([outline.upper[:, 0] * 0.6, outline.upper[:, 0] * 0.8])
    bent = TracedOutline(upper=steep, lower=outline.lower, sd=1e-4, correlation=5e-3)
    root = contour_root(outline)
    assert np.allclose(contour_root(bent), root)


def test_whitened_draws_have_the_chi_square_they_should() -> None:
    outline = straight()
    root = contour_root(outline)
    rng = np.random.default_rng(0)
    noise = Noise.correlated(root @ root.T)
    chi2 = [np.sum(noise.whiten(root @ rng.standard_normal(60)) ** 2) for _ in range(400)]
    assert np.mean(chi2) == pytest.approx(60, abs=3 * np.sqrt(2 * 60 / 400))


def test_registration_columns_are_a_small_rigid_motion_and_a_stretch() -> None:
    edge = np.array([[0.0, 0.01], [0.05, 0.005], [0.1, -0.03]])
    points = np.array([[0.02, 0.0085], [0.07, -0.01], [0.09, -0.022]])
    r = Registration(shift=1e-6, roll=1e-6, scale=1e-6)
    base = project(points, edge)
    columns = registration_columns(base, r)
    c, s = np.cos(1e-6), np.sin(1e-6)
    moved = (
        points + np.array([1e-6, 0.0]),
        points + np.array([0.0, 1e-6]),
        points @ np.array([[c, -s], [s, c]]).T,
        points * (1 + 1e-6),
    )
    for k, p in enumerate(moved):
        # columns are taken at the projected point; the point itself is off by its distance
        assert np.allclose(
            project(p, edge).distance - base.distance, columns[:, k], atol=2e-8 * 0.1, rtol=0.02
        )


def test_projection_of_points_on_either_side_and_past_the_end() -> None:
    edge = np.array([[0.0, 0.0], [1.0, 0.0]])
    found = project(np.array([[0.5, 0.2], [0.5, -0.3], [1.5, 0.1]]), edge)
    assert isinstance(found, Projection)
    assert np.allclose(found.distance, [0.2, -0.3, 0.1])
    assert np.allclose(found.nearest, [[0.5, 0.0], [0.5, 0.0], [1.5, 0.0]])


def test_profiled_nuisances_give_the_chi_square_of_the_whole_covariance() -> None:
    rng = np.random.default_rng(2)
    columns = rng.standard_normal((40, 5)) * [5.0, 1.0, 0.2, 3.0, 0.01]
    nuisances = Nuisances(tuple("abcde"), columns)
    r = rng.standard_normal((3, 40)) + columns[:, 0]
    profiled = nuisances.profile(r)
    whole = np.linalg.inv(np.eye(40) + columns @ columns.T)
    expected = np.einsum("ij,jk,ik->i", r, whole, r)
    assert np.allclose((profiled**2).sum(axis=1), expected)
