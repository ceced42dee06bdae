"""Named node and facet sets, added to a mesh by where its nodes lie."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._errors import MeshError
from tisim.mesh._mesh import Mesh, boundary_facets

# a mask over the nodes (n,), or a function of their positions (n, 3) [m] that gives one
NodeMask = NDArray[np.bool_] | Callable[[NDArray[np.float64]], NDArray[np.bool_]]


def with_node_set(mesh: Mesh, name: str, mask: NodeMask) -> Mesh:
    """The mesh with node set `name`: the nodes where mask is true."""
    chosen = np.flatnonzero(_mask(mesh, name, mask)).astype(np.int32)
    if not len(chosen):
        raise MeshError(f"node set {name!r} would be empty: no node lies where it was asked for")
    return replace(mesh, node_sets={**mesh.node_sets, name: chosen})


def with_facet_set(mesh: Mesh, name: str, mask: NodeMask) -> Mesh:
    """The mesh with facet set `name`: the boundary facets all of whose nodes are where mask is true."""
    facets = mesh.facet_sets.get("surface")
    if facets is None:
        facets = boundary_facets(mesh.kind, mesh.elements)
    chosen = facets[_mask(mesh, name, mask)[facets].all(axis=1)]
    if not len(chosen):
        raise MeshError(f"facet set {name!r} would be empty: no boundary facet lies where it was asked for")
    return replace(mesh, facet_sets={**mesh.facet_sets, name: chosen})


def _mask(mesh: Mesh, name: str, mask: NodeMask) -> NDArray[np.bool_]:
    result = np.asarray(mask(mesh.nodes) if callable(mask) else mask)
    if result.shape != (mesh.n_nodes,) or result.dtype != np.bool_:
        raise MeshError(
            f"set {name!r}: the mask must be {mesh.n_nodes} booleans, one a node, "
            f"got shape {result.shape} of {result.dtype}"
        )
    return result
