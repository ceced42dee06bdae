"""The 32 x 32 grid of material points on the top: where they lie, and their displacement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SIZE = 32
_INSIDE = 1e-7  # a point this far outside a facet, in the facet's own coordinates, still belongs to it


def grid_points(block: tuple[float, float, float]) -> NDArray[np.float64]:
    """Rest positions [m], shape (32, 32, 3): the middles of 32 x 32 equal cells of the top face.

    Row index along y, column index along x, both upwards.
    """
    x = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * block[0]
    y = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * block[1]
    yy, xx = np.meshgrid(y, x, indexing="ij")
    return np.stack([xx, yy, np.full_like(xx, block[2])], axis=-1)


@dataclass(frozen=True, eq=False)
class Interpolation:
    """Values at points as weighted sums over mesh nodes; nodes and weights of shape (points, k)."""

    nodes: NDArray[np.int64]
    weights: NDArray[np.float64]

    def __call__(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """values: shape (..., n nodes, 3); returns (..., points, 3)."""
        return np.einsum("...pkc,pk->...pc", values[..., self.nodes, :], self.weights)


def interpolation(
    nodes: NDArray[np.float64], facets: NDArray[np.int32], points: NDArray[np.float64]
) -> Interpolation:
    """Shape-function weights of points on a face that is a graph over xy in the rest state.

    nodes: rest positions [m], (n, 3); facets: tri3, tri6 or quad4 (a quad with a repeated node counts
    as a triangle); points: (p, >=2), of which x and y are used. Each point goes to the facet that holds
    it best; ValueError where one lies outside of all.
    """
    columns = facets.astype(np.int64)
    corners, is_quad = _corners(columns)
    xy = nodes[corners][..., :2]
    low, high = xy.min(axis=1), xy.max(axis=1)
    slack = 1e-6 * (high - low).max()
    target = points[:, :2]
    near = (target[:, None] >= low - slack).all(axis=2) & (target[:, None] <= high + slack).all(axis=2)
    point, facet = np.nonzero(near)
    weights = np.zeros((len(point), facets.shape[1] if facets.shape[1] == 6 else 4))
    outside = np.full(len(point), np.inf)
    quad = is_quad[facet]
    if quad.any():
        st, reached = _inverse_bilinear(xy[facet[quad]], target[point[quad]])
        outside[quad] = np.where(reached, (np.abs(st) - 1).max(axis=1), np.inf)
        weights[quad] = _bilinear(st)
    if not quad.all():
        tri = ~quad
        bary = _barycentric(xy[facet[tri]][:, :3], target[point[tri]])
        outside[tri] = (-bary).max(axis=1)
        weights[tri] = _quadratic(bary) if facets.shape[1] == 6 else np.pad(bary, ((0, 0), (0, 1)))
    order = np.lexsort((facet, outside, point))
    found, first = np.unique(point[order], return_index=True)
    best = order[first]
    if len(found) < len(points) or outside[best].max() > _INSIDE:
        raise ValueError("grid: a point lies on no facet of the top face")
    used = columns if facets.shape[1] == 6 else corners
    return Interpolation(nodes=used[facet[best]], weights=weights[best])


def _corners(facets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Four corner columns (triangles first, then a repeated node) and which facets are true quads."""
    if facets.shape[1] != 4:
        return facets[:, [0, 1, 2, 2]], np.zeros(len(facets), dtype=bool)
    corners = facets.copy()
    repeated = corners == np.roll(corners, -1, axis=1)  # column j equals its successor
    for row in np.flatnonzero(repeated.any(axis=1)):
        j = int(np.argmax(repeated[row]))
        distinct = np.delete(corners[row], j)
        corners[row] = (*distinct, distinct[2])
    return corners, ~repeated.any(axis=1)


def _bilinear(st: NDArray[np.float64]) -> NDArray[np.float64]:
    s, t = st[:, 0], st[:, 1]
    return np.stack([(1 - s) * (1 - t), (1 + s) * (1 - t), (1 + s) * (1 + t), (1 - s) * (1 + t)], axis=1) / 4


def _inverse_bilinear(
    xy: NDArray[np.float64], target: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Coordinates in [-1, 1]^2 of targets (m, 2) in convex quads (m, 4, 2), by Newton's method.

    Also which of them were found: a target far outside a skewed quad may have none.
    """
    st = np.zeros_like(target)
    for _ in range(25):
        s, t = st[:, :1], st[:, 1:]
        residual = np.einsum("mk,mkc->mc", _bilinear(st), xy) - target
        ds = ((1 - t) * (xy[:, 1] - xy[:, 0]) + (1 + t) * (xy[:, 2] - xy[:, 3])) / 4
        dt = ((1 - s) * (xy[:, 3] - xy[:, 0]) + (1 + s) * (xy[:, 2] - xy[:, 1])) / 4
        det = ds[:, 0] * dt[:, 1] - ds[:, 1] * dt[:, 0]
        det = np.where(np.abs(det) < 1e-30, 1e-30, det)
        step_s = (residual[:, 0] * dt[:, 1] - residual[:, 1] * dt[:, 0]) / det
        step_t = (residual[:, 1] * ds[:, 0] - residual[:, 0] * ds[:, 1]) / det
        # far-away targets of the bounding-box test may run off: they are not inside anyway
        st = np.clip(st - np.stack([step_s, step_t], axis=1), -3, 3)
    miss = np.abs(np.einsum("mk,mkc->mc", _bilinear(st), xy) - target).max(axis=1)
    return st, miss <= 1e-9 * np.ptp(xy, axis=1).max(axis=1)


def _barycentric(xy: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    a, b, c = xy[:, 0], xy[:, 1], xy[:, 2]
    u, v, w = b - a, c - a, target - a
    det = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    l1 = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / det
    l2 = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / det
    return np.stack([1 - l1 - l2, l1, l2], axis=1)


def _quadratic(bary: NDArray[np.float64]) -> NDArray[np.float64]:
    """Six-node triangle with mid-side nodes 3=(0,1), 4=(1,2), 5=(2,0) in the middle of straight edges."""
    a, b, c = bary.T
    return np.stack(
        [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a], axis=1
    )
