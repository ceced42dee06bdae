"""Adaptation of a plane grid to an outline, so that no cell lies on both sides of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._inclusion import Outline

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

SWEEPS = 12
# a quadrilateral with a smaller sine at its flattest corner is cut into two triangles if they are better
FLAT_CORNER = 0.25
# least quality of a triangle of three nodes on the outline: a sliver on a circle or side, not at a corner
WORTH_HAVING = 0.1


@dataclass(frozen=True, kw_only=True)
class Snapped:
    """A grid that fits an outline.

    Attributes
    ----------
    points : positions [m], shape (n, 2).
    cells : point indices, shape (m, 4); triangles repeat their last node.
    side : -1 for points inside, 0 on the outline, 1 outside, shape (n,).
    within : True for cells inside, shape (m,).
    quality : quality of the worst cell; 1 is best, 0 or less is degenerate or inverted.
    area : area of the cells inside [m2].
    """

    points: Floats
    cells: Ints
    side: Ints
    within: Bools
    quality: float
    area: float


def snap(*, points: Floats, cells: Ints, border: Ints, outline: Outline) -> Snapped | None:
    """The grid fitted to the outline; None if it is too coarse for that.

    Parameters
    ----------
    points : ndarray of float, shape (n, 2)
        Positions [m].
    cells : ndarray of int, shape (m, 4)
        Quadrilaterals.
    border : ndarray of int
        Indices of points that must not move.
    outline : Outline
    """
    rest = points
    edges = np.unique(np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2)), axis=0)
    mean = _averaging(rest, edges)
    held = np.zeros(len(points), dtype=bool)
    held[border] = True

    points = rest.copy()
    on = np.zeros(len(points), dtype=bool)
    for corner in outline.corners:
        node = _nearest(rest, cells, held | on, corner)
        if node is None:
            return None
        points[node], on[node] = corner, True
    if on.any():
        points = _spread(rest, points, mean, held | on)
    if not _onto(points, edges, cells, held, on, outline):
        return None
    side = np.where(on, 0, np.sign(outline.signed(points))).astype(np.int64)
    followed = _spread(rest, points, mean, held | on)
    same = np.sign(outline.signed(followed)) == side  # a node that would cross the outline stays
    points = np.where(same[:, None], followed, points)
    cells, within = _divide(points, cells, side, outline)
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
    """Matrix of the mean over each node's neighbours, weighted by inverse distance."""
    from scipy.sparse import csr_array  # takes longer to import than tisim itself

    i, j = edges.T
    weight = 1.0 / np.hypot(*(points[i] - points[j]).T)
    total = np.bincount(np.r_[i, j], np.r_[weight, weight], minlength=len(points))
    data = np.r_[weight, weight] / total[np.r_[i, j]]
    return csr_array((data, (np.r_[i, j], np.r_[j, i])), shape=(len(points), len(points)))


def _nearest(points: Floats, cells: Ints, taken: Bools, place: Floats) -> int | None:
    """The free node to move to a place; None if no node of the cell around it is free.

    It is the nearest in the natural coordinates of the cell, so that it moves by at most half a cell in each
    direction, however slender the cell is.
    """
    p = points[cells] - place
    ahead = np.roll(p, -1, axis=1)
    around = (p[..., 0] * ahead[..., 1] - p[..., 1] * ahead[..., 0]).min(axis=1)
    cell = cells[around.argmax()]
    a, b, c, d = points[cell]
    s = t = 0.5
    for _ in range(6):
        off = (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d - place
        by_s, by_t = (1 - t) * (b - a) + t * (c - d), (1 - s) * (d - a) + s * (c - b)
        change = np.linalg.solve(np.stack([by_s, by_t], axis=1), off)
        s, t = s - change[0], t - change[1]
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    far = np.abs(corners - [s, t]).max(axis=1) + 10.0 * taken[cell]
    return None if far.min() >= 10.0 else int(cell[far.argmin()])


def _spread(rest: Floats, points: Floats, mean: csr_array, held: Bools) -> Floats:
    """Positions with the held nodes' displacements averaged over the free ones.

    Averaging displacements preserves the grading; averaging positions does not.
    """
    moved = points - rest
    for _ in range(SWEEPS):
        moved = np.where(held[:, None], moved, mean @ moved)
    return rest + moved


def _onto(points: Floats, edges: Ints, cells: Ints, held: Bools, on: Bools, outline: Outline) -> bool:
    """Move one end of each edge that crosses the outline to the crossing, in place, shortest way first.

    Returns True if every such edge then has an end on the outline; `on` is updated.
    """
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
    # an inside node with edges through two sides of a polygon would, moved to one of them, leave the corner
    # between them uncovered: the other ends of its edges go first
    face = outline.face(at)
    least, most = np.full(len(points), 99), np.full(len(points), -1)
    np.minimum.at(least, inside, face)
    np.maximum.at(most, inside, face)
    order = np.argsort(np.concatenate([share + (least < most)[inside], 1.0 - share]), kind="stable")
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
    for _ in range(3 if len(outline.corners) else 0):
        # edges from one side of a corner through the inside to beyond the other side
        start = np.concatenate([a[on[a] & ~on[b]], b[on[b] & ~on[a]]])
        stop = np.concatenate([b[on[a] & ~on[b]], a[on[b] & ~on[a]]])
        probe = points[start] + 1e-3 * (points[stop] - points[start])
        through = (outline.signed(probe) < -1e-9) & (outline.signed(points[stop]) > 1e-9)
        places = outline.crossing(probe[through], points[stop[through]])
        for node, place in zip(stop[through].tolist(), places, strict=True):
            if not on[node] and not held[node] and not (count[around[node]] >= 3).any():
                points[node], on[node] = place, True
                count[around[node]] += 1
    return bool(left.all())


def _divide(points: Floats, cells: Ints, side: Ints, outline: Outline) -> tuple[Ints, Bools]:
    """Cells after cutting those on both sides and those too flat into triangles; True for cells inside."""
    # first cells that cover a corner of the polygon with three nodes on the outline and the fourth outside
    s = side[cells]
    fourth = s.argmax(axis=1)
    rolled = cells[np.arange(len(cells))[:, None], (fourth[:, None] + np.arange(4)) % 4]
    covers = (s.min(axis=1) == 0) & ((s == 0).sum(axis=1) == 3)
    covers[covers] = _inside(points, rolled[covers, 1:], outline)
    corner = rolled[covers]
    cells = np.concatenate([cells[~covers], corner[:, [1, 2, 3, 3]], corner[:, [3, 0, 1, 1]]])

    s = side[cells]
    both = (s.min(axis=1) < 0) & (s.max(axis=1) > 0)
    quad = cells[:, 2] != cells[:, 3]
    flat = quad & (corner_sines(points, cells).min(axis=1) < FLAT_CORNER)
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
    # the outline is convex: a cell with a node inside is inside; a triangle with three nodes on it may be
    within = side[cells].min(axis=1) < 0
    rim = (cells[:, 2] == cells[:, 3]) & (side[cells] == 0).all(axis=1)
    within[rim] = _inside(points, cells[rim, :3], outline)
    return cells, within


def _inside(points: Floats, triangles: Ints, outline: Outline) -> Bools:
    """True for triangles with all nodes on the outline that lie inside it and are not degenerate."""
    good = cell_quality(points, triangles[:, [0, 1, 2, 2]]) > WORTH_HAVING
    return good & (outline.signed(points[triangles].mean(axis=1)) < 0.0)


def corner_sines(points: Floats, cells: Ints) -> Floats:
    """Sines of the corner angles of quadrilaterals, shape (m, 4); negative if inverted."""
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
    """Quality of cells, shape (m,): 1 for a rectangle or an equilateral triangle, 0 or less if degenerate.

    It is the smallest sine of a corner for quadrilaterals, 4 sqrt(3) area / sum of squared sides for
    triangles.
    """
    triangle = cells[:, 2] == cells[:, 3]
    out = corner_sines(points, cells).min(axis=1)
    p = points[cells[triangle, :3]]
    sides = np.sum((np.roll(p, -1, axis=1) - p) ** 2, axis=(1, 2))
    out[triangle] = 4.0 * np.sqrt(3.0) * cell_areas(points, cells[triangle]) / np.maximum(sides, 1e-300)
    return out
