"""The specimen's distance: what the boards say about lens and pose, and what the known diameter adds.

A specimen in front of the board looks larger by board distance / camera distance. Both are known with a
standard deviation (`Camera.focal_sd`, board_distance_sd); the diameter measured in the photograph against the
known one is one more observation of them. Gaussian update (an iterated Kalman step) of ln(focal length) and
the board's distance: well calibrated views leave little for the diameter to say, a single view square on to
the board leaves it all.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_STEPS = np.array([0.01, 1e-4])  # of the numerical derivative: ln(focal), metres
MEASURED = 0.003  # relative sd of the diameter: specimens thin as they stretch, edges are read to 0.02 mm


@dataclass(frozen=True, kw_only=True)
class Scale:
    """focal length [px] and y distance of the board [m] after the update; sd of the scale that is left."""

    focal: float
    distance: float
    sd: float


def settle(
    measure: Callable[[float, float], float],
    *,
    diameter: float,
    diameter_sd: float,
    focal: float,
    focal_sd: float,
    distance: float,
    distance_sd: float,
) -> Scale:
    """measure(focal, distance): the diameter that the photograph then shows [m]."""
    prior = np.array([np.log(focal), distance])
    spread = np.diag([max(focal_sd, 1e-6), max(distance_sd, 1e-7)]) ** 2
    noise = diameter_sd**2 + (MEASURED * diameter) ** 2

    def seen(p: Array) -> float:
        return measure(float(np.exp(p[0])), float(p[1]))

    p = prior.copy()
    for _ in range(8):
        here = seen(p)
        slope = np.array([(seen(p + step) - here) / step.sum() for step in np.diag(_STEPS)])
        gain = spread @ slope / (slope @ spread @ slope + noise)
        move = prior + gain * (diameter - here - slope @ (prior - p)) - p
        p = p + np.clip(move, [-0.5, -0.5 * distance], [0.5, 0.5 * distance])
        if np.abs(move / _STEPS).max() < 0.05:
            break
    left = spread - np.outer(gain, slope @ spread)
    variance = float(slope @ left @ slope) / diameter**2
    return Scale(focal=float(np.exp(p[0])), distance=float(p[1]), sd=float(np.sqrt(max(variance, 0.0))))
