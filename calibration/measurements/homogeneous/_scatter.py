"""Standard deviation of the stress of homogeneous tests, estimated from the scatter of the curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import mannwhitneyu

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
ENOUGH = 24  # least number of points to decide if the scatter grows with the stress:
CLEARLY = 2.0  # its ratio between the half with larger stresses and the half with smaller ones
CHANCE = 0.005
REACH = 10.0  # least half width of the window of the slope, in standard deviations of the stretch
_WINDOW = 0.15  # fraction of the points in the window of the slope


def unstated_sd(over: Array, measured: Array, values: Array, count: Array | float = 1.0) -> Array:
    """Standard deviation of means (k,) of a curve whose error the lab does not state.

    The error is proportional to the value if the scatter grows with it (`grows`), and constant otherwise. It
    is at least SMALLEST_RELATIVE of the largest value. The value is that of a smooth curve: with its own, a
    point that is too low would count more, and draw the fit down by twice the square of the relative error.

    Parameters
    ----------
    over, measured : abscissa and values of the curve, shape (n,).
    values, count : means of its points, shape (k,), and number of points in each mean.
    """
    largest = max(float(np.abs(measured).max(initial=0.0)), float(np.finfo(float).tiny))
    if grows(over, measured):
        smooth, _ = _local_line(np.arange(len(values), dtype=float), values, 0.0)
        one = relative_sd(over, measured) * np.maximum(np.abs(smooth), FLOOR * largest)
    else:
        left = _left(over, measured)
        one = np.full(np.shape(values), 0.0 if left is None else float(robust_sd(left[0])))
    return np.asarray(np.maximum(one / np.sqrt(count), SMALLEST_RELATIVE * largest))


def grows(over: Array, measured: Array) -> bool:
    """True if the larger half of a curve's |values| scatters over CLEARLY times as much as the smaller.

    And if chance makes that in fewer than CHANCE of curves with a constant scatter (Mann and Whitney 1947).
    """
    left = _left(over, measured)
    if left is None or len(left[0]) < ENOUGH:
        return False
    smaller, larger = np.array_split(left[0][np.argsort(np.abs(left[1]))], 2)
    if not np.median(larger) > CLEARLY * np.median(smaller):
        return False
    return bool(mannwhitneyu(larger, smaller, alternative="greater").pvalue < CHANCE)


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
    scale = np.maximum(np.abs(inner), FLOOR * float(np.abs(stress).max(initial=0.0)))
    return max(float(robust_sd(left / np.maximum(scale, np.finfo(float).tiny))), SMALLEST_RELATIVE)


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
