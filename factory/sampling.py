"""Samples of a scene: the 32 x 32 grid on the top, the surface, and the stiffness below each grid point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim import Inclusion
from tisim.mesh import facet_shape_functions, triangles

SIZE = 32  # grid points a side
LEVELS = 128  # of a stiffness profile
RIGID = 1.0  # code of an inclusion
_INSIDE = 1e-7  # a point this far outside a facet, in the facet's own coordinates, still belongs to it


def grid_points(block: tuple[float, float, float]) -> NDArray[np.float64]:
    """Rest positions of the grid on the top face: the centres of 32 x 32 equal cells.

    Parameters
    ----------
    block : (float, float, float)
        Sides of the block [m].

    Returns
    -------
    ndarray, shape (32, 32, 3)
        Positions [m]; rows in the order of y, columns in the order of x, both increasing.
    """
    x = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * block[0]
    y = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * block[1]
    yy, xx = np.meshgrid(y, x, indexing="ij")
    return np.stack([xx, yy, np.full_like(xx, block[2])], axis=-1)


@dataclass(frozen=True, eq=False)
class Interpolation:
    """Values at points as weighted sums over mesh nodes.

    Attributes
    ----------
    nodes : ndarray of int, shape (points, k)
    weights : ndarray of float, shape (points, k)
    """

    nodes: NDArray[np.int64]
    weights: NDArray[np.float64]

    def __call__(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Interpolate nodal values, shape (..., nodes, 3), to shape (..., points, 3)."""
        return np.einsum("...pkc,pk->...pc", values[..., self.nodes, :], self.weights)


def interpolation(
    nodes: NDArray[np.float64], facets: NDArray[np.int32], points: NDArray[np.float64]
) -> Interpolation:
    """Shape-function weights of points on a face that is a graph over xy in the rest state.

    Parameters
    ----------
    nodes : ndarray, shape (n, 3)
        Rest positions [m].
    facets : ndarray of int
        tri3, tri6, quad4 or quad8, edges straight; a quad4 with a repeated node counts as a triangle.
    points : ndarray, shape (p, 2 or more)
        Points [m], by x and y alone; each is assigned to the facet that it is outside of by the least.

    Raises
    ------
    ValueError
        If a point lies outside of all facets.
    """
    columns = facets.astype(np.int64)
    corners, is_quad = _corners(columns)
    xy = nodes[corners][..., :2]
    low, high = xy.min(axis=1), xy.max(axis=1)
    slack = 1e-6 * (high - low).max()
    target = points[:, :2]
    near = (target[:, None] >= low - slack).all(axis=2) & (target[:, None] <= high + slack).all(axis=2)
    point, facet = np.nonzero(near)
    quadratic = facets.shape[1] in (6, 8)
    weights = np.zeros((len(point), facets.shape[1] if quadratic else 4))
    outside = np.full(len(point), np.inf)
    quad = is_quad[facet]
    if quad.any():
        st, reached = _inverse_bilinear(xy[facet[quad]], target[point[quad]])
        outside[quad] = np.where(reached, (np.abs(st) - 1).max(axis=1), np.inf)
        weights[quad] = facet_shape_functions(weights.shape[1], st)[0]
    if not quad.all():
        tri = ~quad
        bary = _barycentric(xy[facet[tri]][:, :3], target[point[tri]])
        outside[tri] = (-bary).max(axis=1)
        n = 6 if facets.shape[1] == 6 else 3  # a triangle among quadrangles has no fourth node
        weights[tri, :n] = facet_shape_functions(n, bary[:, 1:])[0]
    order = np.lexsort((facet, outside, point))
    found, first = np.unique(point[order], return_index=True)
    best = order[first]
    if len(found) < len(points) or outside[best].max() > _INSIDE:
        raise ValueError("grid: a point lies on no facet of the top face")
    used = columns if quadratic else corners
    return Interpolation(nodes=used[facet[best]], weights=weights[best])


def _corners(facets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Four corner columns (triangles first, then a repeated node) and which facets are true quads."""
    if facets.shape[1] == 8:  # a quad even with a repeated corner
        return facets[:, :4], np.ones(len(facets), dtype=bool)
    if facets.shape[1] != 4:
        return facets[:, [0, 1, 2, 2]], np.zeros(len(facets), dtype=bool)
    corners = facets.copy()
    repeated = corners == np.roll(corners, -1, axis=1)  # column j equals its successor
    for row in np.flatnonzero(repeated.any(axis=1)):
        j = int(np.argmax(repeated[row]))
        distinct = np.delete(corners[row], j)
        corners[row] = (*distinct, distinct[2])
    return corners, ~repeated.any(axis=1)


def _inverse_bilinear(
    xy: NDArray[np.float64], target: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Coordinates in [-1, 1]^2 of targets (m, 2) in convex quads (m, 4, 2), by Newton's method.

    Also a mask of those found: a target far outside a skewed quad may have none.
    """
    st = np.zeros_like(target)
    for _ in range(25):
        s, t = st[:, :1], st[:, 1:]
        residual = np.einsum("mk,mkc->mc", facet_shape_functions(4, st)[0], xy) - target
        ds = ((1 - t) * (xy[:, 1] - xy[:, 0]) + (1 + t) * (xy[:, 2] - xy[:, 3])) / 4
        dt = ((1 - s) * (xy[:, 3] - xy[:, 0]) + (1 + s) * (xy[:, 2] - xy[:, 1])) / 4
        det = ds[:, 0] * dt[:, 1] - ds[:, 1] * dt[:, 0]
        det = np.where(np.abs(det) < 1e-30, 1e-30, det)
        step_s = (residual[:, 0] * dt[:, 1] - residual[:, 1] * dt[:, 0]) / det
        step_t = (residual[:, 1] * ds[:, 0] - residual[:, 0] * ds[:, 1]) / det
        # targets far away, which pass the bounding-box test, may diverge: they are not inside
        st = np.clip(st - np.stack([step_s, step_t], axis=1), -3, 3)
    miss = np.abs(np.einsum("mk,mkc->mc", facet_shape_functions(4, st)[0], xy) - target).max(axis=1)
    return st, miss <= 1e-9 * np.ptp(xy, axis=1).max(axis=1)


def _barycentric(xy: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c = xy[:, 0], xy[:, 1], xy[:, 2]
    u, v, w = b - a, c - a, target - a
    det = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    l1 = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / det
    l2 = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / det
    return np.stack([1 - l1 - l2, l1, l2], axis=1)


def surface_triangles(facets: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Triangulate the surface of a mesh.

    Parameters
    ----------
    facets : ndarray of int
        As for `tisim.mesh.triangles`.

    Returns
    -------
    nodes : ndarray of int, shape (n,)
        Mesh indices of the surface's nodes, sorted; nodes on no triangle are left out.
    triangles : ndarray of int, shape (t, 3)
        Indices into `nodes`.
    """
    nodes, local = np.unique(triangles(facets), return_inverse=True)
    return nodes.astype(np.int64), local.reshape(-1, 3).astype(np.int32)


def level_depths(height: float) -> NDArray[np.float64]:
    """Depths of the profile levels below the rest surface [m]: mid-depths of 128 equal layers."""
    return np.asarray((np.arange(LEVELS) + 0.5) * (height / LEVELS), dtype=np.float64)


def profiles(
    grid: NDArray[np.float64], height: float, inclusion: Inclusion, stiffness: float
) -> NDArray[np.uint8]:
    """Stiffness codes under each grid point.

    Parameters
    ----------
    grid : ndarray, shape (rows, columns, 3)
        Rest positions of the grid points [m].
    height : float
        Height of the block [m].
    inclusion : Inclusion
        Its code is 1.
    stiffness : float
        Code of the silicone.

    Returns
    -------
    ndarray of uint8, shape (rows, columns, 128)
        round(255 code), exact for the codes 1.0, 0.8, 0.4 and 0.0; top level first.
    """
    return codes(inside(grid, height, inclusion), stiffness)


def inside(grid: NDArray[np.float64], height: float, inclusion: Inclusion) -> NDArray[np.bool_]:
    """True where the inclusion is under each grid point, in the order of `profiles`."""
    points = np.repeat(grid[:, :, None, :], LEVELS, axis=2)
    points[..., 2] -= level_depths(height)
    return inclusion.contains(points)


def codes(inclusion: NDArray[np.bool_], stiffness: float) -> NDArray[np.uint8]:
    """Stiffness codes of an inclusion, which is True, in silicone of one code."""
    return np.where(inclusion, round(255 * RIGID), round(255 * stiffness)).astype(np.uint8)
