"""Edges of a round cantilever that hangs under its own weight, from a planar elastica."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_bvp

RADIUS = 0.010


def elastica(
    shear_modulus: float, length: float, *, at: np.ndarray, curvature: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Upper and lower edge [mm], (k, 2) each, at these fractions (k,) of the length.

    Inextensible elastica E I theta'' = w (L - s) cos theta; theta is the downward slope, rho = 1000 kg/m3,
    E = 3 G. The stress-free shape is an arc of `curvature` [1/m], positive upwards.
    """
    stiffness = 3.0 * shear_modulus * np.pi * RADIUS**4 / 4.0
    weight = 1000.0 * 9.81 * np.pi * RADIUS**2

    def slopes(s: np.ndarray, y: np.ndarray) -> np.ndarray:
        pull = -weight * (length - s) * np.cos(y[0]) / stiffness
        return np.vstack([y[1], pull, np.cos(y[0]), -np.sin(y[0])])

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array([a[0], b[1] + curvature, a[2], a[3]])

    s = np.linspace(0.0, length, 201)
    found = solve_bvp(slopes, ends, s, np.zeros((4, len(s))), tol=1e-8)
    assert found.success
    theta, _, x, z = found.sol(at * length)
    middle, across = np.column_stack([x, z]), np.column_stack([np.sin(theta), np.cos(theta)])
    return 1e3 * (middle + RADIUS * across), 1e3 * (middle - RADIUS * across)
