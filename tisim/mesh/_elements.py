"""Reference elements: node coordinates, shape-function gradients, quadrature.

Natural coordinates (r, s, t): tetrahedra on the unit simplex, hexahedra on [-1, 1]^3, both in VTK's node
order.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._mesh import HEXAHEDRA, ElementKind

# tet10: end nodes of the edge whose middle is node 4 to 9
TET_EDGES = np.array([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)])

# hex20: the same for nodes 8 to 19
HEX_EDGES = np.array(
    [*((0, 1), (1, 2), (2, 3), (3, 0)), *((4, 5), (5, 6), (6, 7), (7, 4)), *((0, 4), (1, 5), (2, 6), (3, 7))]
)

_HEX8 = np.array(
    [[x, y, z] for z in (-1.0, 1.0) for x, y in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))]
)
_TET4 = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
NODE_PLACES: dict[ElementKind, NDArray[np.float64]] = {
    "tet4": _TET4,
    "tet10": np.concatenate([_TET4, _TET4[TET_EDGES].mean(axis=1)]),
    "hex8": _HEX8,
    "hex20": np.concatenate([_HEX8, _HEX8[HEX_EDGES].mean(axis=1)]),
}
# nodes of a quad8: corners, then the edges' middles
QUAD_PLACES = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]])

_BARYCENTRIC_GRADIENT = np.array([[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def shape_gradients(kind: ElementKind, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivatives of the shape functions by (r, s, t) at points (q, 3), shape (q, nodes, 3)."""
    if kind == "tet4":
        return np.broadcast_to(_BARYCENTRIC_GRADIENT, (len(places), 4, 3))
    if kind == "tet10":
        L = np.concatenate([1 - places.sum(axis=1, keepdims=True), places], axis=1)
        D = _BARYCENTRIC_GRADIENT
        a, b = TET_EDGES.T
        corners = (4 * L - 1)[:, :, None] * D
        edges = 4 * (L[:, a, None] * D[b] + L[:, b, None] * D[a])
        return np.concatenate([corners, edges], axis=1)
    if kind == "hex20":
        return serendipity(places, NODE_PLACES["hex20"])[1]
    sign = NODE_PLACES["hex8"]
    factor = 1 + places[:, None, :] * sign
    others = factor[..., [1, 2, 0]] * factor[..., [2, 0, 1]]
    return 0.125 * sign * others


def serendipity(
    places: NDArray[np.float64], nodes: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Serendipity shape functions (q, a) and their derivatives (q, a, d) at points `places` (q, d).

    In d natural coordinates, with node a at s_a: prod_i (1 + x_i s_ai) / 2^d (sum_i x_i s_ai - d + 1) for a
    corner; (1 - x_k^2) prod_(i != k) (1 + x_i s_ai) / 2^(d - 1) for the middle of an edge along k.
    """
    x, s = places[:, None, :], nodes[None]
    d = nodes.shape[1]
    factor = np.where(s == 0.0, 1.0 - x * x, 1.0 + x * s)
    slope = np.where(s == 0.0, -2.0 * x, s)
    corner = (nodes != 0.0).all(axis=1)
    scale = 0.5 ** (nodes != 0.0).sum(axis=1)
    level = np.where(corner, (x * s).sum(axis=2) - (d - 1), 1.0)
    product = scale * factor.prod(axis=2)
    by_axis = [slope[..., k] * np.delete(factor, k, axis=2).prod(axis=2) for k in range(d)]
    gradient = (scale * level)[..., None] * np.stack(by_axis, axis=2)
    return product * level, gradient + product[..., None] * np.where(corner[:, None], nodes, 0.0)


def facet_shape_functions(
    n_nodes: int, places: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shape functions (q, a) of a facet of 3, 4, 6 or 8 nodes, and derivatives (q, a, 2), at points (q, 2).

    Natural coordinates: triangles on the unit simplex, quadrangles on [-1, 1]^2.
    """
    if n_nodes == 4:
        s, t = QUAD_PLACES[:4].T
        a, b = 1 + places[:, :1] * s, 1 + places[:, 1:] * t
        return a * b / 4, np.stack([s * b, t * a], axis=2) / 4
    if n_nodes == 8:
        return serendipity(places, QUAD_PLACES)
    bary = np.column_stack([1 - places[:, 0] - places[:, 1], places])
    d = np.array([[-1.0, -1], [1, 0], [0, 1]])
    if n_nodes == 3:
        return bary, np.broadcast_to(d, (len(places), 3, 2)).copy()
    n = np.empty((len(places), 6))
    dn = np.empty((len(places), 6, 2))
    n[:, :3] = bary * (2 * bary - 1)
    dn[:, :3] = (4 * bary - 1)[:, :, None] * d
    for e, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
        n[:, 3 + e] = 4 * bary[:, i] * bary[:, j]
        dn[:, 3 + e] = 4 * (bary[:, i, None] * d[j] + bary[:, j, None] * d[i])
    return n, dn


def quadrature(kind: ElementKind) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (q, 3) and weights (q,) that are exact for the volume of a curved element.

    det J is at most cubic for tet10, quadratic in each coordinate for hex8, and of degree five for hex20.
    """
    if kind == "tet4":
        return np.full((1, 3), 0.25), np.array([1 / 6])
    if kind == "tet10":
        # degree 3 (Stroud T3:3-1): the centre, with a negative weight, and four points around it
        around = np.full((4, 3), 1 / 6)
        around[np.arange(3), np.arange(3)] = 0.5
        return np.concatenate([np.full((1, 3), 0.25), around]), np.array([-0.8, *[0.45] * 4]) / 6
    if kind == "hex20":
        return cube_points(3)
    return NODE_PLACES["hex8"] / 3**0.5, np.ones(8)


def cube_points(order: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gauss points (order^3, 3) of [-1, 1]^3 and their weights."""
    g, w = np.polynomial.legendre.leggauss(order)
    places = np.stack(np.meshgrid(g, g, g, indexing="ij"), axis=-1).reshape(-1, 3)
    return places, np.einsum("i,j,k->ijk", w, w, w).ravel()


# The two cuts of a hexahedron into five tetrahedra, all positive: four at corners and one in the middle.
HEX_CUTS = np.array(
    [
        *([0, 1, 3, 4], [2, 3, 1, 6], [5, 4, 6, 1], [7, 6, 4, 3], [1, 6, 3, 4]),
        *([1, 2, 0, 5], [3, 0, 2, 7], [4, 5, 0, 7], [6, 7, 2, 5], [0, 7, 5, 2]),
    ]
)


def cut_hexahedra(
    corners: NDArray[np.float64], volume: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """The tetrahedra of HEX_CUTS in hexahedra with corners (m, 8, 3) and volumes (m,).

    Returns edges from the first node (m, 10, 3, 3), six times the volumes (m, 10), and True for tetrahedra
    that vanish in a wedge (m, 10).
    """
    tets = corners[:, HEX_CUTS]
    edges = tets[:, :, 1:] - tets[:, :, :1]
    six = np.linalg.det(edges)
    return edges, six, np.abs(six) < 1e-12 * volume[:, None]


def is_sound(kind: ElementKind, nodes: NDArray[np.float64], elements: NDArray[np.int32]) -> bool:
    """True if no element is inverted at the points of `quadrature` or, for hex8, in the cut tetrahedra."""
    places, weights = quadrature(kind)
    det = det_jacobian(kind, nodes, elements, places)
    if det.min() <= 0.0:
        return False
    if kind != "hex8":
        return True
    _, six, vanished = cut_hexahedra(nodes[elements], (det * weights).sum(axis=1))
    return bool((vanished | (six > 0.0)).all())


def det_jacobian(
    kind: ElementKind,
    nodes: NDArray[np.float64],
    elements: NDArray[np.int32],
    places: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Determinant of the map from the reference element at points (q, 3) [m3], shape (m, q)."""
    gradient = shape_gradients(kind, places)
    # one product of matrices, and the determinants written out: 3 x 3 each, they are too small for calls
    corners = np.ascontiguousarray(nodes[elements].transpose(1, 2, 0)).reshape(elements.shape[1], -1)
    (a, b, c), (d, e, f), (g, h, i) = (
        (gradient[..., k] @ corners).reshape(len(places), 3, len(elements)).swapaxes(0, 1) for k in range(3)
    )
    found: NDArray[np.float64] = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return found.T


def corner_triads(kind: ElementKind) -> NDArray[np.int64]:
    """Each corner and its three neighbours in right-handed order, shape (corners, 4)."""
    if kind not in HEXAHEDRA:
        return np.array([[0, 1, 2, 3], [1, 2, 0, 3], [2, 0, 1, 3], [3, 0, 2, 1]])
    ring = [*range(4), 0]
    low = [(b, c, a, b + 4) for (a, b), c in zip(pairwise([3, *ring[:-1]]), ring[1:], strict=True)]
    return np.array(low + [(n + 4, p + 4, m + 4, u - 4) for n, m, p, u in low])
