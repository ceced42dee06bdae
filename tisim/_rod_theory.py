"""Large-deflection start values: a planar, inextensible Euler-Bernoulli rod under weight and a tip force.

Nodes joined by stiff axial springs and bending springs; Newton on its energy, with load steps where the
whole load fails, serves both supports. The continuous rod obeys EI theta'' + V(s) x t = 0, V(s) the load
beyond s.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

Array = NDArray[np.float64]


def planar_rod(
    *,
    length: float,
    bending: float,
    stretching: float,
    line_load: tuple[float, float],
    tip_force: tuple[float, float],
    clamped_end: bool,
    segments: int = 60,
) -> tuple[Array, Array, Array]:
    """Equilibrium of a straight rod along the first axis of a plane, clamped at s = 0.

    bending EI [N m2], stretching EA [N]; line_load [N/m] and tip_force [N] as (along, across).
    Returns arc length s (k,), positions (k, 2) [m] and section angles (k,) [rad], k = segments + 1.
    A discrete rod of nodes with axial springs and bending springs.
    """
    h = length / segments
    rest = np.column_stack([np.linspace(0.0, length, segments + 1), np.zeros(segments + 1)])
    load = np.tile(np.asarray(line_load, dtype=float) * h, (segments + 1, 1))
    load[0] *= 0.5
    load[-1] *= 0.5
    load[-1] += tip_force
    # ghost nodes one segment beyond each clamp hold its direction
    x = rest.copy()
    free = slice(1, segments) if clamped_end else slice(1, segments + 1)
    factor, step = 0.0, 1.0
    while factor < 1.0 and step > 1e-3:
        target = min(1.0, factor + step)
        trial = _equilibrium(x, target * load, h, bending, stretching, free, clamped_end)
        if trial is None:
            step *= 0.5
        else:
            x, factor = trial, target
            step *= 2.0
    edges = np.diff(x, axis=0)
    angle = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
    theta = np.empty(segments + 1)
    theta[1:-1] = 0.5 * (angle[1:] + angle[:-1])
    theta[0] = 0.0
    theta[-1] = 0.0 if clamped_end else angle[-1] + 0.5 * (angle[-1] - theta[-2])
    return rest[:, 0], x, theta


def _equilibrium(
    x: Array, load: Array, h: float, ei: float, ea: float, free: slice, clamped_end: bool
) -> Array | None:
    """Newton for the discrete rod; None where it does not converge."""
    x = x.copy()
    scale = np.linalg.norm(load) + 1e-12
    for _ in range(60):
        force, band = _forces(x, h, ei, ea, clamped_end)
        residual = (force - load)[free].ravel()
        if np.linalg.norm(residual) < 1e-5 * scale:
            return x
        n = residual.size
        ab = np.zeros((11, n))
        first = 2 * free.start
        for k in range(-5, 6):
            row = band[5 - k, first : first + n]
            ab[5 - k] = row
        step = solve_banded((5, 5), ab, -residual)
        if not np.isfinite(step).all():
            return None
        peak = np.abs(step).max()
        x[free] += (min(1.0, 2.0 * h / peak) * step).reshape(-1, 2)
    return None


def _forces(x: Array, h: float, ei: float, ea: float, clamped_end: bool) -> tuple[Array, Array]:
    """Internal forces (k, 2) and the banded tangent (11, 2k) of the discrete rod.

    Stretch energy EA/(2h) (|e| - h)^2 an edge; bending EI/(2h^3) |x_(i-1) - 2 x_i + x_(i+1)|^2 a node,
    which for edges of length h is EI/h (1 - cos turn).
    """
    ghost0 = x[:1] - np.array([[h, 0.0]])
    points = np.vstack([ghost0, x])
    if clamped_end:
        points = np.vstack([points, x[-1:] + np.array([[h, 0.0]])])
    k = len(x)
    force = np.zeros_like(points)
    c = ei / h**3
    lap = points[:-2] - 2 * points[1:-1] + points[2:]
    force[:-2] += c * lap
    force[1:-1] -= 2 * c * lap
    force[2:] += c * lap
    edges = np.diff(points, axis=0)
    size = np.linalg.norm(edges, axis=1)
    t = edges / size[:, None]
    pull = ea / h * (size - h)
    force[:-1] -= pull[:, None] * t
    force[1:] += pull[:, None] * t
    tt = t[:, :, None] * t[:, None, :]
    stiff = ea / h * tt + (pull / size)[:, None, None] * (np.eye(2) - tt)
    band = _bending_band(len(points), c).copy()
    for a, b in ((0, 0), (0, 1), (1, 0), (1, 1)):
        _add(band, 0, 0, a, b, stiff[:, a, b])
        _add(band, 1, 1, a, b, stiff[:, a, b])
        _add(band, 0, 1, a, b, -stiff[:, a, b])
        _add(band, 1, 0, a, b, -stiff[:, a, b])
    return force[1 : 1 + k], band[:, 2 : 2 + 2 * k]


@lru_cache(maxsize=32)
def _bending_band(points: int, stiffness: float) -> Array:
    """The bending springs' part of the tangent, which no motion changes; (11, 2 points)."""
    band = np.zeros((11, 2 * points))
    ones = np.full(points - 2, stiffness)
    coefficient = (1.0, -2.0, 1.0)
    for p in range(3):
        for q in range(3):
            for a in range(2):
                _add(band, p, q, a, a, coefficient[p] * coefficient[q] * ones)
    return band


def _add(band: Array, i: int, j: int, a: int, b: int, values: Array) -> None:
    """values (n,) to the entries (component a of point i + k, component b of point j + k), k = 0 to n - 1."""
    first = 2 * j + b
    band[5 + 2 * (i - j) + a - b, first : first + 2 * len(values) : 2] += values
