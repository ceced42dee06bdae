"""Local refinement of a tetrahedral mesh, around the place where a rod will touch.

Edges are halved, longest first (Rivara 1984; Plaza and Carey 2000 for tetrahedra): a tetrahedron with an
edge to halve has its longest edge halved too, which keeps the angles from getting worse with each pass.
Each tetrahedron is then cut at its marked edges from the longest to the shortest, in one order for the
whole mesh; so both neighbours cut the face between them alike and no node hangs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._errors import MeshError
from tisim.mesh._inherit import edge_keys, inherited_sets
from tisim.mesh._mesh import Mesh
from tisim.mesh._reference import TET_EDGES
from tisim.mesh.smooth import smooth

# wanted edge length [m] at points (k, 3) [m]
Size = Callable[[NDArray[np.float64]], NDArray[np.float64]]

_TRIANGLE_EDGES = np.array([(0, 1), (1, 2), (2, 0)])


def refine_around(
    mesh: Mesh,
    *,
    centre: tuple[float, float, float],
    radius: float,
    edge_length: float,
    growth: float = 0.5,
    smoothing: int = 3,
    max_nodes: int = 200_000,
) -> Mesh:
    """Refine a tet4 mesh until no edge is longer than h(r) = edge_length + growth * max(r - radius, 0).

    centre, radius: the ball to be fine throughout [m]; edge_length: longest edge wanted in it [m].
    growth: how fast the wanted length grows with the distance from the ball.
    smoothing: rounds of `smooth` afterwards (0: none).
    """
    if edge_length <= 0 or radius < 0 or growth <= 0:
        raise MeshError("refinement needs a positive edge length and growth and a radius not below 0")
    point = np.asarray(centre, dtype=np.float64)

    def size(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return edge_length + growth * np.maximum(np.linalg.norm(x - point, axis=1) - radius, 0.0)

    fine = refine(mesh, size=size, max_nodes=max_nodes)
    return smooth(fine, rounds=smoothing) if smoothing and fine is not mesh else fine


def refine(mesh: Mesh, *, size: Size, max_nodes: int = 200_000) -> Mesh:
    """Refine a tet4 mesh until no edge is longer than size(its middle); node and facet sets follow.

    The boundary keeps its shape: its triangles are cut, not moved. Raises MeshError past max_nodes.
    """
    if mesh.kind != "tet4":
        raise MeshError(
            f"only a tet4 mesh can be refined, this one is {mesh.kind}: refine, then to_quadratic"
        )
    while True:
        fine = _pass(mesh, size)
        if fine is None:
            return mesh
        mesh = fine
        if mesh.n_nodes > max_nodes:
            raise MeshError(f"refinement went past {max_nodes} nodes: ask for a larger edge length")


def _pass(mesh: Mesh, size: Size) -> Mesh | None:
    """Halve all edges that are too long, and those that must be with them; None where there is none."""
    n = mesh.n_nodes
    pairs = mesh.elements[:, TET_EDGES].astype(np.int64)
    keys, first, place = np.unique(edge_keys(pairs, n), return_index=True, return_inverse=True)
    edges = pairs.reshape(-1, 2)[first]
    place = place.reshape(-1, 6)
    length = np.linalg.norm(mesh.nodes[edges[:, 0]] - mesh.nodes[edges[:, 1]], axis=1)
    middles = mesh.nodes[edges].mean(axis=1)
    marked = length > size(middles)
    if not marked.any():
        return None
    # one order for the whole mesh: by length, equal lengths by number; rounded, so that a mesh's
    # symmetric edges do not fall one way or the other by round-off
    rank = np.empty(len(edges), dtype=np.int64)
    rank[np.lexsort((keys, np.round(length / length.max(), 9)))] = np.arange(len(edges))
    longest = np.take_along_axis(place, rank[place].argmax(axis=1)[:, None], axis=1)[:, 0]
    while True:
        more = longest[marked[place].any(axis=1)]
        if marked[more].all():
            break
        marked[more] = True
    cut = _Cut(keys[marked], rank[marked], n)
    return replace(
        mesh,
        nodes=np.concatenate([mesh.nodes, middles[marked]]),
        elements=cut.apply(mesh.elements, TET_EDGES),
        node_sets=inherited_sets(mesh, edges[marked], n),
        facet_sets={name: cut.apply(f, _TRIANGLE_EDGES) for name, f in mesh.facet_sets.items()},
    )


class _Cut:
    """Cuts simplices at marked edges; keys are sorted, ranks say which edge goes first (the highest)."""

    def __init__(self, keys: NDArray[np.int64], rank: NDArray[np.int64], n_nodes: int) -> None:
        self.keys, self.rank, self.n = keys, rank, n_nodes

    def apply(self, simplices: NDArray[np.int32], local: NDArray[np.int64]) -> NDArray[np.int32]:
        done, todo = [], simplices.astype(np.int64)
        while len(todo):
            at, rank = self._lookup(todo[:, local])
            which = rank.argmax(axis=1)
            rows = np.arange(len(todo))
            hit = rank[rows, which] >= 0
            done.append(todo[~hit])
            rows, which = rows[hit], which[hit]
            new = self.n + at[rows, which]
            one, two = todo[rows].copy(), todo[rows].copy()
            i = np.arange(len(rows))
            one[i, local[which, 0]] = new
            two[i, local[which, 1]] = new
            todo = np.concatenate([one, two])
        return np.concatenate(done).astype(np.int32)

    def _lookup(self, pairs: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Position among the marked edges, and rank (-1: not marked) of each edge."""
        key = edge_keys(pairs, self.n)
        at = np.minimum(np.searchsorted(self.keys, key), len(self.keys) - 1)
        # edges with a new node are never cut in the same pass, though their key might match by chance
        found = (self.keys[at] == key) & (pairs.max(axis=-1) < self.n)
        return at, np.where(found, self.rank[at], -1)
