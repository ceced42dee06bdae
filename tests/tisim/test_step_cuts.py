"""A rejected step leaves no trace, in each type of scene with a history-dependent material."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tisim
from tisim.discretisation.body import DiscretisedBody
from tisim.linear.direct import LinearSolveError
from tisim.problems.beam import course as beam_course
from tisim.problems.beam.system import BeamSystem
from tisim.problems.compression import solve as press_solve
from tisim.problems.dynamics import implicit
from tisim.problems.homogeneous import solve as coupon_solve
from tisim.problems.indentation import course as poke_course
from tisim.result import Status

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=3e4, bulk_modulus=6e5)
VISCOUS = replace(SOFT, viscosity=tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0)))
BOTH = replace(VISCOUS, softening=tisim.OgdenRoxburgh(r=1.6, m=1e3, beta=0.1))
SMALL = {"axial_element_size": 0.01, "radial_elements": 1}
PULL = tisim.Course(start=1.0, frames=(1.0, 3.0)).ramp(to=1.2, duration=1.0).hold(2.0)
PUSH = tisim.Course(start=1.0, frames=(1.0, 3.0)).ramp(to=0.9, duration=1.0).hold(2.0)

# scene, module and name of the step solver, calls of it to reject, duration [s], tolerance on displacements
CASES: dict[str, tuple[tisim.Scene, Any, str, set[int], float, float]] = {
    "coupon": (tisim.Coupon(material=BOTH, course=PULL), coupon_solve, "newton", {2, 4, 5, 14}, 3.0, 1e-3),
    "press": (
        tisim.Press(material=BOTH, radius=0.01, height=0.012, refinement=0.5, course=PUSH),
        press_solve, "newton", {2, 3, 5, 6, 7, 8, 22}, 3.0, 1e-3,
    ),
    "beam": (
        tisim.Beam(
            material=VISCOUS, length=0.05,
            course=tisim.Course(frames=(2.0,), growth=0.25).jump(1.0).hold(2.0), **SMALL,  # type: ignore[arg-type]
        ),
        beam_course, "_solve", {1, 3, 4, 9}, 2.0, 2e-3,
    ),
    "released beam": (
        tisim.Beam(
            material=VISCOUS, length=0.05,
            solver=tisim.Solver(method="implicit", duration=0.02, time_step=1e-3), **SMALL,  # type: ignore[arg-type]
        ),
        implicit, "newton", {1, 5, 6}, 0.02, 0.02,
    ),
    "poke": (
        tisim.Poke(
            material=VISCOUS, refinement=0.5,
            course=tisim.Course(frames=(0.5, 1.5)).ramp(to=1e-3, speed=2e-3).hold(1.0),
        ),
        poke_course, "solve_step", {1, 4, 7}, 1.5, 2e-3,
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", CASES)
def test_a_refused_step_leaves_nothing_behind(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The history equals, bit for bit, that of the accepted steps alone; these cover the whole duration."""
    scene, owner, name, refused, duration, change = CASES[kind]
    straight = tisim.simulate(scene)
    accepted: list[tuple[float, np.ndarray]] = []
    bodies: list[DiscretisedBody] = []
    solve, accept = getattr(owner, name), DiscretisedBody.accept
    calls = 0

    def refuse_some(*arguments: Any, **options: Any) -> Any:
        nonlocal calls
        calls += 1
        outcome = solve(*arguments, **options)
        if calls not in refused:
            return outcome
        if isinstance(outcome, tuple):  # of a poke: outcome and reason
            return replace(outcome[0], status=Status.NOT_CONVERGED), Status.NOT_CONVERGED
        return replace(outcome, status=Status.NOT_CONVERGED)

    def note(body: DiscretisedBody, x: np.ndarray) -> None:
        assert body.history is not None
        bodies.append(body)
        accepted.append((body.history._dt, x.copy()))
        accept(body, x)

    monkeypatch.setattr(owner, name, refuse_some)
    monkeypatch.setattr(DiscretisedBody, "accept", note)
    cut = tisim.simulate(scene)
    assert cut.ok, cut.message
    assert cut.cost.step_cuts >= 2
    assert sum(dt for dt, _ in accepted) == pytest.approx(duration, rel=1e-12)
    body = bodies[-1]
    assert all(other is body for other in bodies)
    fresh = DiscretisedBody(body.discretisation, scene.material)
    for dt, x in accepted:
        fresh.begin(dt)
        accept(fresh, x)
    assert body.history is not None
    assert fresh.history is not None
    assert np.array_equal(body.state, fresh.state)
    for what in (_viscous, _stored, _dissipated):
        assert np.array_equal(what(body), what(fresh))
    # different steps, the same course
    moved, kept = cut.positions - cut.mesh.nodes, straight.positions - straight.mesh.nodes
    assert np.abs(moved - kept).max() < change * np.abs(kept).max()


def _viscous(body: DiscretisedBody) -> np.ndarray:
    return body.history.viscous()  # type: ignore[union-attr]


def _stored(body: DiscretisedBody) -> np.ndarray:
    return body.history.stored()  # type: ignore[union-attr]


def _dissipated(body: DiscretisedBody) -> np.ndarray:
    return body.history.dissipated  # type: ignore[union-attr]


def test_a_tangent_that_cannot_be_factorised_is_no_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """The step with few factors then gives way to Newton's method, with the same result."""
    scene = CASES["beam"][0]
    wanted = tisim.simulate(scene)
    monkeypatch.setattr(beam_course, "PATIENCE", 0)  # each step asks for a new tangent
    inner, failed = BeamSystem.step, []

    def step(self: BeamSystem, gradient: Any, *, forcing: float) -> Any:
        if forcing == 0.0:
            failed.append(True)
            raise LinearSolveError("singular")
        return inner(self, gradient, forcing=forcing)

    monkeypatch.setattr(BeamSystem, "step", step)
    found = tisim.simulate(scene)
    assert failed
    assert found.ok
    assert found.positions[-1] == pytest.approx(wanted.positions[-1], abs=1e-6)
