"""Columns of elements over a plane grid: around, above and below a rigid inclusion, with graded layers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._inclusion import THINNEST_GAP, Outline
from tisim.mesh._mesh import HEXAHEDRA, ElementKind, Mesh, boundary_facets
from tisim.mesh.refine import curved, to_quadratic

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class Layers:
    """Thickness of the layers of elements at the top, at the base, and at least [m]."""

    top: float
    bottom: float
    thinnest: float

    @staticmethod
    def of(kind: ElementKind, refinement: float, height: float) -> Layers:
        """Layers for an element type in a block of this height [m].

        Linear elements thinner than 1.2 mm invert under a rod's edge. Quadratic elements as thick as that
        lift off the flat of a rod at depths beyond 13 mm; tall ones below them cost no accuracy
        (studies/depth).
        """
        if kind == "hex20":
            bottom = max(0.65 * height, 0.0020)
            return Layers(top=0.0010 / refinement, bottom=bottom / refinement, thinnest=0.0008)
        return Layers(top=max(0.0012, 0.0013 / refinement), bottom=0.0060 / refinement, thinnest=0.0012)


def extrude(
    *,
    points: Floats,
    cells: Ints,
    size: tuple[float, float, float],
    refinement: float,
    kind: ElementKind = "hex8",
    outline: Outline | None = None,
    side: Ints | None = None,
    within: Bools | None = None,
    top_points: Floats | None = None,
) -> Mesh:
    """The block as an extrusion of a plane grid: hexahedra with wedges over triangles, or tetrahedra.

    Parameters
    ----------
    points, cells : ndarray, shapes (n, 2) and (m, 4)
        The plane grid [m].
    size : (float, float, float)
        Size of the block [m].
    refinement : float
        Factor by which the layers become thinner.
    kind : ElementKind
        Type of the elements.
    outline : Outline, optional
        The inclusion.
    side : ndarray of int, shape (n,), optional
        -1 for points inside the outline, 0 on it, 1 outside.
    within : ndarray of bool, shape (m,), optional
        True for cells inside the outline.
    top_points : ndarray of float, shape (n, 2), optional
        Ends of the columns on the top face [m]; the columns are inclined above the inclusion's apex.
    """
    height, n = size[2], len(points)
    layers = Layers.of(kind, refinement, height)
    low = high = np.zeros(n)
    parts: list[tuple[Floats, Bools]] = []  # per stack: levels (n, k + 1) and cells kept (m,)
    everywhere = np.ones(len(cells), dtype=bool)
    split = np.zeros(n, dtype=bool)
    if outline is not None and side is not None and within is not None:
        low, high = outline.cap(points)
        if outline.dome is not None:
            # separate columns above and below the spheroid, which meet at the outline
            split = side < 0
            low = np.where(split, low, outline.low)
            high = np.where(split, high, outline.high)
            thick = low[cells].min(axis=1) >= THINNEST_GAP
            if outline.low > 0.0:
                parts.append((_rising(low, height, layers, outline.low), ~within | thick))
        else:
            if outline.low > 0.0:
                parts.append((_rising(low, height, layers, outline.low), everywhere))
            wall = np.full(n, outline.high - outline.low)
            parts.append((outline.low + _rising(wall, height, layers, outline.high), ~within))
    parts.append((_hanging(high, height, layers), everywhere))

    nodes, elements, offset, last = [], [], 0, None
    for levels, keep in parts:
        k = levels.shape[1]
        index = offset + np.arange(k * n).reshape(k, n)
        if last is not None:
            index[0] = np.where(split, index[0], last)
        offset, last = offset + k * n, index[-1]
        xyz = np.empty((k, n, 3))
        xyz[:, :, :2] = points
        xyz[:, :, 2] = levels.T
        if top_points is not None and outline is not None:
            lean = np.clip((xyz[:, :, 2:] - outline.apex) / (height - outline.apex), 0.0, 1.0)
            xyz[:, :, :2] += lean * (top_points - points)
        nodes.append(xyz.reshape(-1, 3))
        under = index[:-1][:, cells[keep]].reshape(-1, 4)
        elements.append(np.concatenate([under, index[1:][:, cells[keep]].reshape(-1, 4)], axis=1))
    all_nodes, all_elements = np.concatenate(nodes), np.concatenate(elements)
    used, all_elements = np.unique(all_elements, return_inverse=True)
    all_elements = all_elements.reshape(-1, 8).astype(np.int32)
    if kind in HEXAHEDRA:
        mesh = _named("hex8", all_nodes[used], all_elements, size)
        return mesh if kind == "hex8" else curved(mesh, between=None if outline is None else outline.between)
    # diagonals start in the columns inside the outline, else nodes on a sphere's rim would not be held
    rank = np.argsort(np.argsort(side, kind="stable")) if side is not None else np.arange(n)
    linear = _named("tet4", all_nodes[used], tetrahedra(all_elements, rank[used % n]), size)
    return linear if kind == "tet4" else to_quadratic(linear)


def _hanging(bottom: Floats, height: float, layers: Layers) -> Floats:
    """Levels from `bottom` (n,) to the top face, finest there [m], shape (n, k + 1)."""
    room, least = height - float(bottom.min()), height - float(bottom.max())
    k = layer_count(height=room, top=layers.top, bottom=layers.bottom, total=height)
    k = max(1, min(k, int(least / layers.thinnest)))
    levels = height - graded(height - bottom, layers.top, k)[:, ::-1]
    levels[:, 0] = bottom
    return levels


def _rising(top: Floats, height: float, layers: Layers, deepest: float) -> Floats:
    """Equidistant levels from 0 to `top` (n,) [m], shape (n, k + 1).

    Their number is that of `layer_count` for a stack whose upper end is at height `deepest`.
    """
    k = layer_count(
        height=float(top.max()),
        top=layers.top,
        bottom=layers.bottom,
        total=height,
        start=height - deepest,
    )
    levels = top[:, None] * (np.arange(k + 1) / k)
    levels[:, -1] = top
    return levels


def _named(
    kind: ElementKind, nodes: Floats, elements: NDArray[np.int32], size: tuple[float, float, float]
) -> Mesh:
    """The mesh with its sets; nodes of facets that are neither on the top nor on a side are in "base"."""
    surface = boundary_facets(kind, elements)
    at = nodes[surface]
    top = (at[:, :, 2] == size[2]).all(axis=1)
    lateral = np.zeros(len(surface), dtype=bool)
    for axis in (0, 1):
        for end in (-0.5, 0.5):
            lateral |= (np.abs(at[:, :, axis] - end * size[axis]) < 1e-12).all(axis=1)
    return Mesh(
        kind=kind,
        nodes=nodes,
        elements=elements,
        node_sets={
            "base": np.unique(surface[~top & ~lateral]).astype(np.int32),
            "top": np.unique(surface[top]).astype(np.int32),
        },
        facet_sets={"top": surface[top], "surface": surface},
    )


def graded(length: Floats, first: Floats | float, n: int) -> Floats:
    """Positions of n + 1 points along lines, with a spacing that grows by a constant factor of 1 to 8.

    Parameters
    ----------
    length : ndarray of float, shape (...)
        Lengths of the lines [m].
    first : float or ndarray of float, shape (...)
        First spacing [m]; if n first spacings exceed the length, the spacing is uniform.
    n : int
        Number of intervals.

    Returns
    -------
    ndarray of float, shape (..., n + 1)
        Positions from 0 to exactly the length [m].
    """
    length = np.asarray(length, dtype=np.float64)
    first = np.minimum(np.broadcast_to(first, length.shape), length / n)
    target = length / first
    low, high = np.ones_like(length), np.full_like(length, 8.0)
    powers = np.arange(n)
    for _ in range(40):
        middle = 0.5 * (low + high)
        short = (middle[..., None] ** powers).sum(axis=-1) < target
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    steps = (0.5 * (low + high))[..., None] ** powers
    at = np.concatenate([np.zeros((*length.shape, 1)), np.cumsum(steps, axis=-1)], axis=-1)
    return at * (length / at[..., -1])[..., None]


def layer_count(*, height: float, top: float, bottom: float, total: float, start: float = 0.0) -> int:
    """Number of layers, at least one, that fill `height` [m] from a depth `start` [m] down.

    The target thickness grows linearly from `top` at the top to `bottom` at depth `total` [m].
    """
    slope = (bottom - top) / total
    at_start, at_end = top + slope * start, top + slope * (start + height)
    wanted = height / at_start if abs(slope) < 1e-12 else np.log(at_end / at_start) / slope
    return max(1, round(float(wanted)))


def tetrahedra(elements: Ints, column: Ints) -> NDArray[np.int32]:
    """Three tetrahedra for each wedge and six for each hexahedron, shape (t, 4).

    Parameters
    ----------
    elements : ndarray of int, shape (m, 8)
        Upright hex8; wedges repeat their third node.
    column : ndarray of int, shape (n,)
        Rank of each node's column. A diagonal starts at the bottom of the column of lower rank, so that both
        elements at a facet cut it in the same way.
    """
    c = column[elements[:, :4]]
    turn = (c.argmin(axis=1)[:, None] + np.arange(4)) % 4
    rows = np.arange(len(elements))[:, None]
    wedge = c[:, 2] == c[:, 3]
    quad, turn = elements[~wedge], turn[~wedge]
    rows = rows[: len(quad)]
    below, above = quad[:, :4][rows, turn], quad[:, 4:][rows, turn]
    bottom = np.concatenate([elements[wedge, :3], below[:, [0, 1, 2]], below[:, [0, 2, 3]]])
    top = np.concatenate([elements[wedge][:, 4:7], above[:, [0, 1, 2]], above[:, [0, 2, 3]]])

    c = column[bottom]
    turn = (c.argmin(axis=1)[:, None] + np.arange(3)) % 3
    rows = np.arange(len(bottom))[:, None]
    (p0, q0, r0), (p1, q1, r1), (_, cq, cr) = bottom[rows, turn].T, top[rows, turn].T, c[rows, turn].T
    first = cq < cr
    last = np.where(first[:, None], np.stack([p0, q0, r0, r1], axis=1), np.stack([p0, q0, r0, q1], axis=1))
    middle = np.where(first[:, None], np.stack([p0, q0, r1, q1], axis=1), np.stack([p0, r0, r1, q1], axis=1))
    return np.concatenate([np.stack([p1, r1, q1, p0], axis=1), middle, last]).astype(np.int32)
