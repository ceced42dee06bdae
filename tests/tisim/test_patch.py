"""Patch test: on distorted meshes, an affine motion of the boundary gives the affine motion inside."""

import numpy as np
import pytest
from static_cases import awkward, body_of, boundary, settle

from tisim.laws import evaluate

F = np.array([[1.15, 0.25, -0.1], [0.05, 0.9, 0.2], [-0.12, 0.08, 1.05]])
# a volume change of 1 %: much more would be a hydrostatic tension of several G, for which a soft body
# (also this one, whose elements have one pressure) has other equilibria, with cavities
F *= np.cbrt(1.01 / np.linalg.det(F))


def affine(mesh):
    return mesh.nodes @ F.T + [0.01, -0.02, 0.03]


def start(mesh, rng):
    """The affine motion with random displacements of the interior nodes."""
    x = affine(mesh)
    inside = np.setdiff1d(np.arange(mesh.n_nodes), boundary(mesh))
    assert len(inside) > 3
    x[inside] += rng.uniform(-3e-4, 3e-4, (len(inside), 3))
    return x


@pytest.mark.parametrize("law", ["neo-hookean", "ogden"])
@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8", "hex20"])
def test_affine_boundary_motion_gives_the_affine_inside(kind, law):
    mesh = awkward(kind, (3, 3, 3))
    body = body_of(mesh, law, boundary(mesh))
    x = settle(body, start(mesh, np.random.default_rng(1)))
    assert np.abs(x - affine(mesh)).max() < 1e-9 * np.ptp(mesh.nodes)


@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8", "hex20"])
def test_energy_and_boundary_forces_of_an_affine_motion_are_the_laws(kind):
    mesh = awkward(kind)
    body = body_of(mesh, "mooney-rivlin", boundary(mesh))
    psi, P, _ = (v[0] for v in evaluate("mooney-rivlin", body.material.parameters, F[None]))
    volume = body.discretisation.nodal_volume().sum()
    assert body.energy(affine(mesh))[0] == pytest.approx(psi * volume, rel=1e-12)
    force, least = body.internal_forces(affine(mesh))
    assert least == pytest.approx(np.linalg.det(F), rel=1e-12)
    # virial theorem: sum of forces times positions = stress times volume
    assert force.T @ mesh.nodes == pytest.approx(P * volume, rel=1e-9, abs=1e-9 * np.abs(P).max() * volume)


def test_bent_quadratic_tetrahedra_pass_to_the_accuracy_of_their_quadrature():
    """Four points integrate the gradients of curved elements to second order only."""
    errors = []
    for bend in (4e-4, 8e-4):
        mesh = awkward("tet10", (3, 3, 3), bend=bend)
        x = settle(body_of(mesh, "neo-hookean", boundary(mesh)), affine(mesh))
        errors.append(np.abs(x - affine(mesh)).max() / np.ptp(mesh.nodes))
    assert 1e-9 < errors[0] < errors[1] < 2e-3
    assert errors[1] / errors[0] > 2.5


def test_rigid_motion_costs_nothing():
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    for kind in ("tet4", "tet10", "hex8", "hex20"):
        mesh = awkward(kind)
        body = body_of(mesh, "stable-neo-hookean", boundary(mesh))
        x = mesh.nodes @ turn.T + 0.5
        assert abs(body.energy(x)[0]) < 1e-16
        assert np.abs(body.internal_forces(x)[0]).max() < 1e-10
