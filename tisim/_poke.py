"""A rod pushed into a block, and drawn back, each step an equilibrium with frictional contact."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim._body import Layout
from tisim._newton import Outcome
from tisim._poke_condensed import CondensedBlock
from tisim._poke_system import PokeSystem
from tisim.mesh import Mesh
from tisim.mesh.poke_block import poke_mesh
from tisim.result import Cost, Result, Status
from tisim.scene import Poke

Array = NDArray[np.float64]

# Penetration, as a part of the edge radius, at which the contact is made stiffer, and a step refused.
STIFFEN_AT, REFUSE_AT = 0.25, 0.5
FIRST_STEP, LARGEST_STEP, SMALLEST_STEP = 0.1e-3, 0.5e-3, 0.02e-3
# Tolerance of steps between frames, which are there to follow the path, in units of the frames'.
BETWEEN = 6.0
# A frame that finds no equilibrium, which is asked more of than the steps between, is tried again so much of
# the spacing further on.
LATER = 0.1
SAME = 1e-9  # depths closer than this are one [m]


@dataclass(frozen=True, eq=False)
class Frame:
    """One equilibrium: depth [m], positions, forces on rod and base [N], and how good it is."""

    depth: float
    x: Array
    rod_force: Array
    base_force: Array
    tip: Array
    penetration: float
    min_jacobian: float
    residual: float


def solve_poke(scene: Poke, *, trace: Callable[[str], None] | None = None) -> Result:
    """Push the rod in until the depth asked for, then draw it back where that is asked for, or until the
    solution ends; frames at every spacing.

    trace: called with one line of text for each step tried.
    """
    mesh_start = time.process_time()
    mesh = scene.mesh or poke_mesh(
        block=scene.block, site=scene.site, direction=scene.direction, rod=scene.rod,
        refinement=scene.refinement,
    )  # fmt: skip
    layout = Layout.build(mesh, mesh.node_sets["base"])
    mesh_seconds = time.process_time() - mesh_start
    start = time.process_time()
    system = PokeSystem(scene, layout)
    block = CondensedBlock(system)
    frames, status, steps, cuts = _push(scene, system, block, trace=trace)
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
    scene: Poke, system: PokeSystem, block: CondensedBlock, *, trace: Callable[[str], None] | None
) -> tuple[list[Frame], Status, int, int]:
    x = system.previous.copy()
    velocity = np.zeros_like(x)
    refused = 0
    depth = 0.0
    frames: list[Frame] = []
    steps = cuts = 0
    status = Status.CONVERGED
    for goal in (scene.depth,) if scene.back is None else (scene.depth, scene.back):
        way = 1.0 if goal > depth else -1.0
        system.turn(way)
        step, next_frame = FIRST_STEP, depth + way * scene.frame_spacing
        while way * (goal - depth) > SAME:
            wanted = way * min(way * next_frame, way * goal)
            target = way * min(way * depth + step, way * wanted)
            if SAME < way * (wanted - target) < 0.2 * step:
                target = 0.5 * (depth + wanted)
            system.move_to(target)
            guess = _predict(system, x, velocity * (target - depth))
            system.touch(guess)
            frame = way * (target - wanted) >= -SAME
            outcome = block.solve(
                guess,
                tolerance=(1.0 if frame else BETWEEN) * scene.solver.tolerance,
                # what stops most steps is a snap, which no smaller step goes round: it takes iterations
                max_iterations=scene.solver.max_iterations * (1 + refused),
                kept=frame,
            )
            steps += 1
            overlap = -float(system.report[3])
            failed: Status | None = None if outcome.status is Status.CONVERGED else outcome.status
            if failed is None and overlap > REFUSE_AT * system.edge:
                failed = Status.PENETRATION
            if trace is not None:
                trace(f"{target * 1e3:7.3f} step {step * 1e3:.3f} {_said(outcome, system, block)}")
            if failed is not None:
                status = failed
                cuts += 1
                refused += 1
                if frame and way * (goal - target) > SAME:
                    next_frame = way * min(way * target + LATER * scene.frame_spacing, way * goal)
                    if refused == 1:
                        continue
                step *= 0.4
                if step < SMALLEST_STEP:
                    return frames, status, steps, cuts
                continue
            refused = 0
            velocity = (outcome.x - x) / (target - depth)
            x, depth = outcome.x, target
            system.accept(x)
            if overlap > STIFFEN_AT * system.edge:
                system.stiffen()
            if outcome.iterations <= 6:
                step = min(step * 2.0, LARGEST_STEP)
            elif outcome.iterations > 12:
                step *= 0.7
            if frame:
                frames.append(_frame(outcome, system))
                next_frame = depth + way * scene.frame_spacing
    return frames, Status.CONVERGED, steps, cuts


def _frame(outcome: Outcome, system: PokeSystem) -> Frame:
    """Of an accepted equilibrium."""
    return Frame(
        depth=system.depth,
        x=outcome.x,
        rod_force=system.report[:3].copy(),
        base_force=system.base_force(),
        tip=system.tip,
        penetration=max(-float(system.report[3]), 0.0),
        min_jacobian=system.min_jacobian,
        residual=outcome.residual,
    )


def _said(outcome: Outcome, system: PokeSystem, block: CondensedBlock) -> str:
    return (
        f"it {outcome.iterations:2d} {outcome.status.value:14s}"
        f" F {system.report[:3] @ -system.axis:8.4f} overlap {-1e3 * float(system.report[3]):.3f}"
        f" J {system.min_jacobian:.3f} res {outcome.residual:.1e} solves {block.linear_iterations}"
        f" fac {block.factorisations} rounds {block.rounds} far {block.condensations}"
    )


def _predict(system: PokeSystem, x: Array, move: Array) -> Array:
    """x carried on along the last motion, as far as that lowers the energy and turns no element over.

    The last motion may have been a snap, which is not to be carried on.
    """
    least = max(0.02, 0.5 * system.min_jacobian)
    best, lowest, part = x.copy(), np.inf, 1.0
    for _ in range(4):
        trial = x + part * move
        energy, min_jacobian = system.potential(trial)
        if min_jacobian > least:
            if energy >= lowest:
                break
            best, lowest = trial, energy
        part *= 0.5
    return best


def _result(scene: Poke, mesh: Mesh, frames: list[Frame], status: Status, cost: Cost) -> Result:
    def stack(values: list[Array], width: tuple[int, ...]) -> Array:
        return np.array(values) if values else np.zeros((0, *width))

    reached = "0 mm"
    if frames:  # what stops a poke shows there: tissue crushed against an inclusion, or a surface that folds
        last = frames[-1]
        size = float(np.linalg.norm(last.rod_force))
        reached = f"{last.depth * 1e3:.2f} mm, {size:.3g} N and smallest det F {last.min_jacobian:.3f}"
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
        nominal_stress=np.zeros(len(frames)),
        cost=cost,
    )
