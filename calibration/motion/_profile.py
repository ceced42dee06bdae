"""A release time and linear nuisances, put at their best under their priors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]


def profiled(residual: Array, columns: Array) -> Array:
    """min over q of |residual - columns q|^2 + |q|^2: the residuals left (n,), then q (k,).

    residual (n,) whitened; columns (n, k): what one sd of each nuisance adds to the model. The sum of squares
    is chi-square under the covariance 1 + columns columns^T.
    """
    system = columns.T @ columns + np.eye(columns.shape[1])
    q = np.linalg.solve(system, columns.T @ residual)
    return np.concatenate([residual - columns @ q, q])


def best_delay(
    residuals: Callable[[float], Array], low: float, high: float, step: float
) -> tuple[float, Array]:
    """The delay in [low, high] with the least sum of squares, to a nanosecond, and the residuals there.

    A scan in `step` [s] first: a swing shifted by a period is a local minimum too.
    """

    def cost(delay: float) -> float:
        return float(np.square(residuals(delay)).sum())

    grid = np.linspace(low, high, max(int(np.ceil((high - low) / step)), 2) + 1)
    k = int(np.argmin([cost(float(d)) for d in grid]))
    left, right = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    found = minimize_scalar(cost, bounds=(left, right), method="bounded", options={"xatol": 1e-9})
    return float(found.x), residuals(float(found.x))
