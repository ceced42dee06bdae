"""Local refinement of tetrahedra, and quadratic elements from linear ones.

Edges are bisected, longest first (Rivara 1984; Plaza and Carey 2000 for tetrahedra): if an edge of a
tetrahedron is bisected, so is its longest edge, which prevents angles from degenerating with each pass. Each
tetrahedron is then cut at its marked edges from the longest to the shortest, in one order for the whole mesh,
so that both neighbours cut their common face in the same way and there are no hanging nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._elements import HEX_EDGES, NODE_PLACES, TET_EDGES, det_jacobian, quadrature
from tisim.mesh._mesh import ElementKind, Mesh, MeshError, boundary_facets
from tisim.mesh.quality import smooth

# target edge length [m] at points (k, 3) [m]
Size = Callable[[NDArray[np.float64]], NDArray[np.float64]]

# for each linear element type: the quadratic type, and the edges whose middles are the new nodes
_QUADRATIC: dict[ElementKind, tuple[ElementKind, NDArray[np.int64]]] = {
    "tet4": ("tet10", TET_EDGES),
    "hex8": ("hex20", HEX_EDGES),
}
# fractions of the curvature of an edge, reduced until no element is inverted
CURVED = np.array([1.0, 0.75, 0.5, 0.25, 0.0])
_TRIANGLE_EDGES = np.array([(0, 1), (1, 2), (2, 0)])
Projection = Callable[[NDArray[np.float64]], NDArray[np.float64]]
Between = Callable[[NDArray[np.float64]], NDArray[np.float64]]


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

    Parameters
    ----------
    mesh : Mesh
        A mesh of tet4 elements.
    centre, radius : (float, float, float) and float
        Centre and radius of the ball that is refined uniformly [m].
    edge_length : float
        Longest edge in the ball [m].
    growth : float
        Increase of the longest edge per distance from the ball.
    smoothing : int
        Rounds of `smooth` afterwards (0: none).
    max_nodes : int
        Largest number of nodes.

    Returns
    -------
    Mesh
        Node and facet sets are extended; the boundary keeps its shape.

    Raises
    ------
    MeshError
        For another element type, invalid lengths, or more than max_nodes nodes.
    """
    if edge_length <= 0 or radius < 0 or growth <= 0:
        raise MeshError("refinement needs a positive edge length and growth and a radius not below 0")
    point = np.asarray(centre, dtype=np.float64)

    def size(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return edge_length + growth * np.maximum(np.linalg.norm(x - point, axis=1) - radius, 0.0)

    fine = refine(mesh, size=size, max_nodes=max_nodes)
    return smooth(fine, rounds=smoothing) if smoothing and fine is not mesh else fine


def refine(mesh: Mesh, *, size: Size, max_nodes: int = 200_000) -> Mesh:
    """Refine a tet4 mesh until no edge is longer than size(its middle); node and facet sets are extended.

    The boundary keeps its shape: its triangles are cut, not moved. MeshError for another element type or more
    than max_nodes nodes.
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
    """Bisect all edges that are too long, and those required by them; None if no edge is too long."""
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
    # one order for the whole mesh: by length, equal lengths by number; lengths are rounded, so that the order
    # of symmetric edges does not depend on round-off
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
    """Cuts simplices at marked edges with sorted keys; the edge of highest rank is cut first."""

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
        """Index among the marked edges and rank of each edge; rank -1 if it is not marked."""
        key = edge_keys(pairs, self.n)
        at = np.minimum(np.searchsorted(self.keys, key), len(self.keys) - 1)
        # edges with a new node are not cut in the same pass, even if their key matches by chance
        found = (self.keys[at] == key) & (pairs.max(axis=-1) < self.n)
        return at, np.where(found, self.rank[at], -1)


def edge_keys(pairs: NDArray[np.integer], n_nodes: int) -> NDArray[np.int64]:
    """One number for each edge (..., 2), independent of its direction."""
    low, high = pairs.min(axis=-1).astype(np.int64), pairs.max(axis=-1).astype(np.int64)
    return low * n_nodes + high


def facet_edges(facets: NDArray[np.integer]) -> NDArray[np.integer]:
    """Edges (f, 3 or 4, 2) of facets (f, 3, 4, 6 or 8) by their corners: first-second, ..., last-first."""
    corners = facets[:, : 4 if facets.shape[1] in (4, 8) else 3]
    return np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)


def inherited_sets(mesh: Mesh, edges: NDArray[np.int64], first_new: int) -> dict[str, NDArray[np.int32]]:
    """Node sets of a linear mesh, extended by the nodes first_new + k in the middle of edges (k, 2).

    A set on the boundary is extended only along boundary facets that have all nodes in it: an edge through
    the body from the base to the inclusion has both ends held, but its middle is free. (A facet between two
    faces of the set that are one element apart counts as in it.) Any other set (a gripped volume) is extended
    along every edge with both ends in it.
    """
    boundary = boundary_facets(mesh.kind, mesh.elements)
    on_boundary = np.zeros(mesh.n_nodes, dtype=bool)
    on_boundary[boundary] = True
    keys = edge_keys(edges, mesh.n_nodes)
    result = {}
    for name, old in mesh.node_sets.items():
        member = np.zeros(mesh.n_nodes, dtype=bool)
        member[old] = True
        if on_boundary[old].all():
            inside = boundary[member[boundary].all(axis=1)]
            new: NDArray[np.bool_] = np.isin(keys, edge_keys(facet_edges(inside), mesh.n_nodes).ravel())
        else:
            new = np.asarray(member[edges].all(axis=1))
        result[name] = np.concatenate([old, first_new + np.flatnonzero(new)]).astype(np.int32)
    return result


def to_quadratic(mesh: Mesh, *, project: Projection | None = None) -> Mesh:
    """The mesh with a node in the middle of each edge: tet10 from tet4, hex20 from hex8.

    Corners keep their numbers, and sets are extended. A collapsed edge, in a wedge, gets no new node: its
    corner is used as its middle.

    Parameters
    ----------
    mesh : Mesh
        A tet4 or hex8 mesh; MeshError for another element type.
    project : callable (points) -> points, optional
        Projects middles (k, 3) [m] of the boundary's edges onto the true curved surface. If this inverts an
        element, or nearly so (det J below a tenth of the straight element's), the curvature of the element's
        edges is reduced in steps of a quarter, to 0 if necessary.
    """
    return curved(mesh, between=None if project is None else lambda ends: project(ends.mean(axis=1)))


def curved(mesh: Mesh, *, between: Between | None) -> Mesh:
    """Mesh of `to_quadratic`; `between` maps ends (k, 2, 3) of boundary edges to their middles (k, 3) [m]."""
    if mesh.kind not in _QUADRATIC:
        raise MeshError(f"only a tet4 or hex8 mesh can be made quadratic, this one is {mesh.kind}")
    kind, local = _QUADRATIC[mesh.kind]
    n = mesh.n_nodes
    pairs = mesh.elements[:, local].astype(np.int64)
    keys = np.unique(edge_keys(pairs, n))
    edges = np.stack(np.divmod(keys, n), axis=1)
    keys, edges = keys[edges[:, 0] != edges[:, 1]], edges[edges[:, 0] != edges[:, 1]]

    def middles_of(pairs: NDArray[np.integer]) -> NDArray[np.int64]:
        """Nodes in the middle of edges (..., 2)."""
        new = n + np.searchsorted(keys, edge_keys(pairs, n))
        return np.where(pairs[..., 0] == pairs[..., 1], pairs[..., 0], new)

    elements = np.concatenate([mesh.elements, middles_of(pairs)], axis=1).astype(np.int32)
    straight = mesh.nodes[edges].mean(axis=1)
    middles = straight.copy()
    boundary = boundary_facets(mesh.kind, mesh.elements)
    if between is not None:
        outer = np.flatnonzero(np.isin(keys, edge_keys(facet_edges(boundary), n).ravel()))
        middles[outer] = between(mesh.nodes[edges[outer]])
        _straighten(mesh.kind, mesh.nodes, elements, middles, straight)
    facets = {}
    for name, old in mesh.facet_sets.items():
        facets[name] = np.concatenate([old, middles_of(facet_edges(old))], axis=1).astype(np.int32)
    return Mesh(
        kind=kind,
        nodes=np.concatenate([mesh.nodes, middles]),
        elements=elements,
        node_sets=inherited_sets(mesh, edges, n),
        facet_sets=facets,
        symmetry=mesh.symmetry,
    )


def _straighten(
    kind: ElementKind,
    corners: NDArray[np.float64],
    elements: NDArray[np.int32],
    middles: NDArray[np.float64],
    straight: NDArray[np.float64],
) -> None:
    """Reduce in place the curvature at the middles of elements that it inverts, step by step."""
    n = len(corners)
    quadratic = _QUADRATIC[kind][0]
    width = len(NODE_PLACES[kind])
    centre = NODE_PLACES[kind].mean(axis=0)[None]
    # the collapsed nodes of a wedge have no volume
    places = quadrature(quadratic)[0] if quadratic == "hex20" else NODE_PLACES[quadratic]
    plain = det_jacobian(kind, corners, elements[:, :width], centre)[:, 0]
    bow, parts = middles - straight, np.zeros(len(middles), dtype=np.int64)
    while True:  # each round reduces the curvature of at least one edge
        nodes = np.concatenate([corners, middles])
        det = det_jacobian(quadratic, nodes, elements, places)
        back = np.unique(elements[det.min(axis=1) < 0.1 * plain, width:]) - n
        back = back[back >= 0]  # a collapsed edge has its corner there
        back = back[(parts[back] < len(CURVED) - 1) & bow[back].any(axis=1)]
        if not len(back):
            return
        parts[back] += 1
        middles[back] = straight[back] + CURVED[parts[back]][:, None] * bow[back]
