"""Constants, frames, start values and acceptance of steps, for pokes by depth and by course."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.rod import tissue_left
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

Array = NDArray[np.float64]

# Penetration, as a fraction of the edge radius, beyond which a step is refused.
REFUSE_AT = 0.5
# A long step is made shorter before it is tried if its start value penetrates by DEEP times what the last
# accepted state does, and by DEEP_AT_LEAST of the edge radius.
DEEP, DEEP_AT_LEAST = 1.4, 0.22
FIRST_STEP, LARGEST_STEP, SMALLEST_STEP = 0.1e-3, 0.5e-3, 0.02e-3
# A step that took at most EASY iterations of Newton's method lets the next one grow, one that took more than
# HARD lets it shrink, and a refused step is tried again smaller.
EASY, HARD = 6, 12
GROW, SHRINK, CUT = 2.0, 0.7, 0.4
# Iterations that refused steps between two frames may take, in units of the largest number of one step. Near
# the end of a poke, where tissue is crushed, smaller steps gain a tenth of a millimetre at the cost of the
# whole poke before.
IN_VAIN = 4
# Tolerance of steps between frames, which only follow the path, in units of the frames' tolerance.
BETWEEN = 12.0


@dataclass(frozen=True, eq=False)
class Frame:
    """One equilibrium.

    Attributes
    ----------
    depth : depth of the rod [m].
    x : positions [m], shape (n, 3).
    rod_force, base_force : force on the rod and force of the base on the body [N], shape (3,).
    tip : centre of the rod's tip [m], shape (3,).
    penetration : penetration of the surface into the rod [m].
    min_jacobian : smallest det F.
    residual : residual relative to the load.
    time : time [s].
    dissipated : energy dissipated by the material so far [J].
    """

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
    """Reason for which a step is refused; None if it is accepted."""
    if outcome.status is not Status.CONVERGED:
        return outcome.status
    return Status.PENETRATION if too_deep(outcome.x, system) else None


def too_deep(x: Array, system: PokeSystem) -> bool:
    """True if the surface at x (n, 3) is farther in the rod than a step may leave it, or no tissue is left.

    The rod touches the surface alone: nothing else keeps it out of a rigid inclusion when tissue is crushed.
    """
    if system.overlap(x) > REFUSE_AT * system.rounding:
        return True
    return system.scene.mesh is None and tissue_left(system.scene, system.tip, system.axis)[0] == 0.0


def starts_deep(guess: Array, system: PokeSystem) -> bool:
    """True if the start value (n, 3) is so deep in the rod that Newton's method would need many iterations.

    The pressure grows with the fifth power of the penetration, so that an iteration lowers a deep one by a
    fifth at most.
    """
    return system.overlap(guess) > max(DEEP * system.penetration, DEEP_AT_LEAST * system.rounding)


def next_step(step: float, iterations: int) -> float:
    """Length of the step [m] after one of length `step` that was accepted after so many iterations."""
    if iterations <= EASY:
        return min(GROW * step, LARGEST_STEP)
    return SHRINK * step if iterations > HARD else step


def predict(system: PokeSystem, x: Array, move: Array) -> Array:
    """Extrapolate x by `move`, halved up to three times while that lowers the energy.

    Trials in which an element nearly inverts are rejected; if all are, a copy of x is returned. The last
    motion may have been a snap, which does not continue.
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
