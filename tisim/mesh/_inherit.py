"""Which new nodes in the middle of edges belong to the sets of the nodes at their ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import Mesh, boundary_facets


def edge_keys(pairs: NDArray[np.integer], n_nodes: int) -> NDArray[np.int64]:
    """One number for each edge, whatever its direction; pairs (..., 2)."""
    low, high = pairs.min(axis=-1).astype(np.int64), pairs.max(axis=-1).astype(np.int64)
    return low * n_nodes + high


def facet_edges(facets: NDArray[np.integer]) -> NDArray[np.integer]:
    """Edges (f, 3, 2) of triangles by their corners (f, 3 or 6): first-second, second-third, third-first."""
    return facets[:, [[0, 1], [1, 2], [2, 0]]]


def inherited_sets(mesh: Mesh, edges: NDArray[np.int64], first_new: int) -> dict[str, NDArray[np.int32]]:
    """Node sets of a tet4 mesh extended by the nodes first_new + k in the middle of edges (k, 2).

    A set that lies on the boundary passes on only along boundary facets that lie in it as a whole: an
    edge through the body from the base to the inclusion has both ends held, yet its middle is free. (A
    facet between two faces of the set, one element from each other, counts as in it.) Any
    other set (a gripped volume) passes on along every edge with both ends in it.
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
