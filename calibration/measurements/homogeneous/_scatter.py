"""Standard deviations of a coupon's points, from what the lab says or from the curve itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Where the lab gives no stress_sd: an error relative to the stress, which below FLOOR of the largest stress
# stays what it is there (a load cell and a digitised figure have an error of their range).
FLOOR = 0.05
# Nobody's area, gauge length and load cell are known better than this; curves drawn smooth look so. Of the
# largest stress: as a part of each it would be absurdly small near rest, where a record has many points, and
# these would decide which cause is named.
SMALLEST_RELATIVE = 0.005
_WINDOW = 0.15  # of the points, for the slope


def scatter_scale(stress: Array) -> Array:
    """What the relative error is relative to [Pa], (k,): |stress|, at least FLOOR of the largest."""
    size = np.abs(stress)
    return np.maximum(size, max(FLOOR * float(size.max(initial=0.0)), np.finfo(float).tiny))


def unstated_sd(relative: Array | float, stress: Array, largest: float) -> Array:
    """Standard deviation [Pa], (k,), of points whose error the lab does not state: their scatter relative to
    the stress, at least SMALLEST_RELATIVE of the curve's largest stress."""
    size = np.maximum(np.abs(stress), FLOOR * largest)
    return np.asarray(np.maximum(relative * size, SMALLEST_RELATIVE * largest))


def relative_sd(stretch: Array, stress: Array) -> float:
    """Relative error of a curve, from its scatter about itself.

    Each inner point is compared with the cubic through its two neighbours on either side (points of one
    stretch are averaged first); 1.4826 times the median of what is left, at least SMALLEST_RELATIVE. A
    smooth curve shows its scatter only, not an error that all of its points share. Fewer than 8 different
    stretches: SMALLEST_RELATIVE.
    """
    x, first, counts = np.unique(stretch, return_inverse=True, return_counts=True)
    y = np.bincount(first, weights=stress) / counts
    if len(x) < 8:
        return SMALLEST_RELATIVE
    inner = np.arange(2, len(x) - 2)
    near = inner[:, None] + np.array([-2, -1, 1, 2])
    weight = np.ones((len(inner), 4))  # Lagrange's, at the point left out
    for i in range(4):
        for j in range(4):
            if j != i:
                weight[:, i] *= (x[inner] - x[near[:, j]]) / (x[near[:, i]] - x[near[:, j]])
    left = y[inner] - (weight * y[near]).sum(axis=1)
    spread = np.sqrt(1.0 / counts[inner] + (weight**2 / counts[near]).sum(axis=1))
    found = 1.4826 * float(np.median(np.abs(left) / (spread * scatter_scale(y)[inner])))
    return max(found, SMALLEST_RELATIVE)


def slope(stretch: Array, stress: Array) -> Array:
    """d stress / d stretch of the measured curve [Pa], (k,): lines fitted to the nearest points, weighted by
    distance (tricube), over 15 % of the points and at least 5."""
    k = len(stretch)
    take = min(k, max(5, int(np.ceil(_WINDOW * k))))
    distance = np.abs(stretch[:, None] - stretch[None, :])
    reach = np.sort(distance, axis=1)[:, take - 1] * 1.001
    if not (reach > 0.0).all():
        return np.zeros(k)
    weight = np.clip(1.0 - (distance / reach[:, None]) ** 3, 0.0, None) ** 3
    total = weight.sum(axis=1)
    x_mean, y_mean = weight @ stretch / total, weight @ stress / total
    dx = stretch[None, :] - x_mean[:, None]
    spread = (weight * dx**2).sum(axis=1)
    moment = (weight * dx * (stress[None, :] - y_mean[:, None])).sum(axis=1)
    return np.divide(moment, spread, out=np.zeros(k), where=spread > 0.0)
