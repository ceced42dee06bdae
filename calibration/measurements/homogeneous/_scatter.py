"""Standard deviation of the stress of homogeneous tests, estimated from the scatter of the curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import robust_sd

Array = NDArray[np.float64]

# If the lab gives no stress_sd, and the scatter grows with the stress: the error is relative to the stress,
# and constant below FLOOR of the largest stress.
FLOOR = 0.05
# Least error as a fraction of the largest stress: areas, gauge lengths and load cells are not known better,
# though smoothed curves look so. Relative to each stress it would be too small near rest, where a record has
# many points, and these would decide which cause is named.
SMALLEST_RELATIVE = 0.005
FEWEST = 8  # different abscissae from which a scatter about a smooth curve is found at all
# Least difference of two log-likelihoods by which the scatter grows with the stress. A constant scatter gives
# it in fewer than 1 % of curves of 30 points, and in none of 1,000 of 120 points
# (studies/diagnosis/unstated-noise.md): residuals of neighbours have points in common.
CLEARLY = 4.0
REACH = 10.0  # least half width of the window of the slope, in standard deviations of the stretch
_WINDOW = 0.15  # fraction of the points in the window of the slope


def unstated_sd(
    over: Array, measured: Array, values: Array, count: Array | float = 1.0, *, relative: bool
) -> Array:
    """Standard deviation of means (k,) of a curve whose error the lab does not state.

    It is at least SMALLEST_RELATIVE of the largest value.

    Parameters
    ----------
    over, measured : abscissa and values of the curve, shape (n,).
    values, count : means of its points, shape (k,), and number of points in each mean.
    relative : True for an error in proportion to the value (`grows`), False for a constant one. The value is
        that of a smooth curve: with its own, a point that is too low would count more, and draw the fit down
        by twice the square of the relative error.
    """
    largest = max(float(np.abs(measured).max(initial=0.0)), float(np.finfo(float).tiny))
    if relative:
        smooth, _ = _local_line(np.arange(len(values), dtype=float), values, 0.0)
        one = relative_sd(over, measured) * np.maximum(np.abs(smooth), FLOOR * largest)
    else:
        left = _left(over, measured)
        one = np.full(np.shape(values), 0.0 if left is None else float(robust_sd(left[0])))
    return np.asarray(np.maximum(one / np.sqrt(count), SMALLEST_RELATIVE * largest))


def grows(curves: Sequence[tuple[Array, Array]]) -> bool:
    """True if the scatter of the curves of one record grows with the value.

    The absolute residuals r are compared as exponential variables of a mean in proportion to the absolute
    value v (at least FLOOR of the largest) and of a constant mean, both of the greatest likelihood: the
    logarithms of the likelihoods differ by n (ln <r> - ln <r / v> - <ln v>), where <> is the mean over the n
    points of all curves. The difference is to be more than CLEARLY.

    Parameters
    ----------
    curves : abscissa and values of each curve, shape (n,).
    """
    found = [left for over, measured in curves if (left := _left(over, measured)) is not None]
    if not found:
        return False
    r = np.concatenate([left for left, _ in found])
    v = _size(np.concatenate([inner for _, inner in found]), np.concatenate([y for _, y in curves]))
    if not r.any():
        return False
    better = len(r) * (np.log(r.mean()) - np.log((r / v).mean()) - np.log(v).mean())
    return bool(better > CLEARLY)


def relative_sd(stretch: Array, stress: Array) -> float:
    """Relative error of a curve from its scatter.

    Each inner point is compared with the cubic through its two neighbours on either side (points of equal
    stretch are averaged first). The error is the robust standard deviation of the residuals over the stress,
    at least SMALLEST_RELATIVE; SMALLEST_RELATIVE for fewer than FEWEST different stretches. It does not
    include an error that all points share.
    """
    found = _left(stretch, stress)
    if found is None:
        return SMALLEST_RELATIVE
    left, inner = found
    return max(float(robust_sd(left / _size(inner, stress))), SMALLEST_RELATIVE)


def _size(values: Array, curve: Array) -> Array:
    """Absolute values, at least FLOOR of the largest of their curve, and more than 0."""
    least = max(FLOOR * float(np.abs(curve).max(initial=0.0)), float(np.finfo(float).tiny))
    return np.asarray(np.maximum(np.abs(values), least))


def _left(over: Array, measured: Array) -> tuple[Array, Array] | None:
    """|residual| of each inner point from the cubic through its neighbours, and the measured values there.

    Residuals are scaled to the standard deviation of one point. None for fewer than FEWEST abscissae.
    """
    x, first, counts = np.unique(over, return_inverse=True, return_counts=True)
    y = np.bincount(first, weights=measured) / counts
    if len(x) < FEWEST:
        return None
    inner = np.arange(2, len(x) - 2)
    near = inner[:, None] + np.array([-2, -1, 1, 2])
    weight = np.ones((len(inner), 4))  # Lagrange weights at the point left out
    for i in range(4):
        for j in range(4):
            if j != i:
                weight[:, i] *= (x[inner] - x[near[:, j]]) / (x[near[:, i]] - x[near[:, j]])
    left = y[inner] - (weight * y[near]).sum(axis=1)
    spread = np.sqrt(1.0 / counts[inner] + (weight**2 / counts[near]).sum(axis=1))
    return np.abs(left) / spread, y[inner]


def slope(stretch: Array, stress: Array, stretch_sd: float = 0.0) -> Array:
    """d stress / d stretch of the measured curve [Pa], shape (k,), by local linear regression.

    The window has the nearest 15 % of the points, at least 5, and those within REACH `stretch_sd`, with
    tricube weights: in a narrower one the stretch error would flatten the slope.
    """
    return _local_line(stretch, stress, REACH * stretch_sd)[1]


def _local_line(x: Array, y: Array, least: float) -> tuple[Array, Array]:
    """Value and slope of the local linear regression of y at each x, shape (k,); see `slope`.

    least : least half width of the window.
    """
    k = len(x)
    take = min(k, max(5, int(np.ceil(_WINDOW * k))))
    distance = np.abs(x[:, None] - x[None, :])
    reach = np.maximum(np.sort(distance, axis=1)[:, take - 1] * 1.001, least)
    if not (reach > 0.0).all():
        return y.copy(), np.zeros(k)
    weight = np.clip(1.0 - (distance / reach[:, None]) ** 3, 0.0, None) ** 3
    total = weight.sum(axis=1)
    x_mean, y_mean = weight @ x / total, weight @ y / total
    dx = x[None, :] - x_mean[:, None]
    spread = (weight * dx**2).sum(axis=1)
    moment = (weight * dx * (y[None, :] - y_mean[:, None])).sum(axis=1)
    slopes = np.divide(moment, spread, out=np.zeros(k), where=spread > 0.0)
    return y_mean + slopes * (x - x_mean), slopes
