"""How the cross-sections of a held beam stand to its mid line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def section_angle(s: Array, angle: Array, *, height: float, start: float | None, end: float | None) -> Array:
    """Angle [rad] of the sections' normals along a mid line of tangent `angle` (n,) at arc length s (n,) [m].

    start, end: arc length of the clamp faces, None where there is none. A section in a clamp face keeps that
    face's plane (x = constant, angle 0) and turns to stand across the mid line within one section height:
    the layer in which Saint-Venant's principle lets a clamp be felt.
    """
    share = np.ones_like(s)
    if start is not None:
        share = share * _smooth_step((s - start) / height)
    if end is not None:
        share = share * _smooth_step((end - s) / height)
    return np.asarray(angle * share)


def _smooth_step(x: Array) -> Array:
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))
