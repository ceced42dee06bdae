"""Common to pokes by depth and by course: constants, frames, the guess of a step, reasons to refuse one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

Array = NDArray[np.float64]

# Penetration, as a fraction of the edge radius, at which a step is refused.
REFUSE_AT = 0.5
FIRST_STEP, LARGEST_STEP, SMALLEST_STEP = 0.1e-3, 0.5e-3, 0.02e-3
# Between two frames, refused steps may take so many times the iterations that one may take. Near a poke's
# end, where tissue is crushed, smaller steps are found for a tenth of a millimetre more, at the cost of all
# the way before.
IN_VAIN = 4
# Tolerance of steps between frames, which are there to follow the path, in units of the frames'.
BETWEEN = 12.0


@dataclass(frozen=True, eq=False)
class Frame:
    """One equilibrium: depth [m], positions, forces [N], how good it is, time [s], energy lost [J]."""

    depth: float
    x: Array
    rod_force: Array
    base_force: Array
    tip: Array
    penetration: float
    min_jacobian: float
    residual: float
    time: float
    dissipated: float


def frame_of(x: Array, system: PokeSystem, residual: float, time: float = 0.0) -> Frame:
    """Frame of an accepted equilibrium."""
    return Frame(
        depth=system.depth,
        x=x,
        rod_force=system.report[:3].copy(),
        base_force=system.base_force(),
        tip=system.tip,
        penetration=system.overlap(x),
        min_jacobian=system.min_jacobian,
        residual=residual,
        time=time,
        dissipated=system.body.dissipated(),
    )


def overlap_fault(outcome: Outcome, system: PokeSystem) -> Status | None:
    """Why a step is refused; None where it is good."""
    if outcome.status is not Status.CONVERGED:
        return outcome.status
    return Status.PENETRATION if system.overlap(outcome.x) > REFUSE_AT * system.edge else None


def predict(system: PokeSystem, x: Array, move: Array) -> Array:
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
