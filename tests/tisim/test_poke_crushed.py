"""Pokes of crushed tissue: contact points and areas, steps cut before a motion is tried, late frames."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tisim
from tisim.discretisation.body import Discretisation
from tisim.mesh.indentation import poke_mesh
from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation import course as by_course
from tisim.problems.indentation import damped, steps
from tisim.problems.indentation import solve as by_depth
from tisim.problems.indentation import system as contact
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.damped import LONGEST, solve_step
from tisim.problems.indentation.solve import solve_poke
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

SCENE = tisim.Poke(
    material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
    direction=(np.sin(0.5), 0.0, -np.cos(0.5)),
    depth=0.0008,
    frame_spacing=0.0003,
    refinement=0.5,
)


@pytest.fixture(scope="module")
def mesh() -> tisim.Mesh:
    return poke_mesh(
        block=SCENE.block, site=SCENE.site, direction=SCENE.direction, rod=SCENE.rod, refinement=0.5
    )


def start(mesh: tisim.Mesh) -> tuple[PokeSystem, CondensedBlock]:
    system = PokeSystem(SCENE, Discretisation.build(mesh, mesh.node_sets["base"]))
    return system, CondensedBlock(system)


def step_to(system: PokeSystem, block: CondensedBlock, depth: float) -> np.ndarray:
    system.move_to(depth)
    outcome, refused = solve_step(system, block, system.previous, tolerance=1e-4, kept=True)
    assert refused is None
    return outcome.x


def test_deep_penetration_adds_points_that_keep_the_friction(
    mesh: tisim.Mesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the same surface they carry the same force, and the same slip of earlier steps."""
    forces, slips = [], []
    for added in (False, True):
        system, block = start(mesh)
        system.accept(step_to(system, block, 0.0003))
        x = step_to(system, block, 0.0006)
        if added:
            assert not system.finer
            monkeypatch.setattr(contact, "FINER_FROM", 0.0)
        system.accept(x)
        assert system.finer is added
        system.move_to(0.0006)
        system.touch(x)
        system.residual(x)
        forces.append(system.report[:3].copy())
        slips.append(np.einsum("fq,fqi->i", system._area, system._memory))
    for found, wanted in ((forces[1], forces[0]), (slips[1], slips[0])):
        assert np.linalg.norm(wanted) > 0.0
        assert found == pytest.approx(wanted, abs=0.1 * float(np.linalg.norm(wanted)))


@pytest.mark.parametrize(("across", "along", "factor"), [(2.0, 3.0, 6.0), (9.0, 9.0, 30.0), (0.5, 1.0, 1.0)])
def test_contact_acts_on_the_area_of_the_deformed_surface(
    mesh: tisim.Mesh, across: float, along: float, factor: float
) -> None:
    """Up to 30 times that at rest; a surface that is compressed keeps the latter."""
    system, _ = start(mesh)
    at_rest = system._area.copy()
    stretched = mesh.nodes * [across, along, 1.0]
    system.accept(stretched, follow=False)
    assert system._area == pytest.approx(at_rest)
    system.accept(stretched)
    assert system._area == pytest.approx(factor * at_rest)
    system.accept(mesh.nodes)
    assert system._area == pytest.approx(at_rest)  # back with the surface


@pytest.mark.parametrize(
    ("rod", "unit"),
    [
        (tisim.Rod(), 1e-3),
        (tisim.Rod(edge_radius=5e-4), 5e-4),
        (tisim.Rod(tip="hemisphere"), 1e-3),  # 0.4 of its radius
    ],
)
@pytest.mark.parametrize(("part", "finer"), [(0.21, False), (0.23, True)])
def test_penetrations_are_judged_by_the_edge_radius_that_the_penalty_has(
    mesh: tisim.Mesh,
    monkeypatch: pytest.MonkeyPatch,
    rod: tisim.Rod,
    unit: float,
    part: float,
    finer: bool,
) -> None:
    system = PokeSystem(replace(SCENE, rod=rod), Discretisation.build(mesh, mesh.node_sets["base"]))
    monkeypatch.setattr(system, "overlap", lambda _: part * unit)
    system.accept(mesh.nodes)
    assert system.finer is finer
    assert not steps.too_deep(mesh.nodes, system)
    monkeypatch.setattr(system, "overlap", lambda _: 0.51 * unit)
    assert steps.too_deep(mesh.nodes, system)


def test_areas_that_follow_keep_the_forces(mesh: tisim.Mesh) -> None:
    """Normal ones and friction: once the penetration has adapted, a larger area bears the same force."""
    forces = []
    for follow in (False, True):
        system, block = start(mesh)
        system.accept(step_to(system, block, 0.0003), follow=False)
        before = system._area.copy()
        system.accept(system.previous, follow=follow)
        grown = system._area / before
        assert bool(grown.max() > 1.05) is follow  # where the edge stretches the surface
        assert np.array_equal(
            system._memory, system._slip
        )  # at the same slip a larger area bears more friction
        system.accept(step_to(system, block, 0.0003), follow=False)
        forces.append(system.report[:3].copy())
    assert forces[1] == pytest.approx(forces[0], abs=0.01 * float(np.linalg.norm(forces[0])))
    assert np.linalg.norm(forces[0][:2]) > 0.0


def test_the_areas_of_a_motion_follow_until_it_is_nearly_at_rest(
    mesh: tisim.Mesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise each state would be out of equilibrium by the change of its areas."""
    system, block = start(mesh)
    system.move_to(0.0003)
    drags: list[tuple[float, bool]] = []
    accept = system.accept

    def noted(x: np.ndarray, *, follow: bool = True) -> None:
        assert system.drag is not None
        drags.append((float(np.linalg.norm(system.drag.forces(x))) / system.rod_force(), follow))
        accept(x, follow=follow)

    monkeypatch.setattr(system, "accept", noted)
    monkeypatch.setattr(damped, "NEAR", 0.5)  # rest is sought late
    tolerance = 2e-3
    moved = damped.come_to_rest(
        system, block, system.previous, tolerance=tolerance, max_iterations=160, kept=True
    )
    assert moved.status is Status.CONVERGED
    assert {follow for _, follow in drags} == {False, True}
    assert all(follow is (drag > tolerance) for drag, follow in drags)


def test_an_earlier_state_has_its_own_points(mesh: tisim.Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    system, block = start(mesh)
    system.accept(step_to(system, block, 0.0003))
    system.move_to(0.0006)
    system.touch(system.previous)
    before, x = system.remembered(), system.previous
    wanted, _ = system.residual(x)
    monkeypatch.setattr(contact, "FINER_FROM", 0.0)
    areas = system._area.copy()
    system.accept(step_to(system, block, 0.0006))
    assert system.finer
    system.recall(before)
    system.move_to(0.0006)
    system.touch(x)
    assert not system.finer
    assert np.array_equal(system._area, areas)
    assert system.residual(x)[0] == pytest.approx(wanted, abs=1e-12)


def test_a_poke_with_more_points_has_the_same_force(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = solve_poke(SCENE)
    monkeypatch.setattr(contact, "FINER_FROM", 0.0)
    finer = solve_poke(SCENE)
    assert finer.ok
    assert not np.array_equal(finer.rod_force, plain.rod_force)
    size = float(np.linalg.norm(plain.rod_force[-1]))
    assert finer.rod_force == pytest.approx(plain.rod_force, abs=0.03 * size)


@pytest.mark.parametrize(("least", "deep"), [(0.22, False), (0.0, True)])
def test_a_long_step_whose_start_value_is_deep_in_the_rod_is_shorter(
    monkeypatch: pytest.MonkeyPatch, least: float, deep: bool
) -> None:
    lengths: list[float] = []

    def noted(*arguments: Any, length: float, **others: Any) -> tuple[Outcome, Status | None]:
        lengths.append(length)
        return solve_step(*arguments, length=length, **others)

    monkeypatch.setattr(by_depth, "solve_step", noted)
    monkeypatch.setattr(steps, "DEEP_AT_LEAST", least)
    result = solve_poke(SCENE)
    assert result.ok
    assert result.cost.step_cuts == 0  # no iteration is lost
    assert sum(lengths) == pytest.approx(0.0008)
    assert (max(lengths) < LONGEST + 1e-9) is deep


@pytest.mark.parametrize("length", [0.9 * LONGEST, 1.1 * LONGEST])
def test_a_long_step_is_refused_without_a_motion(
    mesh: tisim.Mesh, monkeypatch: pytest.MonkeyPatch, length: float
) -> None:
    system, block = start(mesh)
    system.move_to(0.0003)
    moved = Outcome(system.previous, Status.CONVERGED, 1e-5, 7)
    monkeypatch.setattr(damped, "come_to_rest", lambda *_, **__: moved)
    failed = Outcome(system.previous, Status.NOT_CONVERGED, 1.0, 20)
    monkeypatch.setattr(CondensedBlock, "solve", lambda *_, **__: failed)
    outcome, refused = solve_step(system, block, system.previous, tolerance=1e-4, kept=True, length=length)
    if length > LONGEST:
        assert (refused, outcome.iterations) == (Status.NOT_CONVERGED, 20)
    else:
        assert (refused, outcome.iterations) == (None, 27)


@pytest.mark.parametrize("deep", [False, True])
def test_a_state_that_nearly_converges_is_refused_if_it_is_too_deep_in_the_rod(
    mesh: tisim.Mesh, monkeypatch: pytest.MonkeyPatch, deep: bool
) -> None:
    system, block = start(mesh)
    system.move_to(0.0003)
    nearly = Outcome(system.previous, Status.NOT_CONVERGED, 1e-3, 20)
    monkeypatch.setattr(CondensedBlock, "solve", lambda *_, **__: nearly)
    monkeypatch.setattr(damped, "too_deep", lambda *_: deep)
    options = {"tolerance": 1e-4, "kept": True, "length": 2.0 * LONGEST, "between": 2e-3}
    outcome, refused = solve_step(system, block, system.previous, **options)  # type: ignore[arg-type]
    assert outcome is nearly
    assert refused is (Status.NOT_CONVERGED if deep else None)


@pytest.mark.parametrize(
    ("owner", "options"),
    [(by_depth, {}), (by_course, {"course": tisim.Course().ramp(to=0.0008, duration=1.0)})],
)
def test_each_step_states_its_length(
    owner: Any, options: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    lengths: list[float] = []

    def noted(*arguments: Any, length: float, **others: Any) -> tuple[Outcome, Status | None]:
        lengths.append(length)
        return solve_step(*arguments, length=length, **others)

    monkeypatch.setattr(owner, "solve_step", noted)
    assert solve_poke(replace(SCENE, **options)).ok
    assert sum(lengths) == pytest.approx(0.0008)
    assert min(lengths) > 0.0


@pytest.mark.parametrize(("residual", "first"), [(5.9e-3, 0.00033), (6.1e-3, 0.0003)])
def test_a_frame_that_nearly_converges_is_a_step(
    monkeypatch: pytest.MonkeyPatch, residual: float, first: float
) -> None:
    """Within a step's tolerance, twelve times a frame's, it is kept as a step, and the frame comes later.

    Above it a motion finds the frame where it was asked for.
    """
    solve, count = CondensedBlock.solve, iter(range(100))

    def first_frame_fails(self: CondensedBlock, x: Any, **options: Any) -> Outcome:
        outcome = solve(self, x, **options)
        if options["kept"] and next(count) == 0:
            return replace(outcome, status=Status.NOT_CONVERGED, residual=residual)
        return outcome

    monkeypatch.setattr(CondensedBlock, "solve", first_frame_fails)
    result = solve_poke(replace(SCENE, solver=tisim.Solver(tolerance=5e-4)))
    assert result.ok, result.message
    assert result.cost.step_cuts == 0
    assert (result.residual <= 5e-4).all()
    assert result.load == pytest.approx([first, first + 0.0003, 0.0008])


@pytest.mark.parametrize(("depth", "refused"), [(0.0019, None), (0.0021, Status.PENETRATION)])
def test_no_rod_goes_into_a_rigid_inclusion(
    monkeypatch: pytest.MonkeyPatch, depth: float, refused: Status | None
) -> None:
    """Nor if the surface, squeezed aside, is outside of the rod."""
    box = tisim.BoxInclusion(centre=(0.0, 0.0, 0.015), size=(0.02, 0.02, 0.03))
    scene = replace(SCENE, block=tisim.Block(inclusion=box), direction=(0.0, 0.0, -1.0))
    own = poke_mesh(
        block=scene.block, site=scene.site, direction=scene.direction, rod=scene.rod, refinement=0.5
    )
    system = PokeSystem(scene, Discretisation.build(own, own.node_sets["base"]))
    system.move_to(depth)
    aside = system.previous - [0.0, 0.0, 0.005]
    converged = Outcome(aside, Status.CONVERGED, 1e-5, 3)
    monkeypatch.setattr(CondensedBlock, "solve", lambda *_, **__: converged)
    found = solve_step(system, CondensedBlock(system), aside, tolerance=1e-4, kept=True, length=1.0)
    assert found[1] is refused
