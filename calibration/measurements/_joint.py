"""Joint least squares over all coordinates of a model's baseline, with bounds on those of the law."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

Array = NDArray[np.float64]

STEPS, TRIES = 40, 8  # Gauss-Newton steps, and damping values tried per step
GAIN = 0.1  # smallest decrease of chi-square of a step; a smaller one ends the search
DAMPING, MORE, LESS = 1e-3, 10.0, 0.1
EDGE = 1e-9  # by which the bounds of a step are widened, so that the interval is not empty at a bound


def joint_fit(model: MeasurementModel, start: Array) -> Array:
    """Minimise chi-square from a start by damped Gauss-Newton steps within the bounds of the law; return u.

    The nuisances of the model stay fixed. Extras are fitted jointly with the law's coordinates, not profiled:
    in a free vibration, the modulus and the release time are too strongly correlated for alternating steps.
    ValueError if the start has no solution.
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
