"""Markers on a body with a closed-form motion: a rigid rotation, a quadratic field, an arc."""

from __future__ import annotations

import numpy as np
import pytest

import tisim
from calibration.measurements.release import marker_displacements, marker_motion
from calibration.measurements.release.kinematics import nearest_on_triangles

LENGTH, SIDE = 0.1, 0.03


def result_of(mesh, positions):
    """A result with these positions (f, n, 3); its other values are placeholders."""
    beam = tisim.Beam(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=1e5, bulk_modulus=1e6), length=LENGTH
    )
    f = len(positions)
    blank, vectors = np.zeros(f), np.zeros((f, 3))
    return tisim.Result(
        scene=beam, status=tisim.Status.CONVERGED, message="", mesh=mesh, load=np.arange(f, dtype=float),
        positions=np.asarray(positions), support_force=vectors, rod_force=vectors, rod_tip=vectors,
        penetration=blank, min_jacobian=blank, residual=blank, nominal_stress=blank, cost=tisim.Cost(),
    )  # fmt: skip


def bar(kind="tet10", mirror=False):
    section = tisim.Rectangle(width=SIDE, height=SIDE)
    return tisim.mesh.beam_mesh(
        length=LENGTH,
        section=section,
        kind=kind,
        axial_element_size=0.02,
        radial_elements=1 if kind == "tet10" else 2,
        mirror=mirror,
    )


def about_y(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


@pytest.mark.parametrize("kind", ["tet10", "tet4", "hex8"])
@pytest.mark.parametrize("mirror", [False, True])
def test_rigid_pendulum(kind, mirror):
    """A rigid beam rotating about the clamp's centre carries markers on it, off it and off its corner."""
    mesh = bar(kind, mirror)
    angles = np.array([0.0, 0.3, -1.2])
    swing = np.array([about_y(a) for a in angles])
    markers = np.array(
        [[0.1, 0.0, 0.021], [0.1, -0.021, 0.009], [0.037, 0.006, 0.015], [0.006, -0.025, -0.02]]
    )
    found = marker_motion(result_of(mesh, np.einsum("fij,nj->fni", swing, mesh.nodes)), markers)
    expected = np.einsum("fij,mj->mfi", swing, markers) - markers[:, None]
    np.testing.assert_allclose(found.displacement, expected, atol=1e-15)
    np.testing.assert_allclose(found.turn, np.broadcast_to(swing - np.eye(3), found.turn.shape), atol=1e-13)


def test_surface_markers_follow_a_quadratic_field_exactly():
    mesh = bar()
    x, y, z = mesh.nodes.T
    u = np.column_stack([0.3 * x * z, -0.2 * y * z, 0.4 * x**2 - 0.1 * y * x])
    markers = np.array([[0.0433, -0.0071, 0.015], [0.1, 0.0031, -0.0077], [0.021, 0.015, 0.002]])
    a, b, c = markers.T
    expected = np.column_stack([0.3 * a * c, -0.2 * b * c, 0.4 * a**2 - 0.1 * b * a])
    found = marker_displacements(result_of(mesh, [mesh.nodes + u]), markers)
    np.testing.assert_allclose(found[:, 0], expected, atol=1e-16)


def test_stalk_on_an_arc():
    """On an arc of curvature k, the section at x rotates by k x, and a stalk rotates with it."""
    mesh, k = bar(), 2.0
    x, y, z = mesh.nodes.T

    def bent(x, y, z):
        return np.column_stack([(1 / k + z) * np.sin(k * x), y, (1 / k + z) * np.cos(k * x) - 1 / k])

    tall = np.array([[0.1, 0.0, 0.025], [0.05, 0.004, -0.027]])  # above the end's edge; below the bottom face
    found = marker_displacements(result_of(mesh, [bent(x, y, z)]), tall)[:, 0]
    expected = bent(*tall.T) - tall
    assert np.linalg.norm(expected, axis=1).min() > 2e-3
    np.testing.assert_allclose(found, expected, atol=3e-5)


def test_nearest_point_of_a_triangle():
    """Nearest points inside the face, on an edge, and at a corner."""
    triangle = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    for at, nearest in [((0.2, 0.3, 5.0), (0.2, 0.3, 0.0)), ((0.5, -2.0, 1.0), (0.5, 0.0, 0.0)),
                        ((-1.0, 3.0, 0.0), (0.0, 1.0, 0.0))]:  # fmt: skip
        points, local = nearest_on_triangles(np.array(at), triangle)
        np.testing.assert_allclose(points[0], nearest, atol=1e-15)
        assert local.sum() == pytest.approx(1.0)


def test_a_mesh_without_a_surface_is_refused():
    mesh = bar()
    bare = tisim.Mesh(kind=mesh.kind, nodes=mesh.nodes, elements=mesh.elements)
    with pytest.raises(ValueError, match="facet set 'surface'"):
        marker_displacements(result_of(bare, [mesh.nodes]), [[0.1, 0.0, 0.0]])
