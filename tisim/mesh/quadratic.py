"""10-node tetrahedra from 4-node ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._errors import MeshError
from tisim.mesh._inherit import edge_keys, facet_edges, inherited_sets
from tisim.mesh._mesh import Mesh, boundary_facets
from tisim.mesh._reference import NODE_PLACES, TET_EDGES, det_jacobian

Projection = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def to_quadratic(mesh: Mesh, *, project: Projection | None = None) -> Mesh:
    """The mesh with a node in the middle of each edge; corners keep their numbers, sets are extended.

    project: puts points (k, 3) [m] of the boundary's edges onto the true curved surface. Where that
    would turn an element over, or nearly (det J below a tenth of the straight element's), the element's
    edges stay straight.
    """
    if mesh.kind != "tet4":
        raise MeshError(f"only a tet4 mesh can be made quadratic, this one is {mesh.kind}")
    n = mesh.n_nodes
    pairs = mesh.elements[:, TET_EDGES].astype(np.int64)
    keys, first, place = np.unique(edge_keys(pairs, n), return_index=True, return_inverse=True)
    edges = pairs.reshape(-1, 2)[first]
    elements = np.concatenate([mesh.elements, n + place.reshape(-1, 6)], axis=1).astype(np.int32)
    straight = mesh.nodes[edges].mean(axis=1)
    middles = straight.copy()
    boundary = boundary_facets("tet4", mesh.elements)
    if project is not None:
        outer = np.flatnonzero(np.isin(keys, edge_keys(facet_edges(boundary), n).ravel()))
        middles[outer] = project(straight[outer])
        _straighten(mesh.nodes, elements, middles, straight)
    facets = {}
    for name, old in mesh.facet_sets.items():
        middle = n + np.searchsorted(keys, edge_keys(facet_edges(old), n))
        facets[name] = np.concatenate([old, middle], axis=1).astype(np.int32)
    return Mesh(
        kind="tet10",
        nodes=np.concatenate([mesh.nodes, middles]),
        elements=elements,
        node_sets=inherited_sets(mesh, edges, n),
        facet_sets=facets,
        symmetry=mesh.symmetry,
    )


def _straighten(
    corners: NDArray[np.float64],
    elements: NDArray[np.int32],
    middles: NDArray[np.float64],
    straight: NDArray[np.float64],
) -> None:
    """Set back (in place) the middles of elements that the curve turns over."""
    n = len(corners)
    plain = det_jacobian("tet4", corners, elements[:, :4], NODE_PLACES["tet4"][:1])[:, 0]
    while True:  # each round straightens an edge at least, and straight elements are good
        nodes = np.concatenate([corners, middles])
        det = det_jacobian("tet10", nodes, elements, NODE_PLACES["tet10"])
        bad = det.min(axis=1) < 0.1 * plain
        if not bad.any():
            return
        back = np.unique(elements[bad, 4:]) - n
        middles[back] = straight[back]
