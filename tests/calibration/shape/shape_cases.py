"""Edges of beams whose centre line is known in closed form; no code shared with the code under test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import TracedOutline

Array = NDArray[np.float64]
H = 0.010  # half height


def hanging(s: Array, *, length: float, drop: float) -> tuple[Array, Array]:
    """Line whose angle is -drop sin(pi s / 2 length): horizontal at the clamp, straight at its end."""
    grid = np.linspace(0.0, 1.2 * length, 20_001)
    angle = -drop * np.sin(np.pi * grid / (2 * length))
    step = np.diff(grid)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])[:-1]
    half = np.diff(grid)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])[1:]
    points = np.concatenate([[[0.0, 0.0]], np.cumsum((step + half) / 2, axis=0)])
    where = np.column_stack([np.interp(s, grid, c) for c in points.T])
    return where, -drop * np.sin(np.pi * s / (2 * length))


def traced(
    *,
    length: float = 0.1,
    drop: float = 0.8,
    counts: tuple[int, int] = (45, 38),
    noise: float = 0.0,
    correlation: float = 5e-3,
    seed: int = 0,
    margin: float = 1e-3,
) -> TracedOutline:
    """Edges at distance H from the hanging line, from `margin` to the free end, with noise along normals."""
    rng = np.random.default_rng(seed)
    edges = []
    for sign, count in zip((1.0, -1.0), counts, strict=True):
        s = np.linspace(margin, length, count)
        points, angle = hanging(s, length=length, drop=drop)
        normal = np.column_stack([-np.sin(angle), np.cos(angle)])
        run = s * 1.0
        cov = np.exp(-((run[:, None] - run) ** 2) / (2 * correlation**2)) + 1e-9 * np.eye(count)
        error = noise * np.linalg.cholesky(cov) @ rng.standard_normal(count)
        edges.append(points + (sign * H + error)[:, None] * normal)
    return TracedOutline(upper=edges[0], lower=edges[1], sd=noise, correlation=correlation)
