"""Indentation of a block by a rod, and its retraction: one equilibrium with frictional contact per step."""

from __future__ import annotations

import logging
import time

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import Discretisation
from tisim.mesh import Mesh
from tisim.mesh.indentation import poke_mesh
from tisim.nonlinear.newton import Outcome
from tisim.parallel.threads import one_thread
from tisim.problems._registry import OnStep, skip
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.course import follow, without_course
from tisim.problems.indentation.damped import LONGEST, solve_step
from tisim.problems.indentation.kind import ELEMENT, SAME
from tisim.problems.indentation.rod import tissue_left
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
    starts_deep,
)
from tisim.problems.indentation.system import PokeSystem
from tisim.problems.indentation.turning import axis_at
from tisim.result import Cost, Result, Status
from tisim.scene import Poke

Array = NDArray[np.float64]
_log = logging.getLogger(__name__)

# A frame has a smaller tolerance than the steps between frames. If its equilibrium is not found, the frame is
# tried again further on, by this fraction of the frame spacing.
LATER = 0.1


@one_thread()
def solve_poke(scene: Poke, *, on_step: OnStep = skip) -> Result:
    """Push the rod to the scene's depth and retract it if `retract_to` is given, or follow the course.

    There is one frame per frame spacing, or the frames of the course.

    Parameters
    ----------
    scene : Poke
    on_step : callable (fraction), optional
        Called with the completed fraction of the rod's path after each accepted step, or with that of the
        course's stops after each stop.

    Returns
    -------
    Result
        Frames up to the end of the solution. Without a course, each step tried is logged at DEBUG.
    """
    mesh_start = time.process_time()
    mesh = scene.mesh or poke_mesh(
        block=scene.block, site=scene.site, direction=scene.direction, rod=scene.rod, friction=scene.friction,
        refinement=scene.refinement, kind=ELEMENT if scene.element == "default" else scene.element,
    )  # fmt: skip
    discretisation = Discretisation.build(mesh, mesh.node_sets["base"])
    mesh_seconds = time.process_time() - mesh_start
    start = time.process_time()
    system = PokeSystem(without_course(scene), discretisation)
    block = CondensedBlock(system)
    walk = _push if scene.course is None else follow
    frames, status, steps, cuts = walk(scene, system, block, on_step)
    cost = Cost(
        core_seconds=time.process_time() - start,
        mesh_seconds=mesh_seconds,
        steps=steps,
        newton_iterations=block.iterations,
        factorisations=block.factorisations,
        linear_iterations=block.linear_iterations,
        step_cuts=cuts,
    )
    return _result(scene, mesh, frames, status, cost)


def _push(
    scene: Poke, system: PokeSystem, block: CondensedBlock, on_step: OnStep
) -> tuple[list[Frame], Status, int, int]:
    x = system.previous.copy()
    velocity = np.zeros_like(x)
    in_vain = 0
    depth = 0.0
    frames: list[Frame] = []
    travelled = 0.0
    way_to_go = scene.depth if scene.retract_to is None else 2.0 * scene.depth - scene.retract_to
    steps = cuts = 0
    status = Status.CONVERGED
    for goal in (scene.depth,) if scene.retract_to is None else (scene.depth, scene.retract_to):
        way = 1.0 if goal > depth else -1.0
        system.turn(way)
        step, next_frame = FIRST_STEP, depth + way * scene.frame_spacing
        while way * (goal - depth) > SAME:
            wanted = way * min(way * next_frame, way * goal)
            target = way * min(way * depth + step, way * wanted)
            if SAME < way * (wanted - target) < 0.2 * step:
                target = 0.5 * (depth + wanted)
            system.move_to(target)
            guess = predict(system, x, velocity * (target - depth))
            if abs(target - depth) > LONGEST and starts_deep(guess, system):
                step = CUT * min(step, abs(target - depth))
                continue
            frame = way * (target - wanted) >= -SAME
            tolerance = (1.0 if frame else BETWEEN) * scene.solver.tolerance
            put_off = frame and way * (goal - target) > SAME  # the last frame has no later one
            length = abs(target - depth)
            outcome, failed = solve_step(
                system, block, guess, tolerance=tolerance, kept=frame, length=length,
                between=BETWEEN * scene.solver.tolerance if put_off else 0.0,
            )  # fmt: skip
            steps += 1
            if _log.isEnabledFor(logging.DEBUG):
                _log.debug(
                    "%7.3f mm, step %.3f mm: %s", target * 1e3, step * 1e3, _state(outcome, system, block)
                )
            later = way * min(way * target + LATER * scene.frame_spacing, way * goal)
            if failed is not None:
                status = failed
                cuts += 1
                in_vain += outcome.iterations
                step = CUT * min(step, length)
                if in_vain >= IN_VAIN * scene.solver.max_iterations or step < SMALLEST_STEP:
                    return frames, status, steps, cuts
                if put_off and length <= LONGEST:
                    next_frame = later
                continue
            if outcome.status is not Status.CONVERGED:
                frame, next_frame = False, later
            velocity = (outcome.x - x) / (target - depth)
            travelled += abs(target - depth)
            x, depth = outcome.x, target
            on_step(travelled / way_to_go)
            system.accept(x)
            step = next_step(step, outcome.iterations)
            if frame:
                in_vain = 0
                frames.append(frame_of(outcome.x, system, outcome.residual))
                next_frame = depth + way * scene.frame_spacing
    return frames, Status.CONVERGED, steps, cuts


def _state(outcome: Outcome, system: PokeSystem, block: CondensedBlock) -> str:
    return (
        f"it {outcome.iterations:2d} {outcome.status.value:14s}"
        f" F {system.report[:3] @ -system.axis:8.4f} overlap {-1e3 * float(system.report[3]):.3f}"
        f" J {system.min_jacobian:.3f} res {outcome.residual:.1e} solves {block.linear_iterations}"
        f" fac {block.factorisations} rounds {block.rounds} far {block.condensations}"
    )


def _result(scene: Poke, mesh: Mesh, frames: list[Frame], status: Status, cost: Cost) -> Result:
    def stack(values: list[Array], width: tuple[int, ...]) -> Array:
        return np.array(values) if values else np.zeros((0, *width))

    reached = "0 mm"
    if frames:  # indicates the cause of the end: tissue crushed against an inclusion, or a folding surface
        last = frames[-1]
        size = float(np.linalg.norm(last.rod_force))
        reached = f"{last.depth * 1e3:.2f} mm, {size:.3g} N and smallest det F {last.min_jacobian:.3f}"
        if scene.mesh is None:
            axis = axis_at(scene, last.time)
            left, where = tissue_left(scene, last.tip, axis)
            reached += f"; {left * 1e3:.1f} mm of tissue left between the rod and the {where}"
            if scene.course is None:
                whole = tissue_left(scene, last.tip - last.depth * axis, axis)[0]
                reached += f" ({whole * 1e3:.1f} at first touch)"
    return Result(
        scene=scene,
        status=status,
        message="" if status is Status.CONVERGED else f"{status.value} after {reached}",
        mesh=mesh,
        load=np.array([f.depth for f in frames]),
        positions=stack([f.x for f in frames], (mesh.n_nodes, 3)),
        support_force=stack([f.base_force for f in frames], (3,)),
        rod_force=stack([f.rod_force for f in frames], (3,)),
        rod_tip=stack([f.tip for f in frames], (3,)),
        penetration=np.array([f.penetration for f in frames]),
        min_jacobian=np.array([f.min_jacobian for f in frames]),
        residual=np.array([f.residual for f in frames]),
        time=None if scene.course is None else np.array([f.time for f in frames]),
        dissipated=np.array([f.dissipated for f in frames]) if scene.material.remembers else None,
        cost=cost,
    )
