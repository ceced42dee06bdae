"""Beams whose load follows a course: quasi-static equilibria step by step in time.

The first step is that of a static beam with the instantaneous modulus. Each later step starts from an
extrapolation of the last ones; if it fails it is halved, in time and in load, from the last accepted state.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tisim import laws
from tisim.course import Stop
from tisim.discretisation.body import Discretisation
from tisim.linear.direct import LinearSolveError
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
BETWEEN = 300.0  # tolerance of steps between frames, in units of the frames' tolerance
LOOSEST = 1e-3  # largest tolerance of the first step
# A step with earlier tangents takes up to CHEAP iterations. An iteration is slow if its step is more than
# SLOW times the last. The tangent is renewed after PATIENCE slow iterations in a row, or if a step is more
# than GROWN times the last, at most MOST_FACTORS times.
CHEAP, SLOW, PATIENCE, MOST_FACTORS, GROWN = 24, 0.5, 3, 3, 4.0
# Allowed error of a state between frames, relative to the largest displacement; a tighter tolerance than
# USUAL lowers it.
NEAR, USUAL = 1e-4, 1e-6
ELASTIC = Spectrum(equilibrium=1.0, strengths=np.zeros(0), times=np.zeros(0))


@dataclass(frozen=True, eq=False)
class Frame:
    """A state that is kept in the result.

    Attributes
    ----------
    time : time [s].
    value : fraction of the load.
    x : positions [m], shape (n, 3).
    support : force of the supports on the body [N], shape (3,).
    dissipated : energy dissipated so far [J].
    min_jacobian : smallest det F.
    residual : residual relative to the load.
    """

    time: float
    value: float
    x: Array
    support: Array
    dissipated: float
    min_jacobian: float
    residual: float


@dataclass(eq=False)
class Path:
    """State of a beam on its course, with the frames and the counts of steps so far.

    Attributes
    ----------
    system : the beam under the present load.
    outcome : the last accepted equilibrium.
    linear : strain of the linear material under the same load.
    trail : accepted states of this beam.
    time, value : time [s] and fraction of the load of the last accepted state.
    other : accepted states of the neighbour, None without one.
    clamps : clamps of an imperfect beam, None for an ideal one.
    warped : the discretisation's factor; None if that is not a factor of this beam's tangent.
    frames : states kept.
    steps, cuts : numbers of steps tried and of steps that failed.
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
        force, min_jacobian = body.internal_forces(self.outcome.x)
        support = body.discretisation.support_force(force - body.dead_load)
        self.frames.append(
            Frame(
                self.time, self.value, self.outcome.x, support, body.dissipated(), min_jacobian,
                self.outcome.residual,
            )
        )  # fmt: skip


def follow(
    scene: Beam, discretisation: Discretisation, neighbour: Neighbour | None
) -> tuple[Path, Status, Neighbour | None]:
    """Solve a beam along its course; return the path, its status and start values for the next beam."""
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
    """Path at the first stop if that is the whole load at time 0, else at rest; next beam's start values.

    An imperfect beam is always solved at the whole load: `beam.kind` refuses other courses for it.
    """
    at_once = stop.time == 0.0 and stop.value == 1.0
    viscosity = scene.material.viscosity
    linear = LinearCreep(ELASTIC if viscosity is None else viscosity.spectrum())
    stiffness = laws.get(scene.material.law).moduli(scene.material.parameters).shear_modulus
    trail = Trail(scene, scene.material.density / stiffness)
    tolerance = scene.solver.tolerance
    if not stop.frame:
        loose = scene.solver.tolerance * BETWEEN
        scene = replace(scene, solver=replace(scene.solver, tolerance=min(loose, LOOSEST)))
    if not is_ideal(scene):  # its course begins with the whole load (checked in beam.kind)
        found = imperfect_equilibrium(scene, discretisation, neighbour)
        system, outcome, counts, next_one = found.system, found.outcome, found.counts, found.neighbour
        clamps = found.clamps
    else:
        system, clamps = beam_system(scene, discretisation), None
        if not at_once:
            rest = Outcome(discretisation.mesh.nodes.copy(), Status.CONVERGED, 0.0, 0)
            system.tolerance = tolerance
            return Path(system, rest, linear, trail), None
        if neighbour is not None and neighbour.discretisation is discretisation:
            beside = _beside(scene, system, linear, trail, neighbour, kept=stop.frame)
            if beside is not None:
                system.tolerance = tolerance
                _begin(beside, stop)
                return beside, neighbour
        outcome, counts, next_one = equilibrium(scene, system, neighbour)
    system.tolerance = tolerance  # later frames are not loose
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
    """Path at the whole load, solved from the neighbour's states and factor; None if that fails."""
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
    """Advance to a stop, in smaller steps if one step fails."""
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
    """Equilibrium from `start`; compliant clamps are turned to the angles that their moments cause."""
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
    """Allowed position error of a state between frames [m]."""
    part = NEAR * min(1.0, path.system.tolerance / USUAL)
    return part * float(np.abs(path.outcome.x - path.system.body.discretisation.mesh.nodes).max())


def _solve(scene: Beam, path: Path, start: Array, *, tolerance: float) -> Outcome:
    """Equilibrium from a predicted `start`: with few factors, else by mixed Newton, else on the potential."""
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
    """Newton's method with an earlier tangent and Anderson mixing (J. ACM 12, 1965).

    The tangent is renewed if convergence is slow.

    Parameters
    ----------
    path : Path
        `path.warped` must be set; it is replaced if the tangent is renewed.
    x : ndarray of float, shape (n, 3)
        Start positions [m].
    tolerance : float
        Residual relative to the load at which to stop.
    near : float
        If above 0, stop also after a step in which no component of a displacement exceeds this [m]. It is for
        states that are not kept: their residual is mostly pressure, and the history stores only isochoric
        stresses.

    Returns
    -------
    Outcome or None
        None if it does not converge in CHEAP iterations and MOST_FACTORS new tangents, an element inverts or
        a tangent cannot be factorised.
    """
    system = path.system
    body, free = system.body, system.body.discretisation.pattern.free
    seen: list[tuple[Array, Array]] = []  # positions of free nodes, and the step from there
    renewed, slow, before = 0, 0, np.inf
    assert path.warped is not None
    path.warped.turn(x)
    for iteration in range(CHEAP):
        force, min_jacobian = body.internal_forces(x)
        residual = body.out_of_balance(force)
        load = system.load_scale(force)
        relative = float(np.linalg.norm(residual)) / load if load > 0.0 else np.nan
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
            system.free_pressures(body.pressures(path.outcome.x))  # those of a trial may be far too large
            try:
                step = system.step(system.linearise(x)[0], forcing=0.0)
            except LinearSolveError:
                return None
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
