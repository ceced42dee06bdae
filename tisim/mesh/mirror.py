"""The whole body of a mesh that is cut by mirror planes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import Mesh

# Nodes of an element in the order that keeps its volume positive when it is seen in a mirror.
_TURNED = {"tet4": (0, 2, 1, 3), "tet10": (0, 2, 1, 3, 6, 5, 4, 7, 9, 8), "hex8": (0, 3, 2, 1, 4, 7, 6, 5)}
_TURNED_FACET = {3: (0, 2, 1), 4: (0, 3, 2, 1), 6: (0, 2, 1, 5, 4, 3)}


def unfold(mesh: Mesh, positions: NDArray[np.float64]) -> tuple[Mesh, NDArray[np.float64]]:
    """The whole body of a mesh cut by mirror planes, and its node positions.

    positions: (..., n, 3) [m] -> (..., whole n, 3); the nodes of the mesh come first, in their order.
    Node sets hold both halves, facet sets too; sets of the mirror planes are dropped.
    """
    for name in mesh.symmetry:
        mesh, positions = _unfold_once(mesh, positions, name)
    return mesh, positions


def _unfold_once(mesh: Mesh, positions: NDArray[np.float64], name: str) -> tuple[Mesh, NDArray[np.float64]]:
    axis, n = "xyz".index(name), mesh.n_nodes
    plane = f"mirror_{name}"
    copied = np.ones(n, dtype=bool)
    copied[mesh.node_sets[plane]] = False
    twin = np.arange(n)
    twin[copied] = n + np.arange(copied.sum())
    sign = np.ones(3)
    sign[axis] = -1.0
    nodes = np.concatenate([mesh.nodes, mesh.nodes[copied] * sign])
    moved = np.concatenate([positions, positions[..., copied, :] * sign], axis=-2)
    elements = np.concatenate([mesh.elements, twin[mesh.elements[:, _TURNED[mesh.kind]]]])
    facets = {
        key: np.concatenate([f, twin[f[:, _TURNED_FACET[f.shape[1]]]]]).astype(np.int32)
        for key, f in mesh.facet_sets.items()
        if key != plane
    }
    sets = {
        key: np.unique(np.concatenate([s, twin[s]])).astype(np.int32)
        for key, s in mesh.node_sets.items()
        if key != plane
    }
    whole = replace(
        mesh,
        nodes=nodes,
        elements=elements.astype(np.int32),
        node_sets=sets,
        facet_sets=facets,
        symmetry=tuple(s for s in mesh.symmetry if s != name),
    )
    return whole, moved
