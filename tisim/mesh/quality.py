"""How good a mesh is: volumes, determinants, scaled Jacobians."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import Mesh
from tisim.mesh._reference import NODE_PLACES, corner_triads, det_jacobian, quadrature


@dataclass(frozen=True, kw_only=True)
class Quality:
    """volume: of the mesh [m3] (a half model's is half the body's); min_det: the least det J over
    the nodes of its element, relative to the element's mean det J (1 for a straight tetrahedron, 0 or
    less where the element is turned over); scaled Jacobian as `scaled_jacobian` states."""

    n_nodes: int
    n_elements: int
    volume: float
    min_det: float
    min_scaled_jacobian: float
    mean_scaled_jacobian: float


def volumes(mesh: Mesh) -> NDArray[np.float64]:
    """Volume of each element [m3], by a quadrature that is exact for curved elements, shape (m,)."""
    places, weights = quadrature(mesh.kind)
    return det_jacobian(mesh.kind, mesh.nodes, mesh.elements, places) @ weights


def nodal_determinants(mesh: Mesh) -> NDArray[np.float64]:
    """det J at each node of each element [m3], shape (m, nodes per element); positive in a valid mesh.

    A collapsed node of a wedge (hex8 with repeated nodes) has 0 there.
    """
    return det_jacobian(mesh.kind, mesh.nodes, mesh.elements, NODE_PLACES[mesh.kind])


def scaled_jacobian(mesh: Mesh) -> NDArray[np.float64]:
    """The least of the corners' triple products of unit edges, shape (m,): 1 for a cube and for a
    regular tetrahedron (where the product is multiplied by sqrt 2), 0 or less where turned over
    (Knupp 2000, as in VTK's verdict). Edges of 10-node tetrahedra count as straight."""
    x = mesh.nodes[mesh.elements[:, corner_triads(mesh.kind)]]
    edges = x[:, :, 1:] - x[:, :, :1]
    length = np.linalg.norm(edges, axis=-1, keepdims=True)
    unit = np.divide(edges, length, out=np.zeros_like(edges), where=length > 0)
    least = np.linalg.det(unit).min(axis=1)
    if mesh.kind == "hex8":
        return least
    # for a tetrahedron VTK divides by the largest product of three edges at a corner
    triple = np.abs(np.linalg.det(edges)).max(axis=1)
    product = length[..., 0].prod(axis=-1).max(axis=1)
    return np.sign(least) * np.divide(triple, product, out=np.zeros_like(triple), where=product > 0) * 2**0.5


def quality(mesh: Mesh) -> Quality:
    """The figures of a mesh, for a report or a test."""
    det = nodal_determinants(mesh)
    scaled = scaled_jacobian(mesh)
    volume = volumes(mesh)
    reference = {"tet4": 1 / 6, "tet10": 1 / 6, "hex8": 8.0}[mesh.kind]
    return Quality(
        n_nodes=mesh.n_nodes,
        n_elements=mesh.n_elements,
        volume=float(volume.sum()),
        min_det=float((det.min(axis=1) * reference / np.abs(volume)).min()),
        min_scaled_jacobian=float(scaled.min()),
        mean_scaled_jacobian=float(scaled.mean()),
    )
