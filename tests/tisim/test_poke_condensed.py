"""A block with its far tissue condensed: a step equals Newton's step on the whole block."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import tisim
from tisim.discretisation.body import Discretisation
from tisim.mesh import ElementKind
from tisim.mesh.indentation import poke_mesh
from tisim.nonlinear.contact_newton import contact_newton
from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation import condensed as condensed_module
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.far_field import Forces
from tisim.problems.indentation.solve import solve_poke
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

Array = NDArray[np.float64]


def scene(depth: float = 0.002) -> tisim.Poke:
    return tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        direction=(0.3, 0.0, -0.9),
        depth=depth,
        refinement=0.5,
        gravity=(0.0, 0.0, -9.81),
    )


def pressed(depth: float = 0.0003, *, kind: ElementKind = "hex20") -> tuple[PokeSystem, Array]:
    """An indenter in contact with an undeformed block."""
    poke = scene()
    mesh = poke_mesh(
        block=poke.block,
        site=poke.site,
        direction=poke.direction,
        rod=poke.rod,
        refinement=poke.refinement,
        kind=kind,
    )
    it = PokeSystem(poke, Discretisation.build(mesh, mesh.node_sets["base"]))
    it.move_to(depth)
    x = mesh.nodes.copy()
    it.touch(x)
    return it, x


OPTIONS: dict[str, Any] = {"tolerance": 5e-4, "max_iterations": 40, "kept": True}


def test_a_step_is_newtons_on_the_whole_block() -> None:
    """Elimination and back-substitution of the far tissue solve the same linear system, in two parts."""
    it, x = pressed(0.0001, kind="hex8")  # in hex20 the tangent at this overlap is indefinite
    rng = np.random.default_rng(3)
    free = it.discretisation.pattern.free
    x[free] += 2e-5 * rng.standard_normal((len(free), 3))
    residual, _ = it.linearise(x)
    whole = it.step(residual, forcing=1e-9)

    block = CondensedBlock(it)
    block._choose(x)
    split = block._split
    assert split is not None
    assert 30 < len(split.near.body.discretisation.pattern.free) < 0.6 * len(free)
    it.residual(x)
    left = block._place(split, x, Forces(*split.near.body.forces_and_energy(x)))
    part = it.restricted(split.near, split.far)
    part.linear._limit = 80  # its factor has the blocks of neighbours only
    near, _ = part.linearise(x)
    moved = part.advance(x, part.step(near, forcing=1e-9))
    found = block._follow(split, x, moved, left)
    scale = np.abs(whole).max()
    # the complement is in single precision
    assert found[free] - x[free] == pytest.approx(whole, abs=2e-5 * scale)
    fixed = np.setdiff1d(np.arange(len(x)), free)
    assert np.array_equal(found[fixed], x[fixed])


def test_equilibrium_is_that_of_the_whole_block() -> None:
    it, x = pressed()
    outcome = CondensedBlock(it).solve(x, **OPTIONS)
    assert outcome.status is Status.CONVERGED
    residual, load = it.residual(outcome.x)
    assert np.linalg.norm(residual) <= 5e-4 * load
    assert outcome.residual == pytest.approx(np.linalg.norm(residual) / load)
    whole = contact_newton(it, x, tolerance=1e-6, max_iterations=40, kept=True)
    assert whole.status is Status.CONVERGED
    free = it.discretisation.pattern.free
    moved = np.abs(whole.x - x)[free].max()
    assert np.abs(outcome.x - whole.x)[free].max() < 0.02 * moved


def test_the_far_tangent_serves_several_steps() -> None:
    it, x = pressed(0.0001)
    block = CondensedBlock(it)
    for depth in (0.0001, 0.0003, 0.0005, 0.0007):
        it.move_to(depth)
        it.touch(x)
        outcome = block.solve(x, **OPTIONS)
        assert outcome.status is Status.CONVERGED
        x = outcome.x
        it.accept(x)
    assert block.condensations < 4
    assert block.rounds >= 4
    assert block.factorisations >= block.condensations
    assert block.iterations > 0
    assert block.linear_iterations > 0


def test_near_nodes_are_chosen_anew_where_the_rod_has_gone_on() -> None:
    it, x = pressed()
    block = CondensedBlock(it)
    x = block.solve(x, **OPTIONS).x
    first = block._split
    it.accept(x)
    it.move_to(0.0006)
    it.touch(x)
    x = block.solve(x, **OPTIONS).x
    assert block._split is first
    it.accept(x)
    it.move_to(0.006)
    it.touch(x)
    block.solve(x, **OPTIONS)
    assert block._split is not first


def test_forces_of_the_last_two_states_are_not_computed_again() -> None:
    it, x = pressed()
    computed: list[Array] = []
    forces = it.body.forces_and_energy

    def counted(x: Array) -> tuple[Array, float, float]:
        computed.append(x)
        return forces(x)

    it.body.forces_and_energy = counted  # type: ignore[method-assign]
    trial, further = x + 1e-5, x + 2e-5
    for state in (trial, further):
        it.potential(state)
    kept = it.residual(trial)[0]
    it.residual(further)
    assert [a is b for a, b in zip(computed, (trial, further), strict=True)] == [True, True]
    fresh = it.residual(trial.copy())[0]  # states are compared by identity
    assert len(computed) == 3
    assert np.array_equal(kept, fresh)


def test_forces_of_the_parts_are_those_of_the_whole_block() -> None:
    it, x = pressed()
    block = CondensedBlock(it)
    block._choose(x)
    split = block._split
    assert split is not None
    x = x + 1e-5 * np.random.default_rng(4).standard_normal(x.shape)
    x[it.discretisation.fixed] = it.discretisation.mesh.nodes[it.discretisation.fixed]
    found = split.together(x, Forces(*split.near.body.forces_and_energy(x)))
    force, energy, min_jacobian = it.body.forces_and_energy(x)
    assert found.force == pytest.approx(force, abs=1e-12 * np.abs(force).max())
    assert found.energy == pytest.approx(energy, rel=1e-9)
    assert found.min_jacobian == min_jacobian


def test_a_round_begins_with_the_near_forces_of_its_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also after a step that is taken in part, whose state no near iteration has seen."""
    it, x = pressed()
    block = CondensedBlock(it)
    place, sound = CondensedBlock._place, CondensedBlock._sound
    off: list[float] = []

    def placed(self: CondensedBlock, split: Any, x: Array, near: Forces) -> Array:
        off.append(float(np.abs(near.force - split.near.body.forces_and_energy(x)[0]).max()))
        return place(self, split, x, near)

    def in_part(self: CondensedBlock, x: Array, moved: Array) -> tuple[Array | None, float]:
        return (x + 0.5 * (moved - x), 0.5) if len(off) == 1 else sound(self, x, moved)

    monkeypatch.setattr(CondensedBlock, "_place", placed)
    monkeypatch.setattr(CondensedBlock, "_sound", in_part)
    assert block.solve(x, **OPTIONS).status is Status.CONVERGED
    assert len(off) > 2
    assert max(off) < 1e-12


def test_trying_a_part_leaves_the_state_of_contact_alone() -> None:
    it, x = pressed()
    x = CondensedBlock(it).solve(x, **OPTIONS).x
    it.accept(x)
    it.move_to(0.0005)
    it.touch(x)
    it.linearise(x)
    kept = [a.copy() for a in (it._memory, it._part, it.previous)]
    CondensedBlock(it).solve(x, **OPTIONS)
    for a, b in zip(kept, (it._memory, it._part, it.previous), strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("reach", [-1.0, 100.0], ids=["nothing near", "all near"])
def test_a_block_without_two_parts_is_solved_whole(monkeypatch: pytest.MonkeyPatch, reach: float) -> None:
    monkeypatch.setattr(condensed_module, "REACH", reach)
    it, x = pressed()
    block = CondensedBlock(it)
    outcome = block.solve(x, **OPTIONS)
    assert block._split is None
    assert outcome.status is Status.CONVERGED
    assert block.iterations == outcome.iterations > 0
    assert block.condensations == 0


def test_iterations_end_at_their_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    it, x = pressed()
    asked: list[int] = []

    def slow(_part: PokeSystem, x: Array, *, max_iterations: int, **_: Any) -> Outcome:
        asked.append(max_iterations)
        return Outcome(x, Status.NOT_CONVERGED, 1.0, max_iterations)

    monkeypatch.setattr(condensed_module, "contact_newton", slow)
    outcome = CondensedBlock(it).solve(x, tolerance=5e-4, max_iterations=20, kept=True)
    assert outcome.status is Status.NOT_CONVERGED
    assert outcome.iterations == 20
    assert asked == [8, 8, 4]


@pytest.mark.parametrize("status", [Status.SINGULAR, Status.INVERTED])
def test_a_near_part_that_fails_says_why(monkeypatch: pytest.MonkeyPatch, status: Status) -> None:
    it, x = pressed()
    monkeypatch.setattr(condensed_module, "contact_newton", lambda _part, x, **_: Outcome(x, status, 1.0, 3))
    assert CondensedBlock(it).solve(x, **OPTIONS).status is status


def test_the_force_is_that_of_newton_on_the_whole_block(monkeypatch: pytest.MonkeyPatch) -> None:
    poke = replace(scene(), solver=tisim.Solver(tolerance=1e-6, max_iterations=40))
    condensed = solve_poke(poke)
    monkeypatch.setattr(condensed_module, "REACH", -1.0)
    whole = solve_poke(poke)
    assert condensed.ok
    assert whole.ok
    size = np.linalg.norm(whole.rod_force, axis=1)
    assert (np.linalg.norm(condensed.rod_force - whole.rod_force, axis=1) < 2e-5 * size).all()


def test_a_way_that_turns_elements_over_is_taken_in_part(monkeypatch: pytest.MonkeyPatch) -> None:
    it, x = pressed(0.0001)
    block = CondensedBlock(it)
    far = x.copy()
    top = np.unique(it.discretisation.mesh.facet_sets["top"])
    while it.potential(far)[1] > 0.0:
        far = far.copy()
        far[top, 2] -= 1e-3
    found, part = block._sound(x, far)
    assert found is not None
    assert part in (0.5, 0.25, 0.125)
    assert it.potential(found)[1] > 0.0
    assert found == pytest.approx(x + part * (far - x))
    beyond = x.copy()
    beyond[top, 2] -= 1.0
    assert block._sound(x, beyond) == (None, 0.0)
    whole, part = block._sound(x, x)
    assert whole is x
    assert part == 1.0
    # a round that would invert elements continues from the last valid state, with a new far tangent
    monkeypatch.setattr(CondensedBlock, "_sound", lambda _self, x, _moved: (x, 0.5))
    stuck = block.solve(x, tolerance=5e-4, max_iterations=10, kept=True)
    assert stuck.status is Status.NOT_CONVERGED
    assert block.condensations >= block.rounds > 2
    monkeypatch.setattr(CondensedBlock, "_sound", lambda _self, _x, _moved: (None, 0.0))
    assert block.solve(x, **OPTIONS).status is Status.INVERTED


def test_nearly_incompressible_far_tissue_does_not_hold_steps_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """The factor contains all of the far tissue's stiffness: at most 1.5 times the whole block's iterations.

    With the blocks of neighbours alone, and a diagonal for the others, it took 113 instead of 18.
    """
    poke = replace(
        scene(0.0006),
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=9e6),
    )
    condensed = solve_poke(poke).cost.newton_iterations
    monkeypatch.setattr(condensed_module, "REACH", -1.0)
    assert condensed <= 1.5 * solve_poke(poke).cost.newton_iterations


def test_a_poke_that_fails_ends_after_so_many_iterations(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The result has the status, and no frame."""
    asked: list[float] = []

    def fails(block: CondensedBlock, x: Array, **_: Any) -> Outcome:
        asked.append(block._system.depth)
        return Outcome(x, Status.NOT_CONVERGED, 1.0, 80)  # twice Solver.max_iterations

    monkeypatch.setattr(CondensedBlock, "solve", fails)
    found = solve_poke(scene())
    assert len(asked) == 2  # static, then damped motion; without the limit smaller steps would follow
    assert found.status is Status.NOT_CONVERGED
    assert len(found.load) == 0
