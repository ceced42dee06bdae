"""Point clouds other than the dataset's grid, with the displacement interpolated from the surface meshes.

Each poke of the dataset was simulated on a mesh of its own, whose surface is stored. Interpolation between
its nodes gives the displacement anywhere on the block's top face: for testing on other clouds, and for
training at points between those of the grid (recipe key `point_jitter`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, KDTree

from learn.data._facets import eight_node_facets, facet_weights
from learn.data.setup import Setup
from learn.data.store import Store
from learn.errors import InputError

Floats = NDArray[np.float64]
_TOP = 1e-9  # [m] from the top plane
_AROUND = 13  # neighbours for an estimate of a cloud's density


def areas(points: Floats) -> Floats:
    """Area per point of a surface cloud (n, 3), in units of the mean, shape (n,).

    One over the density, estimated from the distances r of the nearest points with weights (1 - (r / h)^2)^2,
    h the distance of the farthest of them. It is invariant to rigid motions of the cloud, and continuous.
    """
    n = len(points)
    if n <= _AROUND + 1:
        return np.ones(n)
    away = np.asarray(KDTree(points).query(points, k=_AROUND + 1)[0])
    h = away[:, -1]
    area = h**2 / ((1 - (away / h[:, None]) ** 2) ** 2).sum(axis=1)
    return np.asarray(area / area.mean())


def scattered(setup: Setup, count: int, *, seed: int = 0) -> Floats:
    """Scattered points on the block's top face, within the outermost grid points.

    Returns
    -------
    Rest positions [m], shape (count, 3): evenly scattered, each 0.6 spacings or more from the next.
    """
    low, high = setup.points[:, :2].min(axis=0), setup.points[:, :2].max(axis=0)
    random = np.random.default_rng(seed)
    chosen = random.uniform(low, high, (count, 2))
    spacing = np.sqrt(np.prod(high - low) / count)
    for _ in range(60):  # push too close points apart
        pairs = KDTree(chosen).query_pairs(0.8 * spacing, output_type="ndarray")
        gap = chosen[pairs[:, 0]] - chosen[pairs[:, 1]]
        size = np.linalg.norm(gap, axis=1, keepdims=True)
        push = 0.25 * (0.8 * spacing - size) * gap / np.maximum(size, 1e-12)
        np.add.at(chosen, pairs[:, 0], push)
        np.add.at(chosen, pairs[:, 1], -push)
        chosen = np.clip(chosen, low, high)
    return np.column_stack([chosen, np.full(count, setup.top)])


def jittered(setup: Setup, random: np.random.Generator) -> Floats:
    """The grid's points, each moved at random within its cell and the outermost grid points [m], (n, 3)."""
    low, high = setup.points[:, :2].min(axis=0), setup.points[:, :2].max(axis=0)
    cell = (high - low) / (round(len(setup.points) ** 0.5) - 1)
    points = setup.points.copy()
    moved = points[:, :2] + random.uniform(-0.5, 0.5, (len(points), 2)) * cell
    points[:, :2] = np.clip(moved, low, high)
    return points


def nearest_columns(setup: Setup, points: Floats) -> NDArray[np.int64]:
    """Index of the grid point in whose cell each point of the top face lies, shape (n,)."""
    side = round(len(setup.points) ** 0.5)
    low = setup.points.min(axis=0)[:2]
    step = (setup.points.max(axis=0)[:2] - low) / (side - 1)
    column, row = np.clip(np.rint(((points[:, :2] - low) / step).T).astype(int), 0, side - 1)
    return np.asarray(row * side + column, dtype=np.int64)


class SurfaceField:
    """Displacement anywhere on the top face, interpolated on each poke's own surface mesh.

    In eight-node facets by their shape functions, as in the simulation; elsewhere linearly between the nodes.

    Parameters
    ----------
    store : the dataset.
    pokes : indices of the pokes whose meshes are held in memory. InputError if a mesh has no top face.
    """

    def __init__(self, store: Store, pokes: Iterable[int]) -> None:
        self.store = store
        self._meshes: dict[int, _TopFace] = {}
        for poke in map(int, pokes):
            rest, triangles, moved = store.surface(poke)
            top = np.abs(rest[:, 2] - store.setup_of(poke).top) < _TOP
            if top.sum() < 4:
                raise InputError(f"{store.location}: the surface of poke {poke} has no nodes on the top face")
            number = np.where(top, np.cumsum(top) - 1, -1)
            own = number[triangles[top[triangles].all(axis=1)]]
            self._meshes[poke] = _TopFace(
                xy=rest[top, :2], facets=eight_node_facets(own), moved=np.ascontiguousarray(moved[:, top])
            )

    def displacement(self, rows: NDArray[np.int64], points: Floats) -> NDArray[np.float32]:
        """Displacement [m] of points (n, 3) of the top face in these frames, shape (frames, n, 3)."""
        out = np.empty((len(rows), len(points), 3), dtype=np.float32)
        pokes = self.store.frame_poke[rows]
        for poke in np.unique(pokes):
            mesh = self._meshes[int(poke)]
            found = mesh.weights(points[:, :2])
            if found is None:
                raise InputError(
                    f"{self.store.location}: the surface of poke {poke} does not cover the grid's points"
                )
            nodes, weights = found
            for k in np.flatnonzero(pokes == poke):
                frame = mesh.moved[rows[k] - self.store.frame_start[poke]]
                out[k] = np.einsum("nk,nkc->nc", weights, frame[nodes])
        return out


@dataclass(frozen=True, eq=False, kw_only=True)
class _TopFace:
    """Nodes of a poke's top face: positions xy (m, 2), eight-node facets (q, 8), displacement (f, m, 3)."""

    xy: Floats
    facets: NDArray[np.int64]
    moved: NDArray[np.float32]

    @cached_property
    def _triangles(self) -> Delaunay:
        return Delaunay(self.xy)

    def weights(self, points: Floats) -> tuple[NDArray[np.int64], Floats] | None:
        """Nodes and weights (n, 8) of points (n, 2); None if a point is outside of the mesh."""
        inside, nodes, weights = facet_weights(self.xy, self.facets, points)
        rest = np.flatnonzero(~inside)
        if rest.size:
            mesh = self._triangles
            simplex = mesh.find_simplex(points[rest])
            if (simplex < 0).any():
                return None
            transform = mesh.transform[simplex]
            first = np.einsum("nij,nj->ni", transform[:, :2], points[rest] - transform[:, 2])
            weights[rest, :3] = np.column_stack([first, 1 - first.sum(axis=1)])
            nodes[rest, :3] = mesh.simplices[simplex]
        return nodes, weights
