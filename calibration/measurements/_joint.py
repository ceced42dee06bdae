"""Least squares over all coordinates of a model's baseline at once, the law's within their bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

Array = NDArray[np.float64]

STEPS, TRIES = 40, 8  # Gauss-Newton steps, and dampings tried for each
GAIN = 0.1  # [chi-square]: a step that gains less ends the search
DAMPING, MORE, LESS = 1e-3, 10.0, 0.1
EDGE = 1e-9  # that bounds of a step are wider, so that there is room at a bound


def joint_fit(model: MeasurementModel, start: Array) -> Array:
    """Coordinates u (n,) of least chi-square near a start, nuisances as the model has them: damped
    Gauss-Newton steps, each the least squares within the bounds of the law.

    Extras are moved with the law's coordinates, not profiled: along a vibration, a modulus and the time of
    the release are too much alike for the one to wait for the other. ValueError where the start has no
    answer.
    """
    n = len(start)
    low, high = np.full(n, -np.inf), np.full(n, np.inf)
    if model.baseline.whole:
        bounds = np.tile(model.baseline.law.bounds, (len(model.baseline.materials), 1))
        low[: len(bounds)], high[: len(bounds)] = bounds.T
    u, damping = np.clip(start, low, high), DAMPING
    for _ in range(STEPS):
        found = model.linearise(State(u=u), ())
        cost, gain = float(found.z @ found.z), 0.0
        lengths = np.linalg.norm(found.by_u, axis=0)
        for _ in range(TRIES):
            held = np.vstack([found.by_u, np.diag(np.sqrt(damping) * lengths)])
            aim = np.concatenate([-found.z, np.zeros(n)])
            tried = u + lsq_linear(held, aim, (low - u - EDGE, high - u + EDGE), method="bvls").x
            tried = np.clip(tried, low, high)
            z = model.residuals([State(u=tried)])[0]
            if np.isfinite(z).all() and z @ z < cost:
                u, gain, damping = tried, cost - float(z @ z), damping * LESS
                break
            damping *= MORE
        if gain < GAIN:
            break
    return np.asarray(u)
