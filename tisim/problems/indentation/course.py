"""Indentation in which the rod's depth and direction follow a course: one equilibrium per time step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tisim.course import Stop
from tisim.problems._registry import OnStep
from tisim.problems._stops import shortest_time
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.damped import solve_step
from tisim.problems.indentation.steps import (
    BETWEEN,
    CUT,
    FIRST_STEP,
    IN_VAIN,
    SMALLEST_STEP,
    Frame,
    frame_of,
    next_step,
    predict,
)
from tisim.problems.indentation.system import PokeSystem
from tisim.problems.indentation.turning import angle, axis_at
from tisim.result import Status
from tisim.scene import Poke

Array = NDArray[np.float64]

SMALLEST_PART = 1.0 / 64.0  # smallest fraction of a step in a hold


def without_course(scene: Poke) -> Poke:
    """The scene without its course, with the course's largest depth: used by mesh, contact and checks."""
    if scene.course is None:
        return scene
    return replace(scene, depth=float(max(scene.course.values)), course=None)


@dataclass(eq=False)
class _Walk:
    """State of the solution along the course.

    Attributes
    ----------
    x : positions of the body [m], shape (n, 3).
    depth, time : depth of the rod [m] and time [s].
    step : next step in depth [m].
    velocity : last change of x per unit of the step's variable, shape (n, 3): depth, or log time in a hold
        (`_pace`); time if the rod turns. None after a corner.
    steps, cuts : numbers of steps tried and of steps refused.
    """

    x: Array
    depth: float = 0.0
    time: float = 0.0
    step: float = FIRST_STEP
    velocity: Array | None = None
    steps: int = 0
    cuts: int = 0


def follow(
    scene: Poke, system: PokeSystem, block: CondensedBlock, on_step: OnStep
) -> tuple[list[Frame], Status, int, int]:
    """Solve a poke along its course; return its frames, status, and numbers of steps and of cuts."""
    course = scene.course
    assert course is not None
    shortest = shortest_time(scene.material)
    offset = 0.5 * (shortest or course.duration)
    walk = _Walk(system.previous.copy())
    frames: list[Frame] = []
    corner = 0.0
    stops = course.stops(shortest)
    for count, stop in enumerate(stops, start=1):
        if walk.time in (0.0, *course.times):
            corner, walk.velocity, walk.step = walk.time, None, FIRST_STEP
        way = np.sign(stop.value - walk.depth)
        if way:
            system.turn(float(way))
        elif scene.turns:  # a rotation releases elements on one side
            system.turn(-1.0)
        status = _advance(scene, system, block, walk, stop, corner - offset)
        if status is not Status.CONVERGED:
            return frames, status, walk.steps, walk.cuts
        if stop.frame:
            frames.append(frame_of(walk.x, system, block.last_residual, walk.time))
        on_step(count / len(stops))
    return frames, Status.CONVERGED, walk.steps, walk.cuts


def _advance(
    scene: Poke, system: PokeSystem, block: CondensedBlock, walk: _Walk, stop: Stop, origin: float
) -> Status:
    """Advance to a stop, in depth steps as those of a poke, and in fractions of the time if a hold fails."""
    part, in_vain = 1.0, 0
    while walk.time < stop.time or walk.depth != stop.value:
        left = stop.value - walk.depth
        way = abs(left)
        if scene.turns:
            turn = angle(system.previous_axis, axis_at(scene, stop.time))
            way = max(way, turn * max(walk.depth, stop.value, scene.rod.radius))
        share = min(part, 1.0)
        if way:
            share = min(share, walk.step / way)
            if share > 0.7:  # leave no small remainder
                share = 1.0 if part >= 1.0 and way <= 1.25 * walk.step else 0.5
        done = share == 1.0
        target = stop.value if done else walk.depth + share * left
        time = stop.time if done else walk.time + share * (stop.time - walk.time)
        system.move_to(target, axis_at(scene, time) if scene.turns else None)
        system.begin(time - walk.time)
        pace = time - walk.time if scene.turns else _pace(walk, target, time, origin)
        guess = walk.x.copy() if walk.velocity is None else predict(system, walk.x, walk.velocity * pace)
        kept = done and stop.frame
        tolerance = (1.0 if kept else BETWEEN) * scene.solver.tolerance
        outcome, failed = solve_step(system, block, guess, tolerance=tolerance, kept=kept, length=share * way)
        walk.steps += 1
        if failed is not None:
            walk.cuts += 1
            in_vain += outcome.iterations
            if way:
                walk.step = CUT * min(walk.step, share * way)
            else:
                part = 0.5 * share
            spent = in_vain >= IN_VAIN * scene.solver.max_iterations
            if spent or walk.step < SMALLEST_STEP or part < SMALLEST_PART:
                system.begin(0.0)
                return failed
            continue
        walk.velocity = (outcome.x - walk.x) / pace if pace else None
        if way:
            walk.step = next_step(walk.step, outcome.iterations)
        part = 1.0
        walk.x, walk.depth, walk.time = outcome.x, target, time
        block.last_residual = outcome.residual
        system.accept(outcome.x)
    return Status.CONVERGED


def _pace(walk: _Walk, depth: float, time: float, origin: float) -> float:
    """Length of a step in depth [m]; in a hold, in the logarithm of the time since `origin`."""
    if depth != walk.depth:
        return depth - walk.depth
    return float(np.log((time - origin) / (walk.time - origin))) if time > walk.time else 0.0
