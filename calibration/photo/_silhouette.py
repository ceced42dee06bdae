"""Outlines of the specimen in its own plane y = 0, from the contour in the photograph.

A point of the silhouette is where a ray from the camera touches the body; the ray and the contour's tangent
span the tangent plane, whose normal N is the body's normal there. For a body of constant section about an
axis p in the plane y = 0 the touching point is p + h(N), h the section's support point: R N for a circle,
(half height across, half width along y by the sign of N) for a rectangle. p_y = 0 fixes the ray's parameter,
so axis and outline follow in closed form, for a curved axis too (its tube's normals stay across the axis).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import tisim
from calibration._numerics import arc_length, robust_sd
from calibration.photo._camera import View
from calibration.photo._contour import Contour

Array = NDArray[np.float64]
Section = tisim.Circle | tisim.Rectangle


@dataclass(frozen=True, eq=False, kw_only=True)
class Side:
    """One edge: outline and axis (k, 2) as x, z in the board frame [m], unit tangent (k, 2)."""

    outline: Array
    axis: Array
    tangent: Array


def unproject(view: View, pixels: Array, section: Section, *, plane: float, side: int, window: float) -> Side:
    """Outline and axis behind a smooth piece of silhouette.

    pixels (k, 2), in order from the clamp; plane: y of the specimen's mid plane in the board frame [m];
    side: +1 upper, -1 lower edge; window: length over which the contour's tangent is taken [m].
    """
    seen = view.on_plane(pixels, plane)
    along = _tangents(seen, window)
    eye = view.eye
    ray = np.column_stack([seen[:, 0] - eye[0], np.full(len(seen), plane - eye[1]), seen[:, 1] - eye[2]])
    tangent = np.column_stack([along[:, 0], np.zeros(len(along)), along[:, 1]])
    normal = np.cross(ray, tangent)
    outward = side * np.column_stack([-along[:, 1], along[:, 0]])
    normal *= np.sign((normal[:, [0, 2]] * outward).sum(axis=1))[:, None]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    across = normal[:, [0, 2]] / np.linalg.norm(normal[:, [0, 2]], axis=1, keepdims=True)
    if isinstance(section, tisim.Circle):
        reach = section.radius * normal
    else:
        reach = np.column_stack([across, across])[:, [0, 0, 1]] * section.half_height
        reach[:, 1] = section.half_width * np.sign(normal[:, 1])
    share = 1.0 + reach[:, 1] / ray[:, 1]
    touch = eye[[0, 2]] + share[:, None] * ray[:, [0, 2]]
    axis = touch - reach[:, [0, 2]]
    return Side(outline=axis + section.half_height * across, axis=axis, tangent=along)


def end_face(
    view: View, section: Section, *, plane: float, axis_end: Array, tangent: Array, across: Array
) -> Array:
    """Visible extent of the end face at `axis_end` along `tangent` in the plane y = `plane` [m], shape (k,).

    It is measured from `axis_end`, at positions `across` (k,) [m] from the axis.
    """
    turn = np.linspace(0.0, 2 * np.pi, 721)[:-1]
    if isinstance(section, tisim.Circle):
        ring = section.radius * np.column_stack([np.cos(turn), np.sin(turn)])
    else:
        ring = np.column_stack([np.cos(turn), np.sin(turn)])
        ring /= np.abs(ring).max(axis=1, keepdims=True)
        ring *= np.array([section.half_height, section.half_width])
    normal = np.array([-tangent[1], tangent[0]])
    eye = view.eye
    flat = axis_end + ring[:, :1] * normal
    share = (plane - eye[1]) / (plane + ring[:, 1] - eye[1])
    seen = eye[[0, 2]] + share[:, None] * (flat - eye[[0, 2]]) - axis_end
    u, t = seen @ normal, seen @ tangent
    # the rim is convex: two chains between its extremes across, of which the outer one shows
    first, last = int(u.argmin()), int(u.argmax())
    chains = []
    for a, b in ((first, last), (last, first)):
        chain = np.arange(a, b + 1 if b > a else b + 1 + len(u)) % len(u)
        order = chain[np.argsort(u[chain], kind="stable")]
        chains.append(np.interp(across, u[order], t[order], left=-np.inf, right=-np.inf))
    return np.maximum(*chains)


def _tangents(points: Array, window: float) -> Array:
    """Unit tangents of an even polyline, by local parabolas over `window`."""
    s = arc_length(points)
    half = int(max(2, min(round(0.5 * window / np.diff(s).mean()), (len(points) - 1) // 2)))
    sums = [np.concatenate([[0.0], np.cumsum(v)]) for v in _moments(s, points)]
    row = np.arange(len(points))
    low = np.clip(row - half, 0, len(points) - 2 * half - 1)
    high = low + 2 * half + 1
    n, s1, s2, s3, s4, *rest = (c[high] - c[low] for c in sums)
    # normal equations of a parabola in (s - s_at); the slope at the point itself
    tangent = np.empty((len(points), 2))
    matrix = np.stack([np.stack([n, s1, s2], -1), np.stack([s1, s2, s3], -1), np.stack([s2, s3, s4], -1)], -2)
    for axis in range(2):
        right = np.stack(rest[3 * axis : 3 * axis + 3], -1)
        c = np.linalg.solve(matrix, right[..., None])[..., 0]
        scaled = (s - s.mean()) / (s[-1] - s[0])
        tangent[:, axis] = c[:, 1] + 2 * c[:, 2] * scaled
    return tangent / np.linalg.norm(tangent, axis=1, keepdims=True)


def _moments(s: Array, points: Array) -> list[Array]:
    scaled = (s - s.mean()) / (s[-1] - s[0])
    powers = [scaled**k for k in range(5)]
    return powers + [points[:, axis] * scaled**k for axis in range(2) for k in range(3)]


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
    height = 2 * section.half_height
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
    end_sd = float(robust_sd(left - np.median(left)))
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
    """Intersection of a straight continuation of the outline's last part with the end face."""
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
