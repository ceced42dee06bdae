"""z = 0: the height of the beam's axis where it leaves the clamp."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.photo._edges import Edges

Array = NDArray[np.float64]

_SLOPE_SD = 0.02  # of the axis in the clamp's face: a held beam leaves level, give or take its clamp
_EDGE_SD = 3e-5  # [m], of the axis over one correlation length
_CORRELATION = 0.002  # [m]


def axis_height(edges: Edges, x0: float, height: float) -> tuple[float, float]:
    """z of the axis at x = x0 [m] and its sd: a cubic through the first two heights of the beam.

    height: of the section [m].
    """
    axis = np.concatenate([edges.upper.axis, edges.lower.axis])
    near = axis[axis[:, 0] < x0 + 2.0 * height]
    x, z = (near[:, 0] - x0) / height, near[:, 1]
    count = max(1.0, _CORRELATION / (float(np.ptp(near[:, 0])) * 2 / len(near)))
    weight = 1.0 / (_EDGE_SD * np.sqrt(count))
    terms = np.column_stack([np.ones(len(x)), x, x**2, x**3]) * weight
    prior = np.array([[0.0, 1.0 / (_SLOPE_SD * height), 0.0, 0.0]])
    matrix = np.vstack([terms, prior])
    value = np.concatenate([z * weight, [0.0]])
    fit = np.linalg.lstsq(matrix, value, rcond=None)[0]
    covariance = np.linalg.inv(matrix.T @ matrix)
    return float(fit[0]), float(np.sqrt(covariance[0, 0]))
