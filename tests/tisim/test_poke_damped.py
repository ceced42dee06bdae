"""Indentation steps solved as a damped motion: drag forces, final state, state after a failed motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tisim
from tisim.discretisation.body import Discretisation
from tisim.mesh import ElementKind
from tisim.mesh.indentation import poke_mesh
from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.damped import come_to_rest, solve_step
from tisim.problems.indentation.far_field import Drag
from tisim.problems.indentation.solve import solve_poke
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3)
TILTED = (np.sin(0.5), 0.0, -np.cos(0.5))


def poke(**options: Any) -> tisim.Poke:
    return tisim.Poke(
        **{"material": SOFT, "depth": 0.0012, "frame_spacing": 0.0004, "refinement": 0.5, **options}
    )


def system_of(scene: tisim.Poke, kind: ElementKind = "hex20") -> tuple[PokeSystem, CondensedBlock]:
    mesh = poke_mesh(
        block=scene.block, site=scene.site, direction=scene.direction, rod=scene.rod,
        refinement=scene.refinement, kind=kind,
    )  # fmt: skip
    system = PokeSystem(scene, Discretisation.build(mesh, mesh.node_sets["base"]))
    return system, CondensedBlock(system)


def at_equilibrium(scene: tisim.Poke, depth: float) -> tuple[PokeSystem, CondensedBlock]:
    """A system whose last accepted state is the equilibrium of a first step."""
    system, block = system_of(scene)
    system.move_to(depth)
    outcome, refused = solve_step(system, block, system.previous, tolerance=1e-4, kept=True)
    assert refused is None
    system.accept(outcome.x)
    return system, block


def test_drag_has_the_forces_of_its_energy_and_the_tangent_of_its_forces() -> None:
    system, _ = at_equilibrium(poke(friction=0.0), 0.0003)
    free = system.discretisation.pattern.free
    rng = np.random.default_rng(4)
    x = system.previous.copy()
    x[free] += 1e-6 * rng.standard_normal((len(free), 3))
    way = np.zeros_like(x)
    way[free] = rng.standard_normal((len(free), 3))
    plain, _ = system.linearise(x)
    v = way[free].ravel()
    without = system.multiply(v)
    stiffness = np.zeros(len(x))
    stiffness[free] = rng.uniform(100.0, 500.0, len(free))
    system.drag = Drag(system.previous, stiffness)
    dragged, _ = system.linearise(x)
    assert dragged - plain == pytest.approx(
        stiffness[free, None] * (x - system.previous)[free], rel=1e-9, abs=1e-12
    )
    h = 1e-7
    energy = [system.potential(x + sign * h * way)[0] for sign in (1.0, -1.0)]
    assert (energy[0] - energy[1]) / (2.0 * h) == pytest.approx(float(np.vdot(dragged, way[free])), rel=1e-4)
    assert system.multiply(v) - without == pytest.approx(np.repeat(stiffness[free], 3) * v, rel=1e-6)
    assert system.residual_norm(x) == pytest.approx(float(np.linalg.norm(dragged)), rel=1e-9)


def test_a_motion_ends_in_the_equilibrium_that_newton_finds() -> None:
    forces = []
    for moved in (False, True):
        system, block = at_equilibrium(poke(friction=0.0, direction=TILTED), 0.0003)
        system.move_to(0.0006)
        system.touch(system.previous)
        if moved:
            outcome = come_to_rest(
                system, block, system.previous, tolerance=1e-6, max_iterations=200, kept=True
            )
        else:
            for _ in range(3):  # until the contact's areas are those of the equilibrium, as after a motion
                outcome = block.solve(system.previous, tolerance=1e-6, max_iterations=40, kept=True)
                system.accept(outcome.x)
        assert outcome.status is Status.CONVERGED
        assert system.drag is None
        residual, load = system.residual(outcome.x)
        assert np.linalg.norm(residual) <= 1e-6 * load
        forces.append(system.report[:3].copy())
    assert forces[1] == pytest.approx(forces[0], rel=1e-4, abs=1e-4 * np.linalg.norm(forces[0]))


def test_a_drag_holds_where_it_is_told_to_whatever_the_start_value() -> None:
    found = []
    for start, held in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)):
        system, block = at_equilibrium(poke(friction=0.0, direction=TILTED), 0.0003)
        system.move_to(0.0004)
        x = system.previous
        ahead = x + 1e-4 * np.where(x[:, 2:] > 0.0, system.axis, 0.0)
        at, from_ = (ahead if start else x), (ahead if held else x)
        system.touch(at)
        outcome = block.solve(
            at, tolerance=1e-6, max_iterations=40, kept=False, drag=100.0, dragged_from=from_
        )
        assert outcome.status is Status.CONVERGED
        found.append(outcome.x)
    moved = float(np.abs(found[0] - x).max())
    assert found[1] == pytest.approx(found[0], abs=0.01 * moved)
    assert float(np.abs(found[2] - found[0]).max()) > 0.1 * moved


class Scripted:
    """A solver whose steps move the surface by `moved` [m], in given iterations; 0 is a failed step."""

    def __init__(self, iterations: list[int], left: float, moved: float = 1e-7) -> None:
        self.script, self.left, self.moved = iterations, left, moved
        self.drags: list[float] = []
        self.starts: list[float] = []
        self.attempts: list[int] = []

    def renew(self) -> None: ...

    def solve(self, x: Any, *, max_iterations: int, drag: float = 0.0, **options: Any) -> Outcome:
        if drag == 0.0:
            self.attempts.append(max_iterations)
            done = len(self.drags) == len(self.script)
            status = Status.CONVERGED if done else Status.NOT_CONVERGED
            return Outcome(x, status, self.left, max_iterations)
        self.drags.append(drag)
        self.starts.append(float(np.abs(x - options["dragged_from"]).max()))
        used = self.script[len(self.drags) - 1]
        if used == 0:
            return Outcome(x, Status.NOT_CONVERGED, 1.0, 10)
        return Outcome(options["dragged_from"] + self.moved, Status.CONVERGED, 1e-6, used)


def rest_of(block: Scripted) -> None:
    system, _ = at_equilibrium(poke(friction=0.0), 0.0003)
    system.move_to(0.0003)
    outcome = come_to_rest(
        system,
        block,
        system.previous,
        tolerance=1e-3,
        max_iterations=400,
        kept=True,  # type: ignore[arg-type]
    )
    assert outcome.status is Status.CONVERGED


def test_after_a_failed_step_the_drag_falls_slowly() -> None:
    block = Scripted([2, 2, 5, 0, 2, 2, 2, 2], left=1.0)
    rest_of(block)
    ratios = np.array(block.drags[1:]) / block.drags[:-1]
    # as fast as Newton's method converges; then four times as large, held, by half, and as before
    assert ratios.tolist() == [0.25, 0.25, 0.5, 4.0, 1.0, 0.5, 0.25]


def test_a_step_begins_with_the_motion_of_the_last() -> None:
    block = Scripted([2, 2, 0, 2, 2], left=1.0)
    rest_of(block)
    assert block.starts == pytest.approx([0.0, 1e-7, 1e-7, 0.0, 1e-7])  # none after a failed step


@pytest.mark.parametrize(("left", "more"), [(1.0, False), (1e-9, True)])
def test_an_attempt_without_hope_is_short(left: float, more: bool) -> None:
    block = Scripted([2, 2, 2], left=left, moved=1e-9)
    rest_of(block)
    tries = [n for n in block.attempts if n]
    assert tries[:2] == ([4, 8] if more else [4, 4])


@pytest.mark.parametrize("kind", ["hex20", "hex8"])
def test_a_motion_without_rest_leaves_no_trace(kind: ElementKind) -> None:
    softening = replace(SOFT, softening=tisim.OgdenRoxburgh(r=2.0, m=1e3, beta=0.1))
    found = []
    for tried in (False, True):
        system, block = system_of(poke(material=softening), kind)
        for depth in (0.0002, 0.0004):
            system.move_to(depth)
            system.begin(0.0)
            if tried and depth == 0.0004:
                failed = come_to_rest(
                    system, block, system.previous, tolerance=1e-9, max_iterations=48, kept=True
                )
                assert failed.status is not Status.CONVERGED
                assert failed.iterations >= 6
                system.move_to(depth)
            system.touch(system.previous)
            outcome = block.solve(system.previous, tolerance=1e-6, max_iterations=40, kept=True)
            assert outcome.status is Status.CONVERGED
            system.accept(outcome.x)
        found.append((outcome.x, system.report.copy(), system.body.dissipated()))
    assert found[1][0] == pytest.approx(found[0][0], abs=1e-8)
    assert found[1][1] == pytest.approx(found[0][1], rel=1e-4, abs=1e-6)
    assert found[1][2] == pytest.approx(found[0][2], rel=1e-3)


VISCOUS = replace(SOFT, viscosity=tisim.Prony(fractions=(0.5,), times=(0.2,)))


@pytest.mark.parametrize(
    "options",
    [
        {"element": "hex8"},
        # time advances once, for any number of motion steps
        {"material": VISCOUS, "course": tisim.Course(frames=(0.1, 0.2)).ramp(to=0.0008, speed=0.004)},
    ],
    ids=["by depth", "by a course"],
)
def test_a_poke_whose_steps_all_fail_at_first_is_the_same_poke(
    options: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = poke(direction=TILTED, depth=0.0008, **options)
    plain = solve_poke(scene)
    solve = CondensedBlock.solve
    motions: list[float] = []

    def failing(self: CondensedBlock, x: Any, **options: Any) -> Outcome:
        if options.get("drag"):
            motions.append(options["drag"])
        elif options["max_iterations"] == 20:
            return Outcome(x, Status.INVERTED, 1.0, 3)
        return solve(self, x, **options)

    monkeypatch.setattr(CondensedBlock, "solve", failing)
    moved = solve_poke(scene)
    assert moved.ok
    assert moved.cost.step_cuts == 0
    assert moved.load == pytest.approx(plain.load)
    assert len(motions) > 2 * moved.cost.steps  # several steps each, with decreasing drag
    assert min(motions) < 0.1 * max(motions)
    # friction continues from each intermediate state, so that forces differ as they do with other load steps
    assert moved.rod_force == pytest.approx(plain.rod_force, abs=0.02 * np.abs(plain.rod_force).max())
    assert (moved.residual <= 5e-4).all()
