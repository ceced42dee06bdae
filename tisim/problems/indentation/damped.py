"""A step that Newton's method does not solve, as a damped motion that comes to rest.

Where the surface snaps from one fold to another, or many points begin to slide at once, no way of equilibria
leads from the last state to the next, or none that friction follows in one step. Then the rod goes on by the
whole step, and stays; a drag holds the nodes next to it, and is lowered as fast as Newton's method follows
(pseudo-transient continuation: Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998). Each state on the way is
accepted, so that friction goes on from it. The state at the end is an equilibrium like any other: without
the drag, to the same tolerance.
"""

from __future__ import annotations

import logging
import math
from dataclasses import replace

import numpy as np

from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.steps import Array, overlap_fault
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

_log = logging.getLogger(__name__)

# The drag of a node at first, and at most, in shear moduli times the rod's radius.
FIRST, LARGEST = 40.0, 200.0
# Newton iterations of a step of the motion; with fewer than these the drag falls to a quarter, to a half.
AT_MOST, QUARTER, HALF = 10, 4, 7
# Residual of a step, in units of the rod's force: this part of the drag before, at most so much, and at least
# this part of what equilibrium is asked for.
PART, LOOSEST, LEAST = 0.2, 2e-3, 0.4
# Where the drag's force is so many times what equilibrium is asked for, it is tried for in so many
# iterations, and again where the drag has come down to this part.
NEAR, TRIED, AGAIN = 6.0, 12, 0.3

# Of the iterations that a step may take: those before it is tried as a motion, and those of the motion.
STRAIGHT, IN_MOTION = 0.5, 4.0
# A motion is given up unless its drag has fallen to the fraction LOW of the first after the fraction SOON of
# its iterations: over crushed tissue it does not fall.
LOW, SOON = 0.1, 0.375


def solve_step(
    system: PokeSystem, block: CondensedBlock, x: Array, *, tolerance: float, kept: bool
) -> tuple[Outcome, Status | None]:
    """Equilibrium at the system's pose from the guess x (n, 3) on, and why it is refused, None if it is good.

    tolerance and kept: as `tisim.nonlinear.contact_newton.settled` has them.
    """
    most = system.scene.solver.max_iterations
    system.touch(x)
    outcome = block.solve(x, tolerance=tolerance, max_iterations=math.ceil(STRAIGHT * most), kept=kept)
    refused = overlap_fault(outcome, system)
    if refused is None:
        return outcome, None
    moved = come_to_rest(
        system, block, x, tolerance=tolerance, max_iterations=math.ceil(IN_MOTION * most), kept=kept
    )
    outcome = replace(moved, iterations=outcome.iterations + moved.iterations)
    return outcome, None if moved.status is Status.CONVERGED else moved.status


def come_to_rest(
    system: PokeSystem, block: CondensedBlock, x: Array, *, tolerance: float, max_iterations: int, kept: bool
) -> Outcome:
    """Equilibrium at the system's pose by a motion from x (n, 3) on; arguments as `CondensedBlock.solve`.

    Where it is not found the system is as if nothing had been tried.
    """
    before = system.remembered()
    unit = system.body.moduli.shear_modulus * system.scene.rod.radius
    drag, tried, force, used = FIRST * unit, np.inf, np.inf, 0
    block.renew()
    while True:
        system.touch(x)
        enough = max(LEAST * tolerance, min(LOOSEST, PART * force))
        outcome = block.solve(x, tolerance=enough, max_iterations=AT_MOST, kept=False, drag=drag)
        used += max(outcome.iterations, 1)
        refused = overlap_fault(outcome, system)
        if refused is None:
            force = drag * float(np.linalg.norm(outcome.x - x)) / max(system.rod_force(), 1e-12)
            x = outcome.x
            system.accept(x)
            system.move_to(system.depth)
            iterations = outcome.iterations
            near = force < NEAR * tolerance and drag < AGAIN * tried
            tried = drag if near else tried
            system.touch(x)
            outcome = block.solve(x, tolerance=tolerance, max_iterations=TRIED if near else 0, kept=kept)
            used += outcome.iterations
            if overlap_fault(outcome, system) is None:
                _log.debug("at rest after %d iterations, drag %.2g", used, drag / unit)
                return Outcome(outcome.x, Status.CONVERGED, outcome.residual, used)
            drag *= 0.25 if iterations < QUARTER else 0.5 if iterations < HALF else 1.0
        else:
            drag *= 4.0
        most = max_iterations if drag <= LOW * FIRST * unit else SOON * max_iterations
        if drag > LARGEST * unit or used >= most:
            _log.debug("no rest after %d iterations, drag %.2g", used, drag / unit)
            system.recall(before)
            system.drag = None
            block.renew()
            status = Status.NOT_CONVERGED if refused is None else refused
            return Outcome(outcome.x, status, outcome.residual, used)
