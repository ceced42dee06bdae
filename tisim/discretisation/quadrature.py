"""Shape functions, quadrature and rest-shape gradients of tet4, tet10, hex8 and hex20 elements.

A hex8 has one point with its mean gradient and the points of the tetrahedra into which it is cut. The
tetrahedra prevent folding but are too stiff: a small fraction of them is accurate while the element keeps its
shape, a large one where a rod's edge folds it. Their fraction of the element's energy therefore rises with
the distortion of the worst tetrahedron at the last equilibrium. It falls only while the rod is retracted;
otherwise the retraction would be stiffer than the indentation. Within a load step it is constant, so that the
energy is one function. Any fraction passes the patch test, and on finer meshes, whose elements keep their
shape, the small fraction applies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.mesh import ElementKind, Mesh
from tisim.mesh._elements import (
    HEX_CUTS,
    NODE_PLACES,
    TET_EDGES,
    cube_points,
    cut_hexahedra,
    facet_shape_functions,
    serendipity,
)

Array = NDArray[np.float64]

_HEX_CORNERS = NODE_PLACES["hex8"]
_A, _B = 0.5854101966249685, 0.1381966011250105
# Fraction of a hexahedron's energy in its tetrahedra, see `_hexahedra` and `TetrahedralParts`.
TETRAHEDRAL_PART = 0.1
# That fraction if the worst tetrahedron's share of the volume falls below CRUSHED times its share at rest.
LARGEST_PART = 1.0
# Relative share of the volume at which the fraction begins to rise, and at which it is the largest. If it
# rises earlier, from 0.5 to 0.15, a thin cover over an inclusion, compressed to half, is 10 % too stiff with
# the default mesh and 7 % with one 2.6 times finer.
BENT, CRUSHED = 0.3, 0.05
# Fraction of a hex20's energy that is integrated at 27 points, the rest at 8: see `_fine_and_coarse`.
FINE_PART = 0.3


def quadrature(kind: ElementKind) -> tuple[Array, Array]:
    """Points (q, 3) and weights (q,) on the reference element."""
    if kind == "tet4":
        return np.full((1, 3), 0.25), np.array([1.0 / 6.0])
    if kind == "tet10":
        points = np.full((4, 3), _B)
        points[np.arange(1, 4), np.arange(3)] = _A
        return points, np.full(4, 1.0 / 24.0)
    if kind == "hex20":
        return _fine_and_coarse()
    return cube_points(2)


def _fine_and_coarse() -> tuple[Array, Array]:
    """Points (35, 3) and weights (35,) of a hex20: eight Gauss points, then 27, with FINE_PART of the weight.

    With eight points alone a hex20 has zero-energy modes; deep under a rod's edge it folds along them, and no
    equilibrium is found beyond 10 mm. With 27 alone it is too stiff (studies/depth). The sum is exact for
    what both rules integrate exactly, and passes the patch test. The 27 points carry only a small part of the
    volumetric stiffness (`bulk_shares`), since all of it would lock the element.
    """
    few, many = cube_points(2), cube_points(3)
    weights = np.concatenate([(1.0 - FINE_PART) * few[1], FINE_PART * many[1]])
    return np.concatenate([few[0], many[0]]), weights


def shape(kind: ElementKind, points: Array) -> tuple[Array, Array]:
    """Shape functions (q, a) and their reference gradients (q, a, 3) at reference points (q, 3)."""
    if kind == "hex20":
        return serendipity(points, NODE_PLACES["hex20"])
    if kind == "hex8":
        s = 1.0 + points[:, None, :] * _HEX_CORNERS
        n = s.prod(axis=2) / 8.0
        d = np.stack(
            [
                _HEX_CORNERS[:, 0] * s[:, :, 1] * s[:, :, 2],
                _HEX_CORNERS[:, 1] * s[:, :, 0] * s[:, :, 2],
                _HEX_CORNERS[:, 2] * s[:, :, 0] * s[:, :, 1],
            ],
            axis=2,
        )
        return n, d / 8.0
    bary = np.column_stack([1.0 - points.sum(axis=1), points])
    dbary = np.array([[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    if kind == "tet4":
        return bary, np.broadcast_to(dbary, (len(points), 4, 3)).copy()
    n = np.empty((len(points), 10))
    d = np.empty((len(points), 10, 3))
    n[:, :4] = bary * (2.0 * bary - 1.0)
    d[:, :4] = (4.0 * bary - 1.0)[:, :, None] * dbary
    for e, (i, j) in enumerate(TET_EDGES):
        n[:, 4 + e] = 4.0 * bary[:, i] * bary[:, j]
        d[:, 4 + e] = 4.0 * (bary[:, i, None] * dbary[j] + bary[:, j, None] * dbary[i])
    return n, d


@dataclass(frozen=True, eq=False)
class Reference:
    """Quadrature data of a mesh's rest shape.

    Attributes
    ----------
    values : shape functions at the points, shape (q, a).
    gradients : gradients of the shape functions in the rest shape [1/m], shape (m, q, a, 3).
    weights : rest volumes of the points [m3], shape (m, q).
    """

    values: Array
    gradients: Array
    weights: Array


def reference(mesh: Mesh) -> Reference:
    """Rest-shape gradients and weights; ValueError if an element is inverted at a quadrature point."""
    if mesh.kind == "hex8":
        return _hexahedra(mesh)
    points, weights = quadrature(mesh.kind)
    n, d = shape(mesh.kind, points)
    corners = mesh.nodes[mesh.elements]
    jac = np.einsum("eai,qak->eqik", corners, d)
    det = np.linalg.det(jac)
    _refuse_inside_out(det)
    gradients = np.einsum("qak,eqki->eqai", d, np.linalg.inv(jac))
    return Reference(n, np.ascontiguousarray(gradients), np.ascontiguousarray(det * weights))


def _refuse_inside_out(det: Array) -> None:
    bad = (det <= 0).any(axis=1)
    if bad.any():
        raise ValueError(
            f"mesh: {int(bad.sum())} elements are inside-out, the first is element {int(np.argmax(bad))}"
        )


def _hexahedra(mesh: Mesh) -> Reference:
    """Quadrature data of hex8: one point with the mean gradient, ten with those of the cut tetrahedra.

    With Gauss points alone, a hexahedron under a rod's edge folds between them. The mean gradient (Flanagan
    and Belytschko 1981) is soft and has hourglass modes; linear tetrahedra are stiff and cannot fold while
    their det F is positive. TETRAHEDRAL_PART of the energy is that of the tetrahedra. The average of both
    five-tetrahedra cuts favours no diagonal, agrees between neighbours (the patch test holds), and has
    exactly the volume of the trilinear element. In a wedge, represented as a hexahedron with repeated nodes,
    the tetrahedra that vanish have weight 0.
    """
    points, weights = quadrature("hex8")
    _, d = shape("hex8", points)
    corners = mesh.nodes[mesh.elements]
    jac = np.einsum("eai,qak->eqik", corners, d)
    det = np.linalg.det(jac)
    _refuse_inside_out(det)
    gauss = det * weights
    volume = gauss.sum(axis=1)
    mean = np.einsum("eq,qak,eqki->eai", gauss, d, np.linalg.inv(jac)) / volume[:, None, None]
    edges, six, vanished = cut_hexahedra(corners, volume)
    _refuse_inside_out(np.where(vanished, 1.0, six))
    edges[vanished] = np.eye(3)
    inverse = np.linalg.inv(edges)  # columns: gradients of the last three nodes' shape functions
    gradients = np.zeros((len(corners), 11, 8, 3))
    gradients[:, 0] = mean
    for t, nodes in enumerate(HEX_CUTS):
        for k in range(3):
            gradients[:, 1 + t, nodes[1 + k]] = inverse[:, t, :, k]
        gradients[:, 1 + t, nodes[0]] = -inverse[:, t].sum(axis=2)
    where = np.nonzero(vanished)
    gradients[where[0], 1 + where[1]] = mean[where[0]]
    share = TETRAHEDRAL_PART
    weight = np.column_stack([(1.0 - share) * volume, np.where(vanished, 0.0, 0.5 * share * six / 6.0)])
    values = np.zeros((11, 8))
    values[0] = 1.0 / 8.0
    values[np.arange(1, 11)[:, None], HEX_CUTS] = 0.25
    return Reference(values, gradients, np.ascontiguousarray(weight))


def bulk_shares(kind: ElementKind, pointwise: float, whole: float) -> tuple[float, Array]:
    """Bulk stiffness of an element's mean volumetric strain, and of that at each point (q,) [Pa].

    Parameters
    ----------
    kind : ElementKind
    pointwise : float
        Part of `whole` that applies at all points without locking [Pa]. The rest goes into one pressure per
        element or, in a hex20, to its eight points (selective reduced integration: Malkus and Hughes 1978).
    whole : float
        Bulk stiffness of the material [Pa].
    """
    n = len(quadrature(kind)[1]) if kind != "hex8" else 11
    shares = np.full(n, pointwise)
    if kind != "hex20":
        return whole - pointwise, shares
    shares[:8] = (whole - FINE_PART * pointwise) / (1.0 - FINE_PART)
    return 0.0, shares


def facet_quadrature(n_nodes: int, order: int = 3) -> tuple[Array, Array, Array]:
    """Quadrature of a facet of 3, 4, 6 or 8 nodes with `order` points along each side.

    Triangles have collapsed Gauss points. Returns shape functions (q, a), their reference gradients (q, a, 2)
    and weights (q,).
    """
    g, w = np.polynomial.legendre.leggauss(order)
    u, v = (c.ravel() for c in np.meshgrid(g, g, indexing="ij"))
    weights = np.outer(w, w).ravel()
    if n_nodes in (4, 8):
        return *facet_shape_functions(n_nodes, np.column_stack([u, v])), weights
    r = 0.5 * (1 + u)
    s = 0.5 * (1 + v) * (1 - r)
    return *facet_shape_functions(n_nodes, np.column_stack([r, s])), weights * 0.25 * (1 - r)


def facet_areas(nodes: Array, facets: NDArray[np.int32], order: int = 3) -> tuple[Array, Array]:
    """Shape functions (q, a) at a facet's points, and areas of the points (f, q) [m2] at positions (n, 3)."""
    n, dn, w = facet_quadrature(facets.shape[1], order)
    tangents = np.einsum("fai,qad->fqdi", nodes[facets], dn)
    area = np.linalg.norm(np.cross(tangents[:, :, 0], tangents[:, :, 1]), axis=2) * w
    return n, area


def facet_load(mesh: Mesh, facets: NDArray[np.int32]) -> Array:
    """Consistent nodal loads of a unit traction [m2], shape (n,); they sum to the facets' area."""
    n, area = facet_areas(mesh.nodes, facets)
    share = np.zeros(mesh.n_nodes)
    np.add.at(share, facets.ravel(), (area @ n).ravel())
    return share


class TetrahedralParts:
    """Updates the weights of a hex8 reference in place by the distortion that its elements have had so far.

    Attributes
    ----------
    may_recover : bool
        True if the fraction of tetrahedra may fall again.
    """

    def __init__(self, mesh: Mesh, reference: Reference) -> None:
        self._elements = mesh.elements
        self._weights = reference.weights
        self._volume = reference.weights.sum(axis=1)
        # each cut fills the hexahedron, so that both count half; 0 for a tetrahedron that vanishes in a wedge
        self._whole = reference.weights[:, 1:] / TETRAHEDRAL_PART
        self._there = self._whole > 0.0
        self._rest = np.where(self._there, 2.0 * self._whole, 1.0)
        self._worst = np.ones(mesh.n_elements)
        self.may_recover = False

    def state(self) -> tuple[Array, Array]:
        """Copy of the present state, for `restore`."""
        return self._worst.copy(), self._weights.copy()

    def restore(self, state: tuple[Array, Array]) -> None:
        """Return to an earlier state."""
        self._worst[:], self._weights[:] = state

    def update(self, x: Array) -> None:
        """Update the weights for positions x (n, 3)."""
        corners = x[self._elements][:, HEX_CUTS]
        a, b, c = (corners[:, :, k] - corners[:, :, 0] for k in (1, 2, 3))
        volume = (a * np.cross(b, c)).sum(axis=2) / 6.0
        mean = np.where(self._there, volume, 0.0).sum(axis=1) / (2.0 * self._volume)
        least = np.where(self._there, volume / self._rest, np.inf).min(axis=1)
        self._worst = least / mean if self.may_recover else np.minimum(self._worst, least / mean)
        t = np.clip((BENT - self._worst) / (BENT - CRUSHED), 0.0, 1.0)
        part = TETRAHEDRAL_PART + (LARGEST_PART - TETRAHEDRAL_PART) * t * t * (3.0 - 2.0 * t)
        self._weights[:, 1:] = part[:, None] * self._whole
        self._weights[:, 0] = (1.0 - part) * self._volume
