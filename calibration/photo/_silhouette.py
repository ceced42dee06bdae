"""From the silhouette in a photograph to the outline in the plane y = 0.

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

import tisim
from calibration.photo._view import View

Array = NDArray[np.float64]
Section = tisim.Circle | tisim.Rectangle


@dataclass(frozen=True, eq=False, kw_only=True)
class Side:
    """One edge: outline and axis (k, 2) as x, z in the board frame [m], unit tangent (k, 2)."""

    outline: Array
    axis: Array
    tangent: Array


def half_height(section: Section) -> float:
    """Half the section's height in the image plane [m]."""
    return section.radius if isinstance(section, tisim.Circle) else 0.5 * section.height


def half_width(section: Section) -> float:
    """Half the section's extent towards the camera [m]."""
    return section.radius if isinstance(section, tisim.Circle) else 0.5 * section.width


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
        reach = np.column_stack([across, across])[:, [0, 0, 1]] * 0.5 * section.height
        reach[:, 1] = 0.5 * section.width * np.sign(normal[:, 1])
    share = 1.0 + reach[:, 1] / ray[:, 1]
    touch = eye[[0, 2]] + share[:, None] * ray[:, [0, 2]]
    axis = touch - reach[:, [0, 2]]
    return Side(outline=axis + half_height(section) * across, axis=axis, tangent=along)


def end_face(
    view: View, section: Section, *, plane: float, axis_end: Array, tangent: Array, across: Array
) -> Array:
    """How far the end face at `axis_end` is seen to reach along `tangent` in the plane y = `plane`,
    at positions `across` (k,) [m] from the axis: (k,) [m], from axis_end."""
    turn = np.linspace(0.0, 2 * np.pi, 721)[:-1]
    if isinstance(section, tisim.Circle):
        ring = section.radius * np.column_stack([np.cos(turn), np.sin(turn)])
    else:
        ring = np.column_stack([np.cos(turn), np.sin(turn)])
        ring /= np.abs(ring).max(axis=1, keepdims=True)
        ring *= 0.5 * np.array([section.height, section.width])
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
    step = float(np.linalg.norm(np.diff(points, axis=0), axis=1).mean())
    half = int(max(2, min(round(0.5 * window / step), (len(points) - 1) // 2)))
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
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
