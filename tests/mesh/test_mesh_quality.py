"""Volumes, determinants and scaled Jacobians against closed forms."""

import numpy as np
import pytest

from tisim.mesh._elements import NODE_PLACES, quadrature, serendipity, shape_gradients
from tisim.mesh._mesh import Mesh
from tisim.mesh.quality import nodal_determinants, quality, scaled_jacobian, volumes

REGULAR = np.array([[1.0, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]])[[0, 1, 3, 2]]


def one(kind, nodes):
    return Mesh(kind=kind, nodes=nodes, elements=np.arange(len(nodes))[None])


def test_regular_tetrahedron_and_cube_are_perfect():
    sign = np.sign(np.linalg.det(REGULAR[1:] - REGULAR[0]))
    nodes = REGULAR if sign > 0 else REGULAR[[0, 2, 1, 3]]
    tet, cube = one("tet4", nodes), one("hex8", NODE_PLACES["hex8"])
    assert scaled_jacobian(tet) == pytest.approx(1)
    assert scaled_jacobian(cube) == pytest.approx(1)
    assert volumes(tet) == pytest.approx(8 / 3)
    assert volumes(cube) == pytest.approx(8)
    assert nodal_determinants(cube) == pytest.approx(1)


def test_turned_over_elements_are_negative():
    for mesh in (
        one("tet4", NODE_PLACES["tet4"][[0, 2, 1, 3]]),
        one("hex8", NODE_PLACES["hex8"][[4, 5, 6, 7, 0, 1, 2, 3]]),
    ):
        assert scaled_jacobian(mesh) < 0
        assert volumes(mesh) < 0
        assert quality(mesh).min_det < 0


def test_scaled_jacobian_of_a_sheared_cube_is_the_cosine():
    nodes = NODE_PLACES["hex8"].copy()
    nodes[:, 0] += 0.5 * nodes[:, 2]
    assert scaled_jacobian(one("hex8", nodes)) == pytest.approx(1 / np.sqrt(1.25))


def test_volume_of_a_curved_tetrahedron_is_exact():
    """Two mid-side nodes of a tetrahedron with 6 V = 1 are displaced.

    The quadrature is exact for the cubic det J, checked against a rule with many points.
    """
    nodes = NODE_PLACES["tet10"].copy()
    nodes[5] += [0.05, 0.07, 0.02]
    nodes[9] += [-0.03, 0.04, 0.06]
    mesh = one("tet10", nodes)
    t, w = np.polynomial.legendre.leggauss(6)
    t, w = (t + 1) / 2, w / 2
    a, b, c = (g.ravel() for g in np.meshgrid(t, t, t, indexing="ij"))
    weight = np.einsum("i,j,k->ijk", w, w, w).ravel() * (1 - a) ** 2 * (1 - b)
    places = np.stack([a, (1 - a) * b, (1 - a) * (1 - b) * c], axis=1)
    det = np.linalg.det(np.einsum("qnk,ni->qik", shape_gradients("tet10", places), nodes))
    assert volumes(mesh)[0] == pytest.approx(det @ weight, rel=1e-12)
    assert volumes(mesh)[0] != pytest.approx(1 / 6, rel=1e-3)


@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8", "hex20"])
def test_shape_gradients_reproduce_a_linear_field(kind):
    places, weights = quadrature(kind)
    gradient = shape_gradients(kind, places)
    field = NODE_PLACES[kind] @ [2.0, -3.0, 5.0] + 7
    assert np.einsum("qnk,n->qk", gradient, field) == pytest.approx(np.tile([2.0, -3, 5], (len(places), 1)))
    assert weights.sum() == pytest.approx(8 if kind in ("hex8", "hex20") else 1 / 6)


def test_quadratic_hexahedra_hold_quadratic_fields_on_their_edges():
    """Shape functions are 1 at their node and 0 at the others, sum to 1, and have the stated derivatives."""
    places = NODE_PLACES["hex20"]
    values, _ = serendipity(places, places)
    assert values == pytest.approx(np.eye(20), abs=1e-15)
    at = np.random.default_rng(2).uniform(-1, 1, (5, 3))
    values, slopes = serendipity(at, places)
    assert values.sum(axis=1) == pytest.approx(1.0)
    x, y, z = places.T
    a, b, c = at.T
    assert values @ (x * y + z * z - 2 * x) == pytest.approx(a * b + c * c - 2 * a)
    h = 1e-6
    for k in range(3):
        step = h * np.eye(3)[k]
        found = (serendipity(at + step, places)[0] - serendipity(at - step, places)[0]) / (2 * h)
        assert slopes[:, :, k] == pytest.approx(found, abs=1e-8)


def test_edge_middle_too_far_out_is_seen():
    nodes = NODE_PLACES["tet10"].copy()
    nodes[4] = [0.1, 0, 0]  # nearer to the corner than a quarter: det J is negative there
    assert quality(one("tet10", nodes)).min_det < 0
    nodes[4] = [0.3, 0, 0]
    assert quality(one("tet10", nodes)).min_det > 0
