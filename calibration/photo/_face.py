"""x = 0: the clamp's face, from the vertical edges of the clamp above and below the beam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.photo._body import Clamp, show_body
from calibration.photo._edge import refine
from calibration.photo._image import Grey
from calibration.photo._problem import PhotoProblem
from calibration.photo._segment import Foreground
from calibration.photo._view import View

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
    picture = show_body(image, found, label)
    edge_y = back if view.eye[0] > clamp.x else front
    if edge_y is None:
        raise PhotoProblem(
            "the camera stands to the left of the clamp's face, whose near edge is not known: expected "
            "clamp_front_mm or board_corner_mm in photographs.yaml, or a camera further to the right",
            picture,
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
        raise PhotoProblem("the clamp's face was not found: no clear edge above or below the beam", picture)
    seen = view.on_plane(pixels, edge_y)
    middle = 0.5 * sum(clamp.beam_z)
    slope, x = _robust_line(seen[:, 1] - middle, seen[:, 0])
    left = np.abs(seen[:, 0] - x - slope * (seen[:, 1] - middle))
    if abs(slope) > np.tan(_LEAN):
        raise PhotoProblem(
            f"the clamp's face leans {np.degrees(np.arctan(slope)):.1f} degrees off the board's vertical, "
            f"expected at most {np.degrees(_LEAN):.0f}: hang the board parallel to the clamp",
            picture,
        )
    # points along an edge err together: a tenth of them count
    sd = 1.4826 * float(np.median(left)) / np.sqrt(max(len(left) / 10, 1.0)) + 5e-6
    return Face(x=x, sd=sd, lean=float(np.arctan(slope)), pixels=pixels)


def _robust_line(z: Array, x: Array) -> tuple[float, float]:
    """Slope and value at z = 0, outliers dropped."""
    keep = np.ones(len(z), bool)
    slope, value = 0.0, float(np.median(x))
    for _ in range(5):
        slope, value = (float(c) for c in np.polyfit(z[keep], x[keep], 1))
        left = np.abs(x - value - slope * z)
        keep = left <= max(3.0 * 1.4826 * float(np.median(left[keep])), 1e-6)
    return slope, value
