"""The traced outline as the fit takes it: a point a millimetre, and how far to trust it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import Registration, TracedOutline
from calibration.photo._contour import Contour
from calibration.photo._edges import Edges
from calibration.photo._noise import edge_noise

Array = NDArray[np.float64]

_SPACING = 1e-3  # [m]
_SLOW = 0.010  # [m] over which an error of lens or shading holds on


def sample(
    edges: Edges, contour: Contour, origin: Array, registration: Registration, *, camera_error: float
) -> TracedOutline:
    """Points about 1 mm apart by local straight lines, ending at a free end's corners; specimen's frame [m].

    camera_error [m]: what the board's corners miss the camera's model by: it holds no better elsewhere.
    """
    lines = (edges.upper.outline - origin, edges.lower.outline - origin)
    upper, lower = (_thin(line) for line in lines)
    upper_noise, lower_noise = (edge_noise(line) for line in lines)
    if edges.end is not None:
        upper, lower = (
            np.vstack([line, corner - origin]) for line, corner in zip((upper, lower), edges.end, strict=True)
        )
    noise = np.sqrt(np.mean(np.square([upper_noise[0], lower_noise[0]])))
    length = 0.5 * (upper_noise[1] + lower_noise[1])
    # half of what two definitions of an edge disagree by
    doubt = 0.5 * float(np.sqrt(np.median(contour.half**2))) * contour.metres_per_pixel
    slow = float(np.hypot(doubt, camera_error))
    sd = float(np.hypot(noise, slow))
    correlation = (noise**2 * length + slow**2 * _SLOW) / sd**2
    return TracedOutline(
        upper=upper, lower=lower, sd=sd, correlation=float(correlation), registration=registration
    )


def _thin(line: Array) -> Array:
    """A point every millimetre, each by a straight line through its own millimetre."""
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    count = max(int(s[-1] / _SPACING), 2)
    at = np.linspace(0.0, s[-1], count + 1)
    half = 0.5 * s[-1] / count
    points = np.empty((len(at), 2))
    for k, centre in enumerate(at):
        near = np.abs(s - centre) <= half
        if near.sum() < 4:
            near = np.zeros(len(s), bool)
            near[np.argsort(np.abs(s - centre))[:4]] = True
        for axis in range(2):
            points[k, axis] = np.polyfit(s[near] - centre, line[near, axis], 1)[1]
    return points
