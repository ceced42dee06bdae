"""Beams without the rod's shape as initial guess: load steps from rest, and a status if these fail."""

import numpy as np
import pytest
from static_cases import neo_hookean

from tisim.material import Material
from tisim.problems.beam import equilibrium
from tisim.problems.beam.solve import solve_beam
from tisim.problems.beam.system import beam_discretisation, beam_system
from tisim.result import Status
from tisim.scene import Beam, Solver

BEAMS = [("clamped-free", 0.05), ("clamped-free", 0.1), ("clamped-clamped", 0.15)]
COARSE = {"axial_element_size": 0.0125, "radial_elements": 1}  # a status is a status on any mesh


@pytest.mark.parametrize("ratio", [20.0, 1000.0])
@pytest.mark.parametrize("mu", [9e3, 4e4])
@pytest.mark.parametrize(("supports", "length"), BEAMS)
def test_load_steps_from_rest_give_the_same_answer(supports, length, mu, ratio, monkeypatch):
    scene = Beam(material=neo_hookean(mu, ratio), length=length, supports=supports)
    quick = solve_beam(scene)
    monkeypatch.setattr(equilibrium, "rod_shape", lambda *_: None)
    slow = solve_beam(scene)
    assert quick.ok
    assert slow.ok
    assert slow.cost.steps > 1
    # with the potential alone the worst case takes 227 iterations, with element pressures as unknowns 23
    assert slow.cost.newton_iterations < 40
    size = np.abs(quick.positions - quick.mesh.nodes).max()
    assert np.abs(slow.positions - quick.positions).max() < 1e-6 * size


def test_load_steps_without_element_pressures(monkeypatch):
    """If the mixed iteration fails, the line search on the potential replaces it."""
    scene = Beam(material=neo_hookean(4e4, 100.0), length=0.1, solver=Solver(max_iterations=100))
    quick = solve_beam(scene)
    monkeypatch.setattr(equilibrium, "rod_shape", lambda *_: None)
    failed = equilibrium.Outcome(quick.mesh.nodes, Status.NOT_CONVERGED, 1.0, 1)
    monkeypatch.setattr(equilibrium, "mixed_newton", lambda *_: failed)
    slow = solve_beam(scene)
    assert slow.ok
    size = np.abs(quick.positions - quick.mesh.nodes).max()
    assert np.abs(slow.positions - quick.positions).max() < 1e-6 * size


def check_ended(result):
    assert result.positions.shape == (0, result.mesh.n_nodes, 3)
    assert result.support_force.shape == (0, 3)
    assert result.load.size == result.residual.size == result.min_jacobian.size == 0
    assert "no equilibrium found beyond" in result.message
    assert result.status.value in result.message


@pytest.mark.parametrize("ratio", [20.0, 1000.0])
def test_absurd_load_ends_with_a_status(ratio):
    """Shear modulus 10 Pa: the body's own weight is 50 times its stiffness."""
    scene = Beam(material=neo_hookean(10.0, ratio), length=0.05, solver=Solver(max_iterations=15), **COARSE)
    result = solve_beam(scene)
    if result.ok:
        weight = 1000 * 9.81 * np.pi * 0.01**2 * 0.05
        assert result.residual[0] <= scene.solver.tolerance
        assert result.min_jacobian[0] > 0
        assert result.support_force[0, 2] == pytest.approx(weight, rel=1e-5)
    else:
        check_ended(result)


def test_law_without_answer_under_pressure_ends_with_a_status():
    """A St Venant-Kirchhoff beam that stands on its grip under fifty times gravity collapses."""
    stiff = Material(law="st-venant-kirchhoff", parameters={"mu": 1e4, "lam": 5e4})
    scene = Beam(
        material=stiff, length=0.05, gravity=(-500.0, 0.0, 0.0), solver=Solver(max_iterations=15), **COARSE
    )
    result = solve_beam(scene)
    assert result.status is not Status.CONVERGED
    check_ended(result)


def test_no_load_is_rest():
    result = solve_beam(Beam(material=neo_hookean(1e4, 20.0), length=0.05, gravity=(0, 0, 0)))
    assert result.ok
    assert np.array_equal(result.positions[0], result.mesh.nodes)
    assert np.abs(result.support_force).max() < 1e-12


@pytest.mark.parametrize(("supports", "length"), BEAMS)
def test_bent_rods_sections_keep_their_volume(supports, length, monkeypatch):
    """With plane sections, instead, the volume changes by the bending strain."""
    scene = Beam(material=neo_hookean(2e4, 1000.0), length=length, supports=supports)
    discretisation = beam_discretisation(scene)
    body = beam_system(scene, discretisation).body
    middle = discretisation.mesh.nodes[discretisation.mesh.elements].mean(axis=1)[:, 0]
    free = (middle > 0.015) & (middle < length - (0.015 if supports == "clamped-clamped" else 0.0))

    def largest_change():
        guess = equilibrium.rod_shape(scene, body)
        return np.abs(body.pressures(guess)[free]).max() / body.moduli.bulk_modulus

    bent = largest_change()
    monkeypatch.setattr(equilibrium, "HELD", 1e3)  # all sections stay plane
    assert bent < 0.25 * largest_change()
