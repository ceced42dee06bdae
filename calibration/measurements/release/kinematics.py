"""Kinematics of markers on a simulated body: on its surface, or on a rigid stalk that is fixed to it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from tisim import Mesh, Result

Array = NDArray[np.float64]

FLUSH = 1e-9  # facets whose distance exceeds the smallest one by less than this share the projected point [m]


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion of m markers in f frames.

    Attributes
    ----------
    displacement : [m], shape (m, f, 3).
    turn : R - 1 with the rotation R at each marker, shape (m, f, 3, 3); a marker at X + e instead of X has
        the additional displacement turn @ e.
    """

    displacement: Array
    turn: Array


def marker_displacements(result: Result, positions: ArrayLike) -> Array:
    """Displacement of markers from the unloaded pose in each frame of a result [m], shape (m, f, 3).

    positions : positions in the unloaded pose [m], shape (m, 3). See `marker_motion`.
    """
    return marker_motion(result, positions).displacement


def marker_motion(result: Result, positions: ArrayLike) -> Motion:
    """Displacement and rotation of markers in each frame of a result.

    The projection of a marker onto the body's surface moves with its facet's interpolation. A marker off the
    surface is on a rigid stalk that rotates with the surface at the projected point: by the least-squares
    rotation (polar factor) of the facet's tangents and normal, which is exact if the surface bends as the
    elements do. A projection onto an edge uses the mean of its facets. ValueError if the mesh has no facet
    set "surface".
    """
    mesh = result.mesh
    if "surface" not in mesh.facet_sets:
        raise ValueError("markers: expected a mesh with a facet set 'surface'")
    wanted = np.asarray(positions, dtype=float).reshape(-1, 3)
    moved = np.zeros((len(wanted), len(result.positions), 3))
    turns = np.zeros((len(wanted), len(result.positions), 3, 3))
    for i, at in enumerate(wanted):
        # half models: the other half moves as a mirror image
        mirror = np.ones(3)
        for axis in mesh.symmetry:
            mirror["xyz".index(axis)] = -1.0 if at["xyz".index(axis)] < 0.0 else 1.0
        displacement, turn = _one(mesh, result.positions, at * mirror)
        moved[i] = displacement * mirror
        turns[i] = mirror[:, None] * turn * mirror
    return Motion(moved, turns)


def _one(mesh: Mesh, x: Array, at: Array) -> tuple[Array, Array]:
    """Displacement (f, 3) and R - 1 (f, 3, 3) of one marker."""
    facets = mesh.facet_sets["surface"]
    corners, split = _corners(facets)
    points, local = nearest_on_triangles(at, mesh.nodes[corners])
    distance = np.linalg.norm(points - at, axis=1)
    near = np.flatnonzero(distance <= distance.min() + FLUSH)
    foot, moved, gradient = np.zeros(3), np.zeros((len(x), 3)), np.zeros((len(x), 3, 3))
    for k in near:
        nodes = facets[k // split]
        n, tangents = _shape(facets.shape[1], int(k) % split, local[k])
        foot += n @ mesh.nodes[nodes] / len(near)
        moved += np.einsum("a,fai->fi", n, x[:, nodes]) / len(near)
        rest = _frame(tangents @ mesh.nodes[nodes][None])[0]
        gradient += _frame(tangents @ x[:, nodes]) @ np.linalg.inv(rest)
    turn = _rotation(gradient) - np.eye(3)
    return moved - foot + turn @ (at - foot), turn


def _frame(tangents: Array) -> Array:
    """Two tangents, given as (f, 2, 3), and the unit normal as columns, shape (f, 3, 3)."""
    normal = np.cross(tangents[:, 0], tangents[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([tangents[:, 0], tangents[:, 1], normal], axis=2)


def _rotation(gradient: Array) -> Array:
    """Nearest rotations of matrices (f, 3, 3) (Kabsch, Acta Cryst. A32, 1976)."""
    u, _, vt = np.linalg.svd(gradient)
    u[..., 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    return np.asarray(u @ vt)


def _corners(facets: NDArray[np.int32]) -> tuple[NDArray[np.int32], int]:
    """Flat triangles of the facets, and their number per facet."""
    if facets.shape[1] == 4:
        return np.stack([facets[:, [0, 1, 2]], facets[:, [0, 2, 3]]], axis=1).reshape(-1, 3), 2
    return facets[:, :3], 1


def _shape(width: int, part: int, l: Array) -> tuple[Array, Array]:
    """Shape functions (width,) of a facet, and their derivatives along two sides of a triangle (2, width).

    They are evaluated at area coordinates l (3,) of the facet's flat triangle number `part`.
    """
    along = np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]])
    if width == 6:
        n = np.concatenate([l * (2 * l - 1), [4 * l[0] * l[1], 4 * l[1] * l[2], 4 * l[2] * l[0]]])
        middle = 4 * np.array([[l[1], l[0], 0.0], [0.0, l[2], l[1]], [l[2], 0.0, l[0]]])
        return n, along @ np.concatenate([np.diag(4 * l - 1), middle]).T
    place = np.zeros((3, width))
    place[[0, 1, 2], ([0, 1, 2], [0, 2, 3])[part]] = 1.0
    return l @ place, along @ place


def nearest_on_triangles(at: Array, triangles: Array) -> tuple[Array, Array]:
    """Closest points (t, 3) of triangles (t, 3, 3) to a point (3,), and their area coordinates (t, 3)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    e1, e2, d = b - a, c - a, at - a
    g11, g12, g22 = (np.einsum("ti,ti->t", p, q) for p, q in ((e1, e1), (e1, e2), (e2, e2)))
    h1, h2 = np.einsum("ti,ti->t", e1, d), np.einsum("ti,ti->t", e2, d)
    det = g11 * g22 - g12**2
    u, v = (g22 * h1 - g12 * h2) / det, (g11 * h2 - g12 * h1) / det
    best = np.column_stack([1.0 - u - v, u, v])
    gap = np.where((best >= 0.0).all(axis=1), 0.0, np.inf)  # projections outside move to an edge
    for i, j in ((0, 1), (1, 2), (2, 0)):
        p, q = triangles[:, i], triangles[:, j]
        t = np.clip(np.einsum("ti,ti->t", at - p, q - p) / np.einsum("ti,ti->t", q - p, q - p), 0.0, 1.0)
        away = np.linalg.norm(p + t[:, None] * (q - p) - at, axis=1)
        closer = away < gap
        edge = np.zeros_like(best)
        edge[:, i], edge[:, j] = 1.0 - t, t
        best[closer], gap[closer] = edge[closer], away[closer]
    return np.einsum("ta,tai->ti", best, triangles), best


@dataclass(eq=False)
class Track:
    """Motion of a marker, interpolated by cubic splines between the f frames of a simulation.

    Attributes
    ----------
    time : time since the release [s], shape (f,).
    displacement : [m], shape (f, 3).
    turn : R - 1 with the rotation R at the marker, shape (f, 3, 3).
    """

    time: Array
    displacement: Array
    turn: Array
    _spline: CubicSpline = field(init=False)

    def __post_init__(self) -> None:
        values = np.concatenate([self.displacement, self.turn.reshape(-1, 9)], axis=1)
        values = np.concatenate([np.zeros((1, 12)), values])
        start: tuple[Literal[1], Array] = (1, np.zeros(12))  # released at rest: no velocity
        self._spline = CubicSpline(np.concatenate([[0.0], self.time]), values, bc_type=(start, "not-a-knot"))

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Displacement (t, 3), R - 1 (t, 3, 3), and 1 after, 0 before the release (t,), at times since it."""
        after = (time > 0.0).astype(float)
        values = self._spline(np.clip(time, 0.0, self.time[-1])) * after[:, None]
        return values[:, :3], values[:, 3:].reshape(-1, 3, 3), after
