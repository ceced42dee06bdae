"""The stress in a rig that gives way: its strain is in proportion to the stress that it causes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEPS = 30
TOLERANCE = 1e-10  # of the stress, over the largest


def yielding(
    stresses: Callable[[Sequence[Array]], list[Array]], stretches: Sequence[Array], yields: Sequence[float]
) -> list[Array]:
    """Stress of each record [Pa] at its stretches less `yields` [1/Pa] times that stress, by a secant search;
    NaN where it does not end. stresses: of all records at their specimens' own stretches."""
    p = stresses(stretches)
    if not any(yields):
        return p
    p_before, left_before = [np.zeros(x.size) for x in p], [-x for x in p]
    size = max(float(np.nanmax(np.abs(x), initial=0.0)) for x in p) or 1.0
    for _ in range(STEPS):
        true = [s - c * x for s, c, x in zip(stretches, yields, p, strict=True)]
        left = [x - q for x, q in zip(p, stresses(true), strict=True)]
        if not max(float(np.max(np.abs(x), initial=0.0)) for x in left) > TOLERANCE * size:
            return p
        step = [
            -y * np.divide(x - xb, y - yb, out=np.zeros_like(x), where=y != yb)
            for x, xb, y, yb in zip(p, p_before, left, left_before, strict=True)
        ]
        p_before, left_before = p, left
        p = [x + d for x, d in zip(p, step, strict=True)]
    return [np.full(x.size, np.nan) for x in p]
