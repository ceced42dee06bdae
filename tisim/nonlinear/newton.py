"""Newton's method with line search for one load level of a system that has a potential.

The line search uses the energy; convergence is judged by the force residual alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tisim.linear.direct import LinearSolveError
from tisim.result import Status

Array = NDArray[np.float64]

# det F below which an element counts as inverted: St Venant-Kirchhoff has equilibria of zero volume.
CRUSHED = 1e-4


class System(Protocol):
    """One load level of a scene. x is (n, 3) over all nodes, residual and step (n_free, 3) over free nodes.

    Attributes
    ----------
    min_jacobian : float
        Smallest det F at the last linearised x.
    """

    min_jacobian: float

    def potential(self, x: Array) -> tuple[float, float]:
        """Potential [J] and smallest det F."""

    def linearise(self, x: Array) -> tuple[Array, float]:
        """Residual at the free nodes (n_free, 3) [N] with held components zero, and the load scale [N]."""

    def step(self, residual: Array, *, forcing: float) -> Array:
        """Newton step -K^-1 r at the last linearised x, a descent direction; LinearSolveError if that fails.

        An iterative solver stops at the relative residual `forcing`.
        """

    def second_step(self, residual: Array) -> Array | None:
        """Another step to try if the line search refuses the first; None if there is none."""

    def advance(self, x: Array, step: Array) -> Array:
        """Copy of x with the step added at the free nodes."""

    def searches(self) -> bool:
        """True if the line search uses the potential; False if steps are taken without a line search."""

    def residual_norm(self, x: Array) -> float:
        """Norm of the residual at x [N], for trials that the energy rejects in the line search."""

    def largest_step(self) -> float:
        """Largest displacement of a node in one iteration [m]."""


@dataclass(frozen=True)
class Outcome:
    """Result of Newton's method.

    Attributes
    ----------
    x : positions [m], shape (n, 3).
    status : outcome.
    residual : residual relative to the load.
    iterations : number of iterations.
    """

    x: Array
    status: Status
    residual: float
    iterations: int


def newton(system: System, x: Array, *, tolerance: float, max_iterations: int) -> Outcome:
    """Minimise the system's potential from x until |residual| <= tolerance * load."""
    relative, before = np.inf, x
    for iteration in range(max_iterations + 1):
        residual, load = system.linearise(x)
        size = float(np.linalg.norm(residual))
        if iteration > 0 and system.min_jacobian <= CRUSHED:
            return Outcome(before, Status.INVERTED, relative, iteration)
        if not np.isfinite(size):
            return Outcome(x, Status.NOT_CONVERGED, np.inf, iteration)
        previous, relative = relative, size / load if load > 0 else size
        if relative <= tolerance:
            return Outcome(x, Status.CONVERGED, relative, iteration)
        if iteration == max_iterations:
            break
        try:
            step = system.step(residual, forcing=float(np.clip(0.1 * relative / previous, 3e-3, 2e-2)))
        except LinearSolveError:
            return Outcome(x, Status.SINGULAR, relative, iteration)
        found, status = _line_search(system, x, step, residual, _scale(system, step))
        if found is None:
            second = system.second_step(residual)
            if second is not None:
                found, status = _line_search(system, x, second, residual, _scale(system, second))
        if found is None:
            return Outcome(x, status, relative, iteration)
        x, before = found, x
    return Outcome(x, Status.NOT_CONVERGED, relative, max_iterations)


def _scale(system: System, step: Array) -> float:
    peak = float(np.sqrt((step * step).sum(axis=1).max()))
    return min(1.0, system.largest_step() / peak) if peak > 0 else 1.0


def _line_search(
    system: System, x: Array, step: Array, residual: Array, scale: float
) -> tuple[Array | None, Status]:
    if not system.searches():  # the next linearisation detects inverted elements
        return system.advance(x, scale * step), Status.CONVERGED
    start, _ = system.potential(x)
    slope = float(np.vdot(residual, step))
    # energy differences below this are rounding errors; the residual decides
    noise = 1e-13 * abs(start) + 1e-18
    size = float(np.linalg.norm(residual))
    turned = False
    for _ in range(7):
        trial = system.advance(x, scale * step)
        energy, min_jacobian = system.potential(trial)
        if min_jacobian > CRUSHED and np.isfinite(energy):
            if energy <= start + 1e-4 * scale * min(slope, 0.0) + noise:
                return trial, Status.CONVERGED
            # friction has no potential: a step that lowers the energy too little may still be acceptable
            if system.residual_norm(trial) < (1.0 - 0.1 * scale) * size:
                return trial, Status.CONVERGED
            turned = False
        else:
            turned = True
        scale *= 0.5
    return None, Status.INVERTED if turned else Status.NOT_CONVERGED
