"""Standard deviations of a coupon's points, from what the lab says or from the curve itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Where the lab gives no stress_sd, and the scatter grows with the stress: an error relative to it, which
# below FLOOR of the largest stress stays what it is there.
FLOOR = 0.05
# Nobody's area, gauge length and load cell are known better than this; curves drawn smooth look so. Of the
# largest stress: as a part of each it would be absurdly small near rest, where a record has many points, and
# these would decide which cause is named.
SMALLEST_RELATIVE = 0.005
ENOUGH = 24  # points that show whether their scatter grows with the stress,
CLEARLY = 2.0  # by this factor from the smaller half of the stresses to the larger
_NORMAL = 1.4826  # standard deviations in a median absolute deviation
_WINDOW = 0.15  # of the points, for the slope


def unstated_sd(over: Array, measured: Array, values: Array, count: Array | float = 1.0) -> Array:
    """Standard deviation of means (k,) of a curve whose error the lab does not state, at least
    SMALLEST_RELATIVE of its largest value.

    The scatter grows with the value where the curve shows that it does (`grows`), and is the same all along
    it otherwise.

    Parameters
    ----------
    over, measured : the curve, shape (n,).
    values, count : means of its points, and of how many each is.
    """
    largest = max(float(np.abs(measured).max(initial=0.0)), float(np.finfo(float).tiny))
    if grows(over, measured):
        one = relative_sd(over, measured) * np.maximum(np.abs(values), FLOOR * largest)
    else:
        left = _left(over, measured)
        one = np.full(np.shape(values), 0.0 if left is None else _NORMAL * float(np.median(left[0])))
    return np.asarray(np.maximum(one / np.sqrt(count), SMALLEST_RELATIVE * largest))


def grows(over: Array, measured: Array) -> bool:
    """True if the scatter of the larger half of a curve's values is clearly above that of the smaller."""
    left = _left(over, measured)
    if left is None or len(left[0]) < ENOUGH:
        return False
    smaller, larger = np.array_split(left[0][np.argsort(np.abs(left[1]))], 2)
    return bool(np.median(larger) > CLEARLY * np.median(smaller))


def relative_sd(stretch: Array, stress: Array) -> float:
    """Relative error of a curve, from its scatter about itself.

    Each inner point is compared with the cubic through its two neighbours on either side (points of one
    stretch are averaged first); 1.4826 times the median of what is left, at least SMALLEST_RELATIVE. A
    smooth curve shows its scatter only, not an error that all of its points share. Fewer than 8 different
    stretches: SMALLEST_RELATIVE.
    """
    found = _left(stretch, stress)
    if found is None:
        return SMALLEST_RELATIVE
    left, inner = found
    scale = np.maximum(np.abs(inner), FLOOR * float(np.abs(stress).max(initial=0.0)))
    return max(_NORMAL * float(np.median(left / np.maximum(scale, np.finfo(float).tiny))), SMALLEST_RELATIVE)


def _left(over: Array, measured: Array) -> tuple[Array, Array] | None:
    """What each inner point departs from the cubic through its neighbours, as large as an error of one point,
    and the measured values there; None of fewer than 8 different places."""
    x, first, counts = np.unique(over, return_inverse=True, return_counts=True)
    y = np.bincount(first, weights=measured) / counts
    if len(x) < 8:
        return None
    inner = np.arange(2, len(x) - 2)
    near = inner[:, None] + np.array([-2, -1, 1, 2])
    weight = np.ones((len(inner), 4))  # Lagrange's, at the point left out
    for i in range(4):
        for j in range(4):
            if j != i:
                weight[:, i] *= (x[inner] - x[near[:, j]]) / (x[near[:, i]] - x[near[:, j]])
    left = y[inner] - (weight * y[near]).sum(axis=1)
    spread = np.sqrt(1.0 / counts[inner] + (weight**2 / counts[near]).sum(axis=1))
    return np.abs(left) / spread, y[inner]


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
