"""Newton's method for one depth of a poke, with a trust region in place of a plain line search.

Deep under a rod the surface folds and snaps: the tangent becomes indefinite or, by friction, nearly singular,
and Newton's step is far too large along a few modes. Scaling the whole step then stalls all other modes; a
multiple of the identity added to the tangent (`FactorGMRES.stiffen`) limits only these modes. The shifted
step is the implicit step of a viscous motion, so that a snap is followed to lower energy while the residual
rises. The shift decreases when full steps are accepted. The residual of the convergence test is without it.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tisim.linear.direct import LinearSolveError
from tisim.linear.krylov import FactorGMRES
from tisim.nonlinear.newton import CRUSHED, Outcome
from tisim.result import Status

Array = NDArray[np.float64]

# Largest displacement of a node in one iteration [m]: initially, and at most.
RADIUS, LARGEST_RADIUS = 0.3e-3, 0.5e-3
# Allowed difference between the rod's force and the reaction at the fixed nodes, as a fraction of the former.
BALANCE = 0.005
# Factor by which the residual may grow in a step that lowers the energy.
GROWTH = 2.0
ATTEMPTS = 6
# Relative residual of the linear solves: FORCING in the first iteration, then SHARE of the factor by which
# the last iteration lowered the nonlinear residual, between FINEST and FORCING. After an exact step a change
# of contact leaves 0.1 to 0.4 of the residual as well, so that better solves are in vain (studies/depth).
FORCING, SHARE, FINEST = 0.1, 0.3, 1e-2


class ContactSystem(Protocol):
    """Protocol of `tisim.problems.indentation.system.PokeSystem`; compare `tisim.nonlinear.newton.System`."""

    linear: FactorGMRES

    def potential(self, x: Array) -> tuple[float, float]: ...

    def residual(self, x: Array) -> tuple[Array, float]: ...

    def linearise(self, x: Array) -> tuple[Array, float]: ...

    def step(self, residual: Array, *, forcing: float) -> Array: ...

    def advance(self, x: Array, step: Array) -> Array: ...

    def residual_norm(self, x: Array) -> float: ...

    def rod_force(self) -> float: ...


def contact_newton(
    system: ContactSystem,
    x: Array,
    *,
    tolerance: float,
    max_iterations: int,
    kept: bool = True,
) -> Outcome:
    """Equilibrium from x (n, 3) [m] by the criterion `settled`, which explains `tolerance` and `kept`."""
    relative, radius = np.inf, RADIUS
    system.linear.reset()
    for iteration in range(max_iterations + 1):
        residual, load = system.residual(x)
        size = float(np.linalg.norm(residual))
        if not np.isfinite(size):
            return Outcome(x, Status.NOT_CONVERGED, np.inf, iteration)
        previous, relative = relative, size / load
        if settled(system, residual, load, tolerance=tolerance, kept=kept):
            return Outcome(x, Status.CONVERGED, relative, iteration)
        if iteration == max_iterations:
            break
        system.linearise(x)
        forcing = float(np.clip(SHARE * relative / previous, FINEST, FORCING)) if iteration else FORCING
        try:
            found, status, radius = _step(system, x, residual, radius, forcing)
        except LinearSolveError:
            return Outcome(x, Status.SINGULAR, relative, iteration)
        if found is None:
            return Outcome(x, status, relative, iteration)
        x = found
    return Outcome(x, Status.NOT_CONVERGED, relative, max_iterations)


def settled(system: ContactSystem, residual: Array, load: float, *, tolerance: float, kept: bool) -> bool:
    """True if |residual| <= tolerance * load and, for a state to be kept as a frame, the forces balance.

    If `kept`, the sum of the residual must also be below BALANCE times the rod's force (or below
    tolerance * load): small residuals of thousands of nodes may all have the same direction.
    """
    if float(np.linalg.norm(residual)) > tolerance * load:
        return False
    missing = float(np.linalg.norm(residual.sum(axis=0))) if kept else 0.0
    return missing <= max(BALANCE * system.rod_force(), tolerance * load)


def _step(
    system: ContactSystem,
    x: Array,
    residual: Array,
    radius: float,
    forcing: float,
) -> tuple[Array | None, Status, float]:
    """The next x (None if no step is accepted), the reason if there is none, and the next radius."""
    linear = system.linear
    start, _ = system.potential(x)
    status = Status.NOT_CONVERGED
    held_back = False
    for _ in range(ATTEMPTS):
        step = system.step(residual, forcing=forcing)
        peak = float(np.sqrt((step * step).sum(axis=1).max()))
        if peak == 0.0:
            return None, Status.NOT_CONVERGED, radius
        slope = float(np.vdot(residual, step))
        # too long, or an ascent direction, which friction can cause
        if (peak > 2.0 * radius or slope > 0.0) and linear.can_stiffen:
            linear.stiffen()
            held_back = True
            continue
        scale = min(1.0, radius / peak)
        for _ in range(2):
            trial = system.advance(x, scale * step)
            energy, min_jacobian = system.potential(trial)
            if min_jacobian <= CRUSHED or not np.isfinite(energy):
                status = Status.INVERTED
            else:
                status = Status.NOT_CONVERGED
                lower = energy <= start + 1e-4 * scale * min(slope, 0.0) + 1e-13 * abs(start) + 1e-18
                if _good(system, trial, residual, scale, lower=lower):
                    if scale * peak >= 0.99 * radius:
                        radius = min(2.0 * radius, LARGEST_RADIUS)
                    # keep a shift that was needed now for the next iteration
                    if not held_back and (scale == 1.0 or scale * peak > 0.25 * radius):
                        linear.relax()
                    return trial, Status.CONVERGED, radius
            scale *= 0.5
        radius = max(0.5 * min(radius, peak), 2.0 * scale * peak)
        linear.stiffen()
        held_back = True
    return None, status, radius


def _good(system: ContactSystem, trial: Array, residual: Array, scale: float, *, lower: bool) -> bool:
    """True if a trial is accepted: its residual falls, or it is `lower` in energy and within GROWTH.

    Friction has no potential, so that neither alone is a criterion.
    """
    size = float(np.linalg.norm(residual))
    new = system.residual_norm(trial)
    return new < (1.0 - 0.1 * scale) * size or (lower and new < GROWTH * size)
