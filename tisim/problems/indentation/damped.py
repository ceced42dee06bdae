"""Pseudo-transient continuation for steps that Newton's method does not solve.

If the surface snaps from one fold to another, or many points begin to slide at once, no path of equilibria
connects the last state to the next, or none that friction follows in one step. The rod is then moved by the
whole step and held. A drag on the nodes near it is lowered as fast as Newton's method converges (Kelley and
Keyes, SIAM J. Numer. Anal. 35, 1998). Each intermediate state is accepted, so that friction continues from
it. The final state is an equilibrium without drag, to the same tolerance as any other.
"""

from __future__ import annotations

import logging
import math
from dataclasses import replace

import numpy as np

from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.steps import Array, overlap_fault, too_deep
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status

_log = logging.getLogger(__name__)

# Initial and largest drag of a node, in units of the shear modulus times the rod's radius.
FIRST, LARGEST = 40.0, 200.0
# Largest number of Newton iterations per pseudo-time step. The drag is multiplied by 1/4 after fewer than
# QUARTER iterations, by 1/2 after fewer than HALF.
AT_MOST, QUARTER, HALF = 10, 4, 7
# Tolerance of a pseudo-time step, relative to the rod's force: PART times the drag force of the step before,
# at most LOOSEST, at least LEAST times the tolerance of equilibrium.
PART, LOOSEST, LEAST = 0.2, 2e-3, 0.4
# Factors of the drag after the first steps that follow a failed one, which was too long.
CAUTIOUS = (1.0, 0.5)
# Equilibrium without drag is sought once the drag force is below NEAR times its tolerance, and again each
# time the drag has fallen to AGAIN times its value at the last attempt: in FEW iterations and, if these lower
# the residual to HOPEFUL times the drag force, in TRIED.
NEAR, AGAIN, FEW, HOPEFUL, TRIED = 6.0, 0.3, 4, 0.3, 12

# Longest step for which a motion is tried [m].
LONGEST = 0.2e-3
# Iterations of the direct attempt and of the motion, in units of the largest number of a step. Tissue that
# slides out from under the rod without friction needs up to 320 of the 480 (studies/depth).
STRAIGHT, IN_MOTION = 0.5, 12.0
# The motion is abandoned unless its drag has fallen to the fraction LOW of the first within the fraction SOON
# of its iterations: over crushed tissue it does not fall.
LOW, SOON = 0.1, 0.125


def solve_step(
    system: PokeSystem,
    block: CondensedBlock,
    x: Array,
    *,
    tolerance: float,
    kept: bool,
    length: float = 0.0,
    between: float = 0.0,
) -> tuple[Outcome, Status | None]:
    """Equilibrium at the system's pose from the start value x (n, 3), directly or by a damped motion.

    A motion takes five times the iterations of a direct attempt and more, and most steps succeed if they are
    shorter. A step above LONGEST is therefore refused without one, so that the caller makes it shorter.

    Parameters
    ----------
    system : PokeSystem
    block : CondensedBlock
    x : ndarray of float, shape (n, 3)
        Start positions [m].
    tolerance, kept
        See `tisim.nonlinear.contact_newton.settled`.
    length : float
        Length of the step [m].
    between : float
        Tolerance of a step between frames: a direct attempt that is within it is accepted although it has not
        converged to `tolerance`, and its status says so.

    Returns
    -------
    tuple of (Outcome, Status or None)
        The status is the reason for which the step is refused; None if it is accepted.
    """
    most = system.scene.solver.max_iterations
    system.touch(x)
    outcome = block.solve(x, tolerance=tolerance, max_iterations=math.ceil(STRAIGHT * most), kept=kept)
    refused = overlap_fault(outcome, system)
    nearly = refused is Status.NOT_CONVERGED and outcome.residual <= between
    if refused is None or (nearly and not too_deep(outcome.x, system)):
        return outcome, None
    if length > LONGEST:
        return outcome, refused
    moved = come_to_rest(
        system, block, x, tolerance=tolerance, max_iterations=math.ceil(IN_MOTION * most), kept=kept
    )
    outcome = replace(moved, iterations=outcome.iterations + moved.iterations)
    return outcome, None if moved.status is Status.CONVERGED else moved.status


def come_to_rest(
    system: PokeSystem, block: CondensedBlock, x: Array, *, tolerance: float, max_iterations: int, kept: bool
) -> Outcome:
    """Equilibrium at the system's pose by a damped motion from x (n, 3); arguments as `CondensedBlock.solve`.

    If none is found, the system is restored to its state before the call.
    """
    before = system.remembered()
    unit = system.body.moduli.shear_modulus * system.scene.rod.radius
    drag, lowest, tried, force, used = FIRST * unit, np.inf, np.inf, np.inf, 0
    motion, its_drag = np.zeros_like(x), drag  # of the last step, which the next one begins with
    cautious: list[float] = []
    block.renew()
    while True:
        guess = x + min(1.0, its_drag / drag) * motion
        if system.potential(guess)[1] < 0.5 * system.min_jacobian:
            guess = x
        system.touch(guess)
        enough = max(LEAST * tolerance, min(LOOSEST, PART * force))
        outcome = block.solve(
            guess, tolerance=enough, max_iterations=AT_MOST, kept=False, drag=drag, dragged_from=x
        )
        used += max(outcome.iterations, 1)
        refused = overlap_fault(outcome, system)
        if refused is None:
            motion, its_drag = outcome.x - x, drag
            force = drag * float(np.linalg.norm(motion)) / max(system.rod_force(), 1e-12)
            x, iterations, lowest = outcome.x, outcome.iterations, min(lowest, drag)
            # areas that change with each state would keep a motion that is at rest in motion
            system.accept(x, follow=force > tolerance)
            system.move_to(system.depth)
            near = force < NEAR * tolerance and drag < AGAIN * tried
            tried = drag if near else tried
            outcome = _without_drag(
                system, block, x, tolerance=tolerance, kept=kept, force=force if near else 0.0
            )
            used += outcome.iterations
            if overlap_fault(outcome, system) is None:
                _log.debug("at rest after %d iterations, drag %.2g", used, drag / unit)
                return replace(outcome, iterations=used)
            if cautious:
                drag *= cautious.pop(0)
            else:
                drag *= 0.25 if iterations < QUARTER else 0.5 if iterations < HALF else 1.0
        else:
            drag *= 4.0
            motion = np.zeros_like(x)
            cautious = list(CAUTIOUS)
        most = max_iterations if lowest <= LOW * FIRST * unit else SOON * max_iterations
        if drag > LARGEST * unit or used >= most:
            _log.debug("no rest after %d iterations, drag %.2g", used, drag / unit)
            system.recall(before)
            system.drag = None
            block.renew()
            status = Status.NOT_CONVERGED if refused is None else refused
            return Outcome(outcome.x, status, outcome.residual, used)


def _without_drag(
    system: PokeSystem, block: CondensedBlock, x: Array, *, tolerance: float, kept: bool, force: float
) -> Outcome:
    """Equilibrium from x (n, 3), where the drag's relative force is `force`; not tried if that is 0."""
    system.touch(x)
    outcome = block.solve(x, tolerance=tolerance, max_iterations=FEW if force else 0, kept=kept)
    if outcome.status is not Status.NOT_CONVERGED or outcome.residual > HOPEFUL * force:
        return outcome
    more = block.solve(outcome.x, tolerance=tolerance, max_iterations=TRIED - FEW, kept=kept)
    return replace(more, iterations=outcome.iterations + more.iterations)
