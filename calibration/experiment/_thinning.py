"""Neighbouring rows of a long record put together, so that a fast ramp keeps its rows beside a long hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALL = 0.002  # fraction of its range below which a driven quantity has not moved
NOISE = 3.0  # the same, in standard deviations of its noise


def groups(driven: Array, most: int, *, sd: float = 0.0) -> NDArray[np.intp]:
    """First row of each of at most `most` groups of neighbouring rows.

    A group takes an equal share of the rows and of the way of the driven quantity together. By rows alone the
    whole ramp before a hold would be one group, whose mean stress is not that of its mean stretch.

    Parameters
    ----------
    driven : ndarray of float, shape (n,)
        Stretch or depth of each row.
    most : int
    sd : float
        Standard deviation of its noise.
    """
    n = driven.size
    if n <= most:
        return np.arange(n)
    way = travel(driven, max(SMALL * float(np.ptp(driven)), NOISE * sd))
    share = np.arange(n) / n
    if way[-1] > 0.0:
        share = 0.5 * (share + way / way[-1])
    number = np.minimum(np.floor(most * share), most - 1)
    return np.flatnonzero(np.diff(number, prepend=-1.0))


def travel(driven: Array, tolerance: float) -> Array:
    """Way of a quantity up to each row, without motion to and fro within `tolerance`, shape (n,)."""
    way, low, high = 0.0, driven[0] - 0.5 * tolerance, driven[0] + 0.5 * tolerance
    found = np.empty(driven.size)
    for k, value in enumerate(driven.tolist()):
        if value > high:
            way += value - high
            low, high = value - tolerance, value
        elif value < low:
            way += low - value
            low, high = value, value + tolerance
        found[k] = way
    return found
