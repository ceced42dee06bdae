"""What is left of a traced edge about a smooth line: its noise, and over what length that holds together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_lsq_spline

Array = NDArray[np.float64]

_KNOTS = 0.010  # [m]: a beam bends smoothly over that


def edge_noise(points: Array) -> tuple[float, float]:
    """sd [m] across an edge (k, 2) [m] about a smooth line, and Gaussian correlation length [m] along it."""
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    inner = np.linspace(0.0, s[-1], max(int(s[-1] / _KNOTS), 1) + 1)[1:-1]
    knots = np.concatenate([[0.0] * 4, inner, [s[-1]] * 4])
    line = make_lsq_spline(s, points, knots, k=3)
    along = line.derivative()(s)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    off = points - line(s)
    left = along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]
    sd = float(np.sqrt((left**2).sum() / max(len(s) - len(knots) + 4, 1)))
    step = float(np.diff(s).mean())
    lags = np.arange(1, max(2, min(len(s) // 4, int(0.5 * _KNOTS / step))))
    variance = float((left**2).mean())
    if variance == 0.0:
        return 0.0, step
    together = np.array([(left[k:] * left[:-k]).mean() for k in lags]) / variance
    below = np.flatnonzero(together < np.exp(-0.5))
    return sd, float(lags[below[0] if len(below) else -1] * step)
