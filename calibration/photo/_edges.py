"""Both edges of the specimen in its own plane: outlines, axis, diameter, free end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from calibration.photo._contour import Contour
from calibration.photo._silhouette import Section, Side, end_face, half_height, unproject
from calibration.photo._view import View

Array = NDArray[np.float64]

_MARGIN = 7.0  # pixels left out before a corner, which blur rounds off
_WINDOW = 0.005  # [m], for the contour's tangent


@dataclass(frozen=True, eq=False, kw_only=True)
class Edges:
    """upper, lower: as `Side`; diameter: median distance of the outlines [m]; end: upper and lower corner of
    a free end's face (2, 2) [m], None where clamped; end_sd [m]: of the face's place along the beam."""

    upper: Side
    lower: Side
    diameter: float
    end: Array | None
    end_sd: float


def to_plane(view: View, contour: Contour, section: Section, *, plane: float) -> Edges:
    """Undoes the perspective of a contour; board frame [m]."""

    def side(pixels: Array, sign: int) -> Side:
        return unproject(view, pixels, section, plane=plane, side=sign, window=_WINDOW)

    upper, lower = side(contour.upper, 1), side(contour.lower, -1)
    if not len(contour.end):
        return Edges(upper=upper, lower=lower, diameter=_diameter(upper, lower), end=None, end_sd=0.0)
    height = 2 * half_height(section)
    tangent, middle = _end_line(upper, lower, height)
    normal = np.array([-tangent[1], tangent[0]])
    rim = view.on_plane(contour.end, plane) - middle
    u, t = rim @ normal, rim @ tangent
    face = (np.abs(u) < 0.35 * height) & (t > 0.5 * t.max())
    reach = 0.0
    for _ in range(4):
        front = end_face(
            view, section, plane=plane, axis_end=middle + reach * tangent, tangent=tangent, across=u[face]
        )
        left = t[face] - front - reach
        left = left[np.isfinite(left)]
        reach += float(np.median(left))
    end_sd = 1.4826 * float(np.median(np.abs(left - np.median(left))))
    # the contour follows the tube as far as the face; from there on it is the face's rim
    longer = []
    for kept, more, sign in ((contour.upper, contour.end, 1), (contour.lower, contour.end[::-1], -1)):
        last = (upper if sign == 1 else lower).axis[-1]
        shift = (view.on_plane(kept[-1:], plane)[0] - last) @ tangent
        ahead = (view.on_plane(more, plane) - middle) @ tangent
        stop = np.flatnonzero(ahead > reach + shift - _MARGIN * contour.metres_per_pixel)
        longer.append(np.concatenate([kept, more[: int(stop[0]) if len(stop) else 0]]))
    upper, lower = side(longer[0], 1), side(longer[1], -1)
    corners = np.array(
        [_corner(edge.outline, middle, tangent, reach, 0.4 * height) for edge in (upper, lower)]
    )
    return Edges(upper=upper, lower=lower, diameter=_diameter(upper, lower), end=corners, end_sd=end_sd)


def _end_line(upper: Side, lower: Side, height: float) -> tuple[Array, Array]:
    """Direction of the beam at its free end, where it bends no more, and a point on its axis there."""
    tangents = []
    for edge in (upper, lower):
        tail = np.linalg.norm(edge.axis - edge.axis[-1], axis=1) < 0.5 * height
        tangents.append(edge.axis[-1] - edge.axis[tail][0])
    tangent = np.sum([t / np.linalg.norm(t) for t in tangents], axis=0)
    tangent /= np.linalg.norm(tangent)
    return tangent, 0.5 * (upper.axis[-1] + lower.axis[-1])


def _corner(line: Array, middle: Array, tangent: Array, reach: float, tail: float) -> Array:
    """Where a straight continuation of the outline's last part meets the end face."""
    normal = np.array([-tangent[1], tangent[0]])
    t, u = (line - middle) @ tangent, (line - middle) @ normal
    near = t > t[-1] - tail
    line_terms = np.column_stack([np.ones(int(near.sum())), t[near] - reach])
    value = float(np.ravel(np.linalg.lstsq(line_terms, u[near], rcond=None)[0])[0])
    return middle + reach * tangent + value * normal


def _diameter(upper: Side, lower: Side) -> float:
    """Median way from the upper outline to the lower one, where both run."""
    found = cKDTree(lower.outline).query(upper.outline[::4])
    distance, nearest = np.asarray(found[0]), np.asarray(found[1])
    inner = (nearest > 3) & (nearest < len(lower.outline) - 4)
    if inner.sum() < 10:
        return float(np.median(distance))
    return float(np.median(distance[inner]))
