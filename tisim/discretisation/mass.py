"""Mass of a body: consistent matrix for the implicit method, lumped matrix for the explicit method."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.special import roots_jacobi

from tisim.discretisation.quadrature import facet_areas, shape
from tisim.linear.blocks import Pattern
from tisim.mesh import Mesh
from tisim.mesh._elements import cube_points
from tisim.mesh._mesh import HEXAHEDRA

Array = NDArray[np.float64]


def consistent_mass(mesh: Mesh, density: float, added: Array | None = None) -> sparse.csr_matrix:
    """rho integral(N_a N_b) over the mesh [kg], shape (n, n), the same for x, y and z.

    Point masses `added` (n,) [kg] are added to the diagonal.
    """
    local = _element_masses(mesh, density)
    width = mesh.elements.shape[1]
    rows = np.repeat(mesh.elements, width, axis=1).ravel()
    columns = np.tile(mesh.elements, (1, width)).ravel()
    mass = sparse.csr_matrix((local.ravel(), (rows, columns)), shape=(mesh.n_nodes, mesh.n_nodes))
    return mass if added is None else sparse.csr_matrix(mass + sparse.diags_array(added))


def lumped_mass(mesh: Mesh, density: float) -> Array:
    """Diagonal mass [kg], shape (n,); sums to the mesh's mass.

    For tet10 and hex20 it is the element's consistent diagonal, scaled to its mass (Hinton, Rock &
    Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976), since row sums are negative at the corners; for the
    other element types the row sums.
    """
    local = _element_masses(mesh, density)
    if mesh.kind in ("tet10", "hex20"):
        share = np.einsum("eaa->ea", local)
        share = share * (local.sum(axis=(1, 2)) / share.sum(axis=1))[:, None]
    else:
        share = local.sum(axis=2)
    mass = np.zeros(mesh.n_nodes)
    np.add.at(mass, mesh.elements.ravel(), share.ravel())
    return mass


def facet_mass(mesh: Mesh, facets: NDArray[np.int32], mass: float) -> Array:
    """Lumped mass of a uniform surface density on facets [kg], shape (n,); sums to `mass`.

    It is the scaled consistent diagonal, as in `lumped_mass`: row sums are negative at some corners.
    """
    n, area = facet_areas(mesh.nodes, facets)
    share = np.zeros(mesh.n_nodes)
    np.add.at(share, facets.ravel(), (area @ n**2).ravel())
    return share * (mass / share.sum())


def on_pattern(mass: sparse.csr_matrix, pattern: Pattern) -> Array:
    """Consistent mass at each block of the stiffness pattern [kg], shape (nb,)."""
    rows = np.repeat(np.arange(len(pattern.free)), np.diff(pattern.indptr))
    return np.asarray(mass[pattern.free[rows], pattern.free[pattern.indices]]).ravel()


def _element_masses(mesh: Mesh, density: float) -> Array:
    """Consistent element matrices [kg], shape (m, a, a)."""
    points, weights = _fine_quadrature(mesh.kind)
    n, d = shape(mesh.kind, points)
    det = np.linalg.det(np.einsum("eai,qak->eqik", mesh.nodes[mesh.elements], d))
    products = (n[:, :, None] * n[:, None, :]).reshape(len(n), -1)
    width = n.shape[1]
    return np.asarray(density * (det * weights) @ products).reshape(-1, width, width)


def _fine_quadrature(kind: str) -> tuple[Array, Array]:
    """27 Gauss points, exact to degree 5; the four points of a tet10's stiffness do not integrate N_a N_b."""
    if kind in HEXAHEDRA:
        return cube_points(3)
    g, w = np.polynomial.legendre.leggauss(3)
    # a collapsed cube: the Gauss-Jacobi weights (1 - b) and (1 - c)^2 are its Jacobian
    (gb, wb), (gc, wc) = roots_jacobi(3, 1.0, 0.0), roots_jacobi(3, 2.0, 0.0)
    a, b, c = (0.5 * (1.0 + t.ravel()) for t in np.meshgrid(g, gb, gc, indexing="ij"))
    points = np.column_stack([a * (1.0 - b) * (1.0 - c), b * (1.0 - c), c])
    return points, np.einsum("i,j,k->ijk", w / 2.0, wb / 4.0, wc / 8.0).ravel()
