"""Beams whose load follows a course: quasi-static equilibria step by step in time.

The first step is a static beam's, with the modulus that there is at once. Each later one starts from where
the last ones point to; where it fails it is halved, in time and in load, from the last accepted state.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tisim import laws
from tisim.course import Stop
from tisim.discretisation.body import Discretisation
from tisim.nonlinear.newton import CRUSHED, Outcome, newton
from tisim.parts import Spectrum
from tisim.problems._stops import shortest_time
from tisim.problems.beam.equilibrium import Neighbour, equilibrium, mixed_newton
from tisim.problems.beam.imperfect import MOST_ANGLES, Clamped, imperfect_equilibrium
from tisim.problems.beam.rest_shape import is_ideal
from tisim.problems.beam.system import BeamSystem, beam_system
from tisim.problems.beam.trail import LinearCreep, Trail, predict
from tisim.problems.beam.warped import Warped
from tisim.result import Status
from tisim.scene import Beam

Array = NDArray[np.float64]

SMALLEST_PART = 1.0 / 64.0  # of a step between two stops
BETWEEN = 300.0  # tolerance of steps between frames, in units of the frames'
LOOSEST = 1e-3  # tolerance of the first
# Iterations of a step with earlier tangents. One whose step is more than SLOW of the last is slow: after
# PATIENCE of them, or where a step is GROWN times the last, there is a new tangent, MOST_FACTORS times.
CHEAP, SLOW, PATIENCE, MOST_FACTORS, GROWN = 24, 0.5, 3, 3, 4.0
NEAR = 1e-4  # of the largest displacement: what a state between frames may be wrong by
ELASTIC = Spectrum(equilibrium=1.0, strengths=np.zeros(0), times=np.zeros(0))


@dataclass(frozen=True, eq=False)
class Frame:
    """A state that is kept: time [s], part of the load, positions, supports' force [N], energy lost [J]."""

    time: float
    value: float
    x: Array
    support: Array
    dissipated: float
    min_jacobian: float
    residual: float


@dataclass(eq=False)
class Path:
    """A beam on its course: where it is, and what was kept and done on the way.

    linear: the linear material under the same load. trail: the states so far; other: the neighbour's.
    warped: the discretisation's factor, where it is this beam's. clamps: where they are imperfect.
    """

    system: BeamSystem
    outcome: Outcome
    linear: LinearCreep
    trail: Trail
    time: float = 0.0
    value: float = 0.0
    other: Trail | None = None
    clamps: Clamped | None = None
    warped: Warped | None = None
    frames: list[Frame] = field(default_factory=list)
    steps: int = 0
    cuts: int = 0

    def keep(self) -> None:
        body = self.system.body
        fixed = body.discretisation.fixed
        force, min_jacobian = body.internal_forces(self.outcome.x)
        support = (force[fixed] - body.dead_load[fixed]).sum(axis=0) * body.discretisation.multiplicity
        for axis in body.discretisation.mesh.symmetry:
            support["xyz".index(axis)] = 0.0
        self.frames.append(
            Frame(
                self.time, self.value, self.outcome.x, support, body.dissipated(), min_jacobian,
                self.outcome.residual,
            )
        )  # fmt: skip


def follow(
    scene: Beam, discretisation: Discretisation, neighbour: Neighbour | None
) -> tuple[Path, Status, Neighbour | None]:
    """A beam along its course, how that ended, and what the next beam on its mesh may start from."""
    assert scene.course is not None
    stops = scene.course.stops(shortest_time(scene.material))
    path, found = _first(scene, discretisation, stops[0], neighbour)
    status = path.outcome.status
    if status is not Status.CONVERGED:
        return path, status, None
    path.system.step_limit = np.inf
    path.system.least_load = float(np.linalg.norm(path.system.full_load[discretisation.pattern.free]))
    path.linear.accept(0.0, path.linear.strain(0.0, path.value))
    path.trail.add(0.0, path.linear.strain(0.0, path.value), path.outcome.x)
    if neighbour is not None and neighbour.discretisation is discretisation:
        path.other = neighbour.trail
    for stop in stops[1:] if path.steps else stops:
        status = _advance(scene, path, stop)
        if status is not Status.CONVERGED:
            break
        if stop.frame:
            path.keep()
    if found is not None:
        found = replace(found, trail=path.trail, warped=path.warped)
    return path, status, found


def _first(
    scene: Beam, discretisation: Discretisation, stop: Stop, neighbour: Neighbour | None
) -> tuple[Path, Neighbour | None]:
    """The path to the first stop where that is the whole load at once, else at rest."""
    at_once = stop.time == 0.0 and stop.value == 1.0
    viscosity = scene.material.viscosity
    linear = LinearCreep(ELASTIC if viscosity is None else viscosity.spectrum())
    stiffness = laws.get(scene.material.law).moduli(scene.material.parameters).shear_modulus
    trail = Trail(scene, scene.material.density / stiffness)
    if not stop.frame:
        loose = scene.solver.tolerance * BETWEEN
        scene = replace(scene, solver=replace(scene.solver, tolerance=min(loose, LOOSEST)))
    if not is_ideal(scene):  # checked: the whole load at once
        found = imperfect_equilibrium(scene, discretisation, neighbour)
        system, outcome, counts, next_one = found.system, found.outcome, found.counts, found.neighbour
        clamps = found.clamps
    else:
        system, clamps = beam_system(scene, discretisation), None
        if not at_once:
            rest = Outcome(discretisation.mesh.nodes.copy(), Status.CONVERGED, 0.0, 0)
            return Path(system, rest, linear, trail), None
        if neighbour is not None and neighbour.discretisation is discretisation:
            beside = _beside(scene, system, linear, trail, neighbour, kept=stop.frame)
            if beside is not None:
                _begin(beside, stop)
                return beside, neighbour
        outcome, counts, next_one = equilibrium(scene, system, neighbour)
    steps, cuts = counts["steps"], counts["cuts"]
    path = Path(system, outcome, linear, trail, value=1.0, steps=steps, cuts=cuts, clamps=clamps)
    if outcome.status is Status.CONVERGED:
        if system.factored_at is not None:
            path.warped = Warped(system.body, system.factored_at)
        _begin(path, stop)
    return path, next_one


def _begin(path: Path, stop: Stop) -> None:
    path.system.body.accept(path.outcome.x)
    if stop.frame:
        path.keep()


def _beside(
    scene: Beam, system: BeamSystem, linear: LinearCreep, trail: Trail, neighbour: Neighbour, *, kept: bool
) -> Path | None:
    """The path with the whole load at once, from the neighbour's states and factor; None where these fail."""
    other = neighbour.trail
    if other is None or neighbour.warped is None or not other.leads(scene):
        return None
    x = other.at(0.0, trail.unit * linear.strain(0.0, 1.0))
    if x is None:
        return None
    start = Outcome(x, Status.CONVERGED, np.inf, 0)
    path = Path(system, start, linear, trail, value=1.0, steps=1, warped=neighbour.warped.of(system.body))
    near = 0.0 if kept else _near(path)
    outcome = _with_few_factors(path, x, scene.solver.tolerance, near)
    if outcome is None:
        return None
    path.outcome = outcome
    return path


def _advance(scene: Beam, path: Path, stop: Stop) -> Status:
    """On to a stop, in parts where it fails in one."""
    system, body = path.system, path.system.body
    begin, first = path.time, path.value
    reached, part = 0.0, 1.0
    while reached < 1.0:
        end = min(1.0, reached + part)
        time = stop.time if end == 1.0 else begin + end * (stop.time - begin)
        value = stop.value if end == 1.0 else first + end * (stop.value - first)
        body.begin(time - path.time)
        system.set_factor(value)
        tight = end == 1.0 and stop.frame
        tolerance = scene.solver.tolerance * (1.0 if tight else BETWEEN)
        strain = path.linear.strain(time - path.time, value)
        start = predict(path.trail, path.other, time, strain)
        trial = _clamped(scene, path, start, tolerance=tolerance)
        path.steps += 1
        if trial.status is Status.CONVERGED:
            body.accept(trial.x)
            path.linear.accept(time - path.time, strain)
            path.trail.add(time, strain, trial.x)
            path.outcome, path.time, path.value, reached = trial, time, value, end
            part *= 2.0
            continue
        part *= 0.5
        path.cuts += 1
        if part < SMALLEST_PART:
            body.begin(0.0)
            system.set_factor(path.value)
            return trial.status
    return Status.CONVERGED


def _clamped(scene: Beam, path: Path, start: Array, *, tolerance: float) -> Outcome:
    """Equilibrium with the clamps at the angles that their moments make, where they yield."""
    clamps = path.clamps
    if clamps is None or not clamps.yields:
        return _solve(scene, path, start, tolerance=tolerance)
    angles = clamps.angles
    outcome = _solve(scene, path, clamps.hold(start), tolerance=tolerance)
    for _ in range(MOST_ANGLES):
        if outcome.status is not Status.CONVERGED:
            break
        if not clamps.opens(outcome.x):
            return outcome
        start, _ = clamps.turned(outcome.x)
        outcome = _solve(scene, path, start, tolerance=tolerance)
    clamps.angles = angles
    if outcome.status is Status.CONVERGED:
        return replace(outcome, status=Status.NOT_CONVERGED)
    return outcome


def _near(path: Path) -> float:
    """Allowed error in position of a state between frames [m]."""
    return NEAR * float(np.abs(path.outcome.x - path.system.body.discretisation.mesh.nodes).max())


def _solve(scene: Beam, path: Path, start: Array, *, tolerance: float) -> Outcome:
    """Equilibrium from where other states point to: with few factors, by Newton, then on the potential."""
    system, x = path.system, path.outcome.x
    if path.clamps is not None:
        x = path.clamps.hold(x)
    options = scene.solver
    near = _near(path) if tolerance > options.tolerance else 0.0
    if path.warped is not None:
        outcome = _with_few_factors(path, start, tolerance, near)
        if outcome is not None:
            return outcome
    relaxed = replace(scene, solver=replace(options, tolerance=tolerance))
    path.warped = None
    for guess in (start, x):
        if system.potential(guess)[1] > 0.0:
            outcome = mixed_newton(relaxed, system, guess, system.body.pressures(guess))
            if outcome.status is Status.CONVERGED:
                if system.factored_at is not None:
                    path.warped = Warped(system.body, system.factored_at)
                return outcome
    return newton(system, x, tolerance=tolerance, max_iterations=options.max_iterations)


def _with_few_factors(path: Path, x: Array, tolerance: float, near: float) -> Outcome | None:
    """Newton's method with an earlier tangent and Anderson's mixing (J. ACM 12, 1965).

    The tangent is renewed where that is slow.

    near: a step in which no node moves further than this is the last [m]: the residual of a state that is not
    kept is mostly pressure, and the history only knows isochoric stresses. None where it does not get there
    with MOST_FACTORS new tangents.
    """
    system = path.system
    body, discretisation = system.body, system.body.discretisation
    free, held = discretisation.pattern.free, discretisation.held
    load = max(system.load_norm(), system.least_load)
    seen: list[tuple[Array, Array]] = []  # positions of free nodes, and the step from there
    renewed, slow, before = 0, 0, np.inf
    assert path.warped is not None
    path.warped.turn(x)
    for iteration in range(CHEAP):
        force, min_jacobian = body.internal_forces(x)
        residual = (force - body.dead_load)[free]
        residual[held] = 0.0
        relative = float(np.linalg.norm(residual)) / load
        if not min_jacobian > CRUSHED or not np.isfinite(relative):
            return None
        if relative <= tolerance:
            return Outcome(x, Status.CONVERGED, relative, iteration)
        here, step = x[free], path.warped.solve(-residual)
        size = float(np.abs(step).max())
        slow = slow + 1 if size > SLOW * before else 0
        if slow >= PATIENCE or (seen and size > GROWN * before):
            if renewed == MOST_FACTORS:
                return None
            system.free_pressures(body.pressures(path.outcome.x))  # of a trial they may be wild
            try:
                step = system.step(system.linearise(x)[0], forcing=0.0)
            finally:
                system.free_pressures(None)
            path.warped = Warped(body, x)
            renewed, slow, size = renewed + 1, 0, float(np.abs(step).max())
            seen.clear()
        before = size
        moved = here + step
        if seen:
            turns = np.column_stack([(step - s).ravel() for _, s in seen])
            parts = np.linalg.lstsq(turns.T @ turns, turns.T @ step.ravel())[0]
            for part, (place, s) in zip(parts, seen, strict=True):
                moved -= part * (here - place + step - s)
        seen.append((here, step))
        x = x.copy()
        x[free] = moved
        if near and float(np.abs(moved - here).max()) <= near:
            return Outcome(x, Status.CONVERGED, relative, iteration)
    return None
