"""Moves the nodes of a plane grid onto an outline, so that no cell lies on both sides of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from tisim.mesh._outline import Outline

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

SWEEPS = 12
# a quadrilateral whose flattest corner has a smaller sine is cut into two triangles where that is better
FLAT_CORNER = 0.25


@dataclass(frozen=True, kw_only=True)
class Snapped:
    """A grid that meets an outline: points (n, 2), cells (m, 4; a triangle repeats its last node).

    side: per point -1 inside, 0 on the outline, 1 outside; within: cells inside, shape (m,).
    quality: of the worst cell, 1 is best, 0 or less is degenerate or turned over.
    area: of the cells inside [m2].
    """

    points: Floats
    cells: Ints
    side: Ints
    within: Bools
    quality: float
    area: float


def snap(*, points: Floats, cells: Ints, border: Ints, outline: Outline) -> Snapped | None:
    """The grid moved onto the outline; None where it is too coarse for that.

    points (n, 2); cells (m, 4), quadrilaterals only; border: points that must stay.
    """
    rest = points
    edges = np.unique(np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)), axis=0)
    mean = _averaging(rest, edges)
    size = np.full(len(points), np.inf)
    length = np.hypot(*(rest[edges[:, 0]] - rest[edges[:, 1]]).T)
    np.minimum.at(size, edges.ravel(), np.repeat(length, 2))
    held = np.zeros(len(points), dtype=bool)
    held[border] = True

    points = rest.copy()
    on = np.zeros(len(points), dtype=bool)
    for corner in outline.corners:
        node = int(np.argmin(np.where(held | on, np.inf, np.hypot(*(points - corner).T) / size)))
        points[node], on[node] = corner, True
    if on.any():
        points = _spread(rest, points, mean, held | on)
    if not _onto(points, edges, cells, held, on, outline):
        return None
    points = _spread(rest, points, mean, held | on)

    distance = outline.signed(points)
    side = np.where(on, 0, np.sign(distance)).astype(np.int64)
    cells, within = _divide(points, cells, side)
    if not within.any():
        return None
    quality = cell_quality(points, cells)
    return Snapped(
        points=points,
        cells=cells,
        side=side,
        within=within,
        quality=float(quality.min()),
        area=float(cell_areas(points, cells[within]).sum()),
    )


def _averaging(points: Floats, edges: Ints) -> csr_array:
    """The matrix that gives each node the mean over its neighbours, near ones counting more."""
    i, j = edges.T
    weight = 1.0 / np.hypot(*(points[i] - points[j]).T)
    total = np.bincount(np.r_[i, j], np.r_[weight, weight], minlength=len(points))
    data = np.r_[weight, weight] / total[np.r_[i, j]]
    return csr_array((data, (np.r_[i, j], np.r_[j, i])), shape=(len(points), len(points)))


def _spread(rest: Floats, points: Floats, mean: csr_array, held: Bools) -> Floats:
    """Lets the free nodes follow the displacements of the held ones: the grading stays, unlike when the
    positions themselves are averaged."""
    moved = points - rest
    for _ in range(SWEEPS):
        moved = np.where(held[:, None], moved, mean @ moved)
    return rest + moved


def _onto(points: Floats, edges: Ints, cells: Ints, held: Bools, on: Bools, outline: Outline) -> bool:
    """Moves, in place, one end of every edge that crosses the outline to the crossing, shortest way first."""
    distance = np.where(on, 0.0, outline.signed(points))
    distance[np.abs(distance) < 1e-12] = 0.0
    on |= distance == 0.0
    a, b = edges.T
    crossed = edges[distance[a] * distance[b] < 0.0]
    turned = distance[crossed[:, 0]] > 0.0
    inside = np.where(turned, crossed[:, 1], crossed[:, 0])
    outside = np.where(turned, crossed[:, 0], crossed[:, 1])
    at = outline.crossing(points[inside], points[outside])
    length = np.hypot(*(points[outside] - points[inside]).T)
    share = np.hypot(*(at - points[inside]).T) / length
    nodes, places = np.concatenate([inside, outside]), np.concatenate([at, at])
    other = np.concatenate([outside, inside])
    order = np.argsort(np.concatenate([share, 1.0 - share]), kind="stable")
    around: dict[int, list[int]] = {}
    for c, cell in enumerate(cells.tolist()):
        for node in cell:
            around.setdefault(node, []).append(c)
    count = on[cells].sum(axis=1)
    for k in order.tolist():
        node = int(nodes[k])
        if on[node] or on[other[k]] or held[node]:
            continue
        mine = around[node]
        # a cell with all four nodes on a straight side would have no area
        if (count[mine] >= 3).any():
            continue
        points[node], on[node] = places[k], True
        count[mine] += 1
    left: Bools = on[inside] | on[outside]
    return bool(left.all())


def _divide(points: Floats, cells: Ints, side: Ints) -> tuple[Ints, Bools]:
    """Cuts cells that lie on both sides, or are too flat, into triangles; says which cells lie inside."""
    s = side[cells]
    both = (s.min(axis=1) < 0) & (s.max(axis=1) > 0)
    flat = corner_sines(points, cells).min(axis=1) < FLAT_CORNER
    cut = both | flat
    quads, todo = cells[~cut], cells[cut]
    first = np.stack([todo[:, [0, 1, 2, 2]], todo[:, [0, 2, 3, 3]]], axis=1)
    second = np.stack([todo[:, [0, 1, 3, 3]], todo[:, [1, 2, 3, 3]]], axis=1)

    def worth(pair: Ints) -> Floats:
        value = cell_quality(points, pair.reshape(-1, 4)).reshape(-1, 2).min(axis=1)
        split = side[pair]
        astride = ((split.min(axis=2) < 0) & (split.max(axis=2) > 0)).any(axis=1)
        return np.where(astride, -10.0, value)

    one, two = worth(first), worth(second)
    best = np.where((one >= two)[:, None, None], first, second)
    as_is = np.where(both[cut], -100.0, cell_quality(points, todo))
    stay = as_is >= np.maximum(one, two)
    cells = np.concatenate([quads, todo[stay], best[~stay].reshape(-1, 4)])
    within = outside_or_in(side[cells])
    return cells, within


def outside_or_in(side: Ints) -> Bools:
    """Cells inside: one node or more inside, the others inside or on the outline; shape (m,)."""
    return np.asarray(side.min(axis=1) < 0)


def corner_sines(points: Floats, cells: Ints) -> Floats:
    """Sines of the angles at the corners of quadrilaterals, shape (m, 4); negative where turned over."""
    p = points[cells]
    ahead, back = np.roll(p, -1, axis=1) - p, np.roll(p, 1, axis=1) - p
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    scale = np.linalg.norm(ahead, axis=-1) * np.linalg.norm(back, axis=-1)
    return np.asarray(cross / np.maximum(scale, 1e-300))


def cell_areas(points: Floats, cells: Ints) -> Floats:
    p = points[cells]
    d, e = p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]
    return np.asarray(0.5 * (d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]))


def cell_quality(points: Floats, cells: Ints) -> Floats:
    """1 for a square and an equilateral triangle, 0 or less where degenerate; shape (m,)."""
    triangle = cells[:, 2] == cells[:, 3]
    out = corner_sines(points, cells).min(axis=1)
    p = points[cells[triangle, :3]]
    sides = np.sum((np.roll(p, -1, axis=1) - p) ** 2, axis=(1, 2))
    out[triangle] = 4.0 * np.sqrt(3.0) * cell_areas(points, cells[triangle]) / np.maximum(sides, 1e-300)
    return out
