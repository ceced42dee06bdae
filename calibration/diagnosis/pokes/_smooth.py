"""Depth without its reading noise: rods are driven smoothly, and what is simulated at noisy depths is noisy
too.

Otherwise the noise of the depth would be in the simulated force and in all that is fitted to the measured
one: it would be found again as a departure.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._phases import Phase

Array = NDArray[np.float64]

MOST = 6  # highest degree of a phase's depth in time
LEAST = 8  # samples that a phase needs to be smoothed
AGREES = 1.3  # rms of the depth about the smooth one, over what the lab says of its noise


def smooth_depth(
    time: Array, depth: Array, phases: Sequence[Phase], sd: float
) -> tuple[Array, tuple[int, ...]]:
    """Depth [m] (k,) as the polynomial in time, of the lowest degree that agrees with the stated noise, of
    each phase; and these degrees, -1 where none agrees: there the depth stays, with its noise."""
    found, degrees = depth.copy(), []
    for p in phases:
        t, d = time[p.points], depth[p.points]
        degrees.append(-1)
        for degree in range(min(MOST, d.size // 3) + 1) if sd > 0.0 and d.size >= LEAST else ():
            line = np.polynomial.Legendre.fit(t, d, degree)(t)
            rms = float(np.sqrt(np.sum((d - line) ** 2) / (d.size - degree - 1)))
            if rms <= AGREES * sd:
                found[p.points] = line
                degrees[-1] = degree
                break
    return found, tuple(degrees)


def left_over(time: Array, samples: int, degree: int) -> Array:
    """(k, degree + 1): what one standard deviation of the noise leaves of it in each coefficient of a smooth
    phase, at some of its times (k,), in parts of the noise of a sample."""
    low, high = float(time.min()), float(time.max())
    unit = 2.0 * (time - low) / (high - low) - 1.0 if high > low else np.zeros(time.size)
    each = np.sqrt((2.0 * np.arange(degree + 1) + 1.0) / samples)
    return np.asarray(np.polynomial.legendre.legvander(unit, degree) * each)
