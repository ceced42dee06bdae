"""Graded spacings: along rays away from the rod, and down the columns of a block."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def graded(length: Floats, first: Floats | float, n: int) -> Floats:
    """Distances of n + 1 points along lines of given lengths, spacing growing by a constant factor.

    length [m], shape (...); first: first spacing [m], a scalar or of the same shape; where n first spacings
    overshoot, the spacing is uniform. Returns shape (..., n + 1), from 0 to exactly the length.
    """
    length = np.asarray(length, dtype=np.float64)
    first = np.minimum(np.broadcast_to(first, length.shape), length / n)
    target = length / first
    low, high = np.ones_like(length), np.full_like(length, 8.0)
    powers = np.arange(n)
    for _ in range(40):
        middle = 0.5 * (low + high)
        short = (middle[..., None] ** powers).sum(axis=-1) < target
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    steps = (0.5 * (low + high))[..., None] ** powers
    at = np.concatenate([np.zeros((*length.shape, 1)), np.cumsum(steps, axis=-1)], axis=-1)
    return at * (length / at[..., -1])[..., None]


def layer_count(*, height: float, top: float, bottom: float, total: float, start: float = 0.0) -> int:
    """Layers that fill `height` [m] starting `start` below the top, at least one.

    The thickness wanted grows linearly from `top` at the top to `bottom` at depth `total` [m].
    """
    slope = (bottom - top) / total
    at_start, at_end = top + slope * start, top + slope * (start + height)
    wanted = height / at_start if abs(slope) < 1e-12 else np.log(at_end / at_start) / slope
    return max(1, round(float(wanted)))
