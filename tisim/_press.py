"""A cylinder between two platens, stretch after stretch, by an eighth of it."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim._press_system import PressSystem, SideLandedError, State
from tisim.mesh import Mesh
from tisim.result import Cost, Result, Status
from tisim.scene import Press

Array = NDArray[np.float64]

# Of the logarithm of the stretch: half of it changes the force by 0.03 % at most, to a third of the height.
LARGEST_STEP = 0.03
SMALLEST_STEP = LARGEST_STEP / 64.0


def solve_press(scene: Press) -> Result:
    """One frame a stretch; the frames up to the first that has no equilibrium are kept.

    The middle plane stays at z = 0, the upper platen at stretch * height / 2. nominal_stress: force of the
    platen on the body over the rest area, negative in compression; what the side carries where it lies on
    the platen counts. support_force: of the lower platen. penetration: of the side and the platen.
    """
    start = time.process_time()
    system = PressSystem(scene)
    mesh_seconds = time.process_time() - start
    here, before = system.rest(), None
    frames: list[_Frame] = []
    status, message, counts = Status.CONVERGED, "", _Counts()
    try:
        for stretch in scene.stretches:
            here, before, status = _advance(system, here, before, float(stretch), counts)
            if status is not Status.CONVERGED:
                message = f"no equilibrium beyond stretch {here.stretch:.4g} ({status.value})"
                break
            frames.append(_frame(system, here))
    except SideLandedError:
        status = Status.PENETRATION
        message = f"the side comes down on the platen beyond stretch {counts.reached:.4g}, and side is 'stop'"
    cost = Cost(
        core_seconds=time.process_time() - start - mesh_seconds,
        mesh_seconds=mesh_seconds,
        steps=counts.steps,
        newton_iterations=system.counts["newton"],
        factorisations=system.counts["factorisations"],
        step_cuts=counts.cuts,
    )
    return _result(scene, system.body.layout.mesh, frames, status, message, cost)


@dataclass
class _Counts:
    """reached: the last stretch with an equilibrium."""

    steps: int = 0
    cuts: int = 0
    reached: float = 1.0


def _advance(
    system: PressSystem, here: State, before: State | None, target: float, counts: _Counts
) -> tuple[State, State | None, Status]:
    """From `here` to the target stretch in even steps, halved where they fail."""
    size, status = LARGEST_STEP, Status.CONVERGED
    while here.stretch != target:
        left = float(np.log(target / here.stretch))
        count = max(1, int(np.ceil(abs(left) / size - 1e-9)))
        stretch = target if count == 1 else here.stretch * float(np.exp(left / count))
        counts.steps += 1
        found, status = system.equilibrium(here, before, stretch)
        if found is None:
            counts.cuts += 1
            size = 0.5 * min(size, abs(left))
            if size < SMALLEST_STEP:
                return here, before, status
            continue
        before, here = here, found
        counts.reached = stretch
        size = min(2.0 * size, LARGEST_STEP)
    return here, before, status


@dataclass(frozen=True, eq=False)
class _Frame:
    state: State
    force: float  # of the upper platen on the body along z [N]
    overlap: float
    min_jacobian: float


def _frame(system: PressSystem, state: State) -> _Frame:
    force, min_jacobian = system.body.internal_forces(state.x)
    # the mesh has a quarter of each end
    pushed = 4.0 * float(force[state.carried, 2].sum())
    return _Frame(state, pushed, system.overlap(state.x, state.stretch), min_jacobian)


def _result(
    scene: Press, mesh: Mesh, frames: list[_Frame], status: Status, message: str, cost: Cost
) -> Result:
    n = len(frames)
    support = np.zeros((n, 3))
    support[:, 2] = [-f.force for f in frames]
    return Result(
        scene=scene,
        status=status,
        message=message,
        mesh=mesh,
        load=np.array([f.state.stretch for f in frames]),
        positions=np.array([f.state.x for f in frames]).reshape(n, mesh.n_nodes, 3),
        support_force=support,
        rod_force=np.zeros((n, 3)),
        rod_tip=np.zeros((n, 3)),
        penetration=np.array([f.overlap for f in frames]),
        min_jacobian=np.array([f.min_jacobian for f in frames]),
        residual=np.array([f.state.residual for f in frames]),
        nominal_stress=np.array([f.force for f in frames]) / (np.pi * scene.radius**2),
        cost=cost,
    )
