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
from tisim.problems.indentation.solve import solve_poke
from tisim.problems.indentation.system import Drag, PokeSystem
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
                system, block, system.previous, tolerance=1e-4, max_iterations=200, kept=True
            )
        else:
            outcome = block.solve(system.previous, tolerance=1e-4, max_iterations=40, kept=True)
        assert outcome.status is Status.CONVERGED
        assert system.drag is None
        residual, load = system.residual(outcome.x)
        assert np.linalg.norm(residual) <= 1e-4 * load
        forces.append(system.report[:3].copy())
    assert forces[1] == pytest.approx(forces[0], rel=1e-3, abs=1e-3 * np.linalg.norm(forces[0]))


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
                    system, block, system.previous, tolerance=1e-9, max_iterations=16, kept=True
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
        {},
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
