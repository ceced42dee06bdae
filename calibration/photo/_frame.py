"""The specimen's frame in a photograph: x = 0 at the clamp's face, z = 0 on the axis, and the scale.

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

from calibration._numerics import robust_sd
from calibration.photo._camera import View
from calibration.photo._contour import refine
from calibration.photo._foreground import Clamp, Foreground, show_body
from calibration.photo._image import Grey, PhotoProblem
from calibration.photo._silhouette import Edges

Array = NDArray[np.float64]

_GAP = 0.0012  # left out next to the beam and to the clamp's corners [m]
_LEAN = np.radians(3.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Face:
    """x of the clamp's face in the board frame at the beam's height [m], its sd, how far it leans off the
    board's vertical [rad], and the edge points it rests on [px]."""

    x: float
    sd: float
    lean: float
    pixels: Array


def find_face(
    image: Grey,
    found: Foreground,
    label: int,
    view: View,
    clamp: Clamp,
    *,
    plane: float,
    front: float | None,
    back: float,
) -> Face:
    """The face's x; front, back: y of the clamp's edges in the board frame [m].

    A camera to the right of the face sees the face, and its far edge (back) before the background; one to the
    left sees the near edge (front). Raises PhotoProblem where the edge is not there or leans.
    """
    edge_y = back if view.eye[0] > clamp.x else front
    if edge_y is None:
        raise PhotoProblem(
            "the camera stands to the left of the clamp's face, whose near edge is not known: expected "
            "clamp_front_mm or board_corner_mm in photographs.yaml, or a camera further to the right",
            show_body(image, found, label),
        )
    step = 0.0001
    pieces = []
    ranges = (
        (clamp.beam_z[1] + _GAP, clamp.clamp_z[1] - _GAP),
        (clamp.clamp_z[0] + _GAP, clamp.beam_z[0] - _GAP),
    )
    for low, high in ranges:
        if high - low < 0.0015:
            continue
        z = np.arange(low, high, step)
        rough = view.project(np.column_stack([np.full(len(z), clamp.x), np.full(len(z), plane), z]))
        edge = refine(image, rough)
        pieces.append(edge.points[edge.found])
    pixels = np.concatenate(pieces) if pieces else np.zeros((0, 2))
    if len(pixels) < 20:
        raise PhotoProblem(
            "the clamp's face was not found: no clear edge above or below the beam",
            show_body(image, found, label),
        )
    seen = view.on_plane(pixels, edge_y)
    middle = 0.5 * sum(clamp.beam_z)
    slope, x = _robust_line(seen[:, 1] - middle, seen[:, 0])
    left = np.abs(seen[:, 0] - x - slope * (seen[:, 1] - middle))
    if abs(slope) > np.tan(_LEAN):
        raise PhotoProblem(
            f"the clamp's face leans {np.degrees(np.arctan(slope)):.1f} degrees off the board's vertical, "
            f"expected at most {np.degrees(_LEAN):.0f}: hang the board parallel to the clamp",
            show_body(image, found, label),
        )
    # points along an edge err together: a tenth of them count
    sd = float(robust_sd(left)) / np.sqrt(max(len(left) / 10, 1.0)) + 5e-6
    return Face(x=x, sd=sd, lean=float(np.arctan(slope)), pixels=pixels)


def _robust_line(z: Array, x: Array) -> tuple[float, float]:
    """Slope and value at z = 0, outliers dropped."""
    keep = np.ones(len(z), bool)
    slope, value = 0.0, float(np.median(x))
    for _ in range(5):
        slope, value = (float(c) for c in np.polyfit(z[keep], x[keep], 1))
        left = np.abs(x - value - slope * z)
        keep = left <= max(3.0 * float(robust_sd(left[keep])), 1e-6)
    return slope, value


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


_STEPS = np.array([0.01, 1e-4])  # of the numerical derivative: ln(focal), metres
MEASURED = 0.003  # relative sd of the diameter: specimens thin as they stretch, edges are read to 0.02 mm


@dataclass(frozen=True, kw_only=True)
class Scale:
    """focal length [px] and y distance of the board [m] after the update; sd of the scale that is left.

    off, off_sd : the known diameter less the one that the photograph shows by what was known before, and the
    standard deviation of that difference [m].
    """

    focal: float
    distance: float
    sd: float
    off: float
    off_sd: float


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
        off = diameter - here - slope @ (prior - p)
        move = prior + gain * off - p
        p = p + np.clip(move, [-0.5, -0.5 * distance], [0.5, 0.5 * distance])
        if np.abs(move / _STEPS).max() < 0.05:
            break
    left = spread - np.outer(gain, slope @ spread)
    variance = float(slope @ left @ slope) / diameter**2
    return Scale(
        focal=float(np.exp(p[0])),
        distance=float(p[1]),
        sd=float(np.sqrt(max(variance, 0.0))),
        off=float(off),
        off_sd=float(np.sqrt(slope @ spread @ slope + noise)),
    )
