"""Numerical rules that several packages share: lengths of polylines, correlated and robust errors, rms."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_NORMAL = 1.4826  # ratio of standard deviation to median absolute deviation, for normal errors


def arc_length(points: Array) -> Array:
    """Arc length of each point of a polyline (k, d) from its first point, shape (k,)."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def gaussian_correlation(s: Array, length: float) -> Array:
    """Correlations exp(-(s_i - s_j)^2 / (2 l^2)) of errors at positions s (k,), shape (k, k).

    The identity for a correlation length of 0.
    """
    if length <= 0.0:
        return np.eye(len(s))
    apart = s[:, None] - s[None, :]
    return np.asarray(np.exp(-(apart**2) / (2.0 * length**2)))


def robust_sd(errors: Array, *, axis: int | None = None) -> Array:
    """Standard deviation of normal errors about 0 from the median of their absolute values.

    Outliers in fewer than half of the errors do not dominate it.
    """
    return np.asarray(_NORMAL * np.median(np.abs(errors), axis=axis))


def rms_of(parts: Iterable[Array]) -> float:
    """Root mean square of all values of some arrays."""
    return float(np.sqrt(np.mean(np.concatenate([*parts]) ** 2)))
