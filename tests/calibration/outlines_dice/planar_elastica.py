"""Edges of a bent cantilever from a planar elastica, without code of calibration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

Array = NDArray[np.float64]
GRAVITY = 9.81


def edges(*, young: float, density: float, length: float, radius: float) -> tuple[Array, Array]:
    """Upper and lower edge (60, 2) of x, z [m] of a round beam under its own weight, clamped at x = 0."""
    weight = density * np.pi * radius**2 * GRAVITY
    bending = young * np.pi * radius**4 / 4

    def slope(s: Array, y: Array) -> Array:
        return np.vstack([y[1], -weight * (length - s) / bending * np.cos(y[0])])

    s = np.linspace(0.0, length, 200)
    start = np.vstack([s / length, np.full_like(s, 1.0 / length)])
    found = solve_bvp(slope, lambda a, b: np.array([a[0], b[1]]), s, start, tol=1e-8)
    assert found.success
    fine = np.linspace(0.0, length, 4001)
    theta = -found.sol(fine)[0]  # angle of the tangent, positive upwards
    step = np.diff(fine, prepend=0.0)
    x, z = np.cumsum(step * np.cos(theta)), np.cumsum(step * np.sin(theta))
    pick = np.linspace(20, len(fine) - 1, 60).astype(int)
    normal = np.column_stack([-np.sin(theta), np.cos(theta)])
    line = np.column_stack([x, z])
    return (line + radius * normal)[pick], (line - radius * normal)[pick]
