"""Better-shaped tetrahedra by moving interior nodes; the boundary stays where it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._errors import MeshError
from tisim.mesh._mesh import Mesh, boundary_facets


def smooth(mesh: Mesh, *, rounds: int = 3) -> Mesh:
    """Move interior nodes of a tet4 mesh to the mean centre of their elements, weighted by volume.

    A node moves only where the worst of its elements (mean ratio) gets no worse by the moves around it.
    Nodes of named node sets stay, so that a gripped volume keeps its end.
    """
    if mesh.kind != "tet4":
        raise MeshError(f"only a tet4 mesh can be smoothed, this one is {mesh.kind}")
    free = np.ones(mesh.n_nodes, dtype=bool)
    free[boundary_facets("tet4", mesh.elements)] = False
    for fixed in mesh.node_sets.values():
        free[fixed] = False
    nodes = mesh.nodes.copy()
    for _ in range(rounds):
        nodes = _round(nodes, mesh.elements, free)
    return replace(mesh, nodes=nodes)


def _round(
    nodes: NDArray[np.float64], elements: NDArray[np.int32], free: NDArray[np.bool_]
) -> NDArray[np.float64]:
    corner = nodes[elements]
    volume = _volumes(corner)
    weight, target = np.zeros(len(nodes)), np.zeros_like(nodes)
    np.add.at(weight, elements, volume[:, None])
    np.add.at(target, elements, (volume[:, None] * corner.mean(axis=1))[:, None])
    target /= np.where(weight > 0, weight, 1.0)[:, None]
    worst = _worst(mean_ratio(corner), elements, len(nodes))
    moving = free.copy()
    # each pass takes back the moves around the elements that got too bad; none is left in the end
    while moving.any():
        moved = np.where(moving[:, None], target, nodes)
        ratio = mean_ratio(moved[elements])
        bad = (ratio[:, None] < worst[elements] * (1 - 1e-9)) & moving[elements]
        if not bad.any():
            return moved
        moving[elements[bad.any(axis=1)]] = False
    return nodes


def _volumes(corner: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6


def _worst(value: NDArray[np.float64], elements: NDArray[np.int32], n_nodes: int) -> NDArray[np.float64]:
    worst = np.full(n_nodes, np.inf)
    np.minimum.at(worst, elements, value[:, None])
    return worst


def mean_ratio(corner: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shape of tetrahedra (m, 4, 3): 12 (3 V)^(2/3) over the sum of squared edges, 1 for a regular one,
    0 or less where turned over (Liu and Joe 1994)."""
    volume = _volumes(corner)
    pairs = corner[:, [0, 1, 2, 0, 1, 2]] - corner[:, [1, 2, 0, 3, 3, 3]]
    return 12 * np.cbrt((3 * volume) ** 2) * np.sign(volume) / (pairs**2).sum(axis=(1, 2))
