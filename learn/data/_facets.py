"""Eight-node facets in a triangulated surface, and interpolation by their shape functions.

A dataset of 20-node hexahedra stores each facet as six consecutive triangles, less those without area
(docs/reference/dataset-format.md). The corners and the nodes at the middle of the edges are recovered from
these, so that the displacement between the nodes is that of the simulation. Linear interpolation of the
triangles would be wrong by 0.01 mm on average.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# the six triangles of a facet, by its nodes: corners 0 to 3, middle nodes 4 = (0, 1) to 7 = (3, 0)
_SPLIT = np.array([[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]])
# nodes that are one in a collapsed facet: none, or an edge. The triangles left without area are not stored
_COLLAPSED = [(), (0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7)]
_INSIDE = 1e-6  # of the reference square [-1, 1]^2: further outside, a point belongs to another facet
_REACHED = 1e-9  # of a facet's size: largest distance between the point and the mapped coordinates
_STEPS = 25  # Newton steps of the inverse map, which is bilinear


def eight_node_facets(triangles: Integers) -> Integers:
    """Facets (q, 8) whose triangles follow one another in `triangles` (t, 3).

    A collapsed edge repeats its node.
    """
    free = np.ones(len(triangles), dtype=bool)  # a part of a whole facet looks like a collapsed one
    return np.concatenate([_take_facets(triangles, free, one) for one in _COLLAPSED])


def _take_facets(triangles: Integers, free: NDArray[np.bool_], one: tuple[int, ...]) -> Integers:
    """Facets whose nodes `one` are the same, of `free` triangles, which they take."""
    name = np.arange(8)
    name[list(one)] = min(one, default=0)
    split = name[_SPLIT]
    names = split[[len(set(corners)) == 3 for corners in split.tolist()]].ravel()
    count = len(names) // 3
    if len(triangles) < count:
        return np.empty((0, 8), dtype=np.int64)
    flat = sliding_window_view(triangles.ravel(), len(names))[::3]
    nodes = flat[:, [int(np.argmax(names == k)) for k in name]]
    found = (flat == nodes[:, names]).all(axis=1) & sliding_window_view(free, count).all(axis=1)
    for start in np.flatnonzero(found):
        free[start : start + count] = False
    return nodes[found].astype(np.int64)


def facet_weights(xy: Floats, facets: Integers, points: Floats) -> tuple[NDArray[np.bool_], Integers, Floats]:
    """Shape-function weights of points (n, 2) in plane facets with straight edges.

    Parameters
    ----------
    xy : positions of the nodes in the plane (m, 2).
    facets : nodes of the facets (q, 8).
    points : positions (n, 2).

    Returns
    -------
    True for points in a facet (n,); nodes (n, 8) and weights (n, 8), zero for other points.
    """
    inside, nodes = np.zeros(len(points), dtype=bool), np.zeros((len(points), 8), dtype=np.int64)
    weights = np.zeros((len(points), 8))
    corners = xy[facets[:, :4]]
    low, high = corners.min(axis=1), corners.max(axis=1)
    slack = _INSIDE * (high - low).max(initial=0.0)
    boxed = (points[:, None] >= low - slack).all(axis=2) & (points[:, None] <= high + slack).all(axis=2)
    point, facet = np.nonzero(boxed)
    st = _reference(corners[facet], points[point])
    outside = np.abs(st).max(axis=1, initial=0.0) - 1.0
    # of several facets, on a common edge, the one that the point is deepest in
    order = np.lexsort((outside, point))
    mine, first = np.unique(point[order], return_index=True)
    best = order[first]
    sound = outside[best] <= _INSIDE
    mine, best = mine[sound], best[sound]
    inside[mine] = True
    nodes[mine] = facets[facet[best]]
    weights[mine] = _serendipity(st[best])
    return inside, nodes, weights


def _reference(corners: Floats, points: Floats) -> Floats:
    """Coordinates in the reference square of points (k, 2) in quadrangles (k, 4, 2), or infinity."""
    a, b, c, d = corners.transpose(1, 0, 2)
    # x = m + p s + q t + r s t
    m, p, q, r = (a + b + c + d) / 4, (b + c - a - d) / 4, (c + d - a - b) / 4, (a + c - b - d) / 4
    st = np.zeros_like(points)
    for _ in range(_STEPS):
        s, t = st[:, :1], st[:, 1:]
        off = m + p * s + q * t + r * s * t - points
        by_s, by_t = p + r * t, q + r * s
        det = by_s[:, 0] * by_t[:, 1] - by_s[:, 1] * by_t[:, 0]
        det = np.where(np.abs(det) < 1e-30, np.nan, det)
        step_s = (off[:, 0] * by_t[:, 1] - off[:, 1] * by_t[:, 0]) / det
        step_t = (off[:, 1] * by_s[:, 0] - off[:, 0] * by_s[:, 1]) / det
        st = np.clip(st - np.stack([step_s, step_t], axis=1), -3.0, 3.0)
    s, t = st[:, :1], st[:, 1:]
    off = np.abs(m + p * s + q * t + r * s * t - points).max(axis=1)
    size = np.ptp(corners, axis=1).max(axis=1)
    reached = off <= _REACHED * size  # False for NaN
    return np.where(reached[:, None], st, np.inf)


def _serendipity(st: Floats) -> Floats:
    """Shape functions (k, 8) of the eight-node quadrangle (Zienkiewicz and Taylor 2000, section 8.3)."""
    s, t = st.T
    corners = [
        (1 + a * s) * (1 + b * t) * (a * s + b * t - 1) / 4 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    along_s = [(1 - s * s) * (1 + b * t) / 2 for b in (-1, 1)]
    along_t = [(1 - t * t) * (1 + a * s) / 2 for a in (-1, 1)]
    return np.stack([*corners, along_s[0], along_t[1], along_s[1], along_t[0]], axis=1)
