"""Frames, criterion of rest and outcome of both dynamic methods."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import DiscretisedBody
from tisim.result import Status
from tisim.scene import Solver

Array = NDArray[np.float64]

MOST_FRAMES = 500


@dataclass(eq=False)
class Frames:
    """States kept of a dynamic run, without the start at time 0.

    Attributes
    ----------
    body : the body.
    time : time [s], shape (f,).
    positions : node positions [m], shape (f, n, 3).
    support_force : force of the supports with inertia and damping [N], shape (f, 3).
    min_jacobian : smallest det F, shape (f,).
    residual : *static* out-of-balance force at the free nodes relative to the applied load, a measure of the
        distance from equilibrium (the residual of each step is below the tolerance), shape (f,).
    dissipated : energy dissipated by viscosity and softening of the material, not by Rayleigh damping [J],
        shape (f,).
    """

    body: DiscretisedBody
    time: list[float] = field(default_factory=list)
    positions: list[Array] = field(default_factory=list)
    support_force: list[Array] = field(default_factory=list)
    min_jacobian: list[float] = field(default_factory=list)
    residual: list[float] = field(default_factory=list)
    dissipated: list[float] = field(default_factory=list)

    def keep(self, time: float, x: Array, dynamic: Array, min_jacobian: float, residual: float) -> None:
        """Append a state; dynamic (n, 3) [N]: internal, damping and inertia forces less the applied load."""
        support = self.body.discretisation.support_force(dynamic)
        self.time.append(time)
        self.positions.append(x.copy())
        self.support_force.append(support)
        self.min_jacobian.append(min_jacobian)
        self.residual.append(residual)
        self.dissipated.append(self.body.dissipated())


@dataclass(frozen=True, eq=False)
class Run:
    """Outcome, frames and cost of a dynamic run.

    Attributes
    ----------
    status, message : outcome, and a sentence if it is not a success.
    frames : states kept.
    time : time reached [s].
    steps, newton_iterations, factorisations, step_cuts : cost.
    drift : largest error of the energy balance relative to the largest energy; explicit method only.
    """

    status: Status
    message: str
    frames: Frames
    time: float
    steps: int
    newton_iterations: int = 0
    factorisations: int = 0
    step_cuts: int = 0
    drift: float = 0.0


@dataclass(frozen=True)
class Intervals:
    """The duration in `count` equal intervals of `length` [s] up to the time step, a frame every `stride`."""

    count: int
    length: float
    stride: int

    @staticmethod
    def of(solver: Solver) -> Intervals:
        for name in ("duration", "time_step"):
            if not getattr(solver, name) > 0.0:
                raise ValueError(f"solver: {name} must be above 0 s, got {getattr(solver, name)!r}")
        for name in ("mass_damping", "stiffness_damping"):
            if not getattr(solver, name) >= 0.0:
                raise ValueError(f"solver: {name} must not be negative, got {getattr(solver, name)!r}")
        count = max(1, int(np.ceil(solver.duration / solver.time_step - 1e-9)))
        return Intervals(count, solver.duration / count, -(-count // MOST_FRAMES))


def static_residual(body: DiscretisedBody, force: Array) -> float:
    """Norm of the out-of-balance force at the free nodes relative to the load [-]; without a load, in [N]."""
    size, load = float(np.linalg.norm(body.out_of_balance(force))), body.load_norm()
    return size / load if load > 0.0 else size


def at_rest(body: DiscretisedBody, x: Array, relative: float, kinetic: float, tolerance: float) -> bool:
    """True in equilibrium without motion: both the static residual and the kinetic energy are small.

    A vibration around equilibrium with amplitude e, relative to the deflection, has a residual of about e and
    an energy of e^2 times half the load's work, but no residual when it passes through equilibrium.

    Parameters
    ----------
    body : DiscretisedBody
    x : ndarray of float, shape (n, 3)
        Positions [m].
    relative : float
        Static residual relative to the load.
    kinetic : float
        Kinetic energy [J].
    tolerance : float
        Bound of `relative`, and of the amplitude e.
    """
    work = abs(float(np.vdot(body.dead_load, x - body.discretisation.mesh.nodes)))
    return relative <= tolerance and kinetic <= tolerance**2 * 0.5 * work


def not_at_rest(residual: float, solver: Solver) -> str:
    """Message of a run that ended before it came to rest."""
    damped = solver.mass_damping > 0.0 or solver.stiffness_damping > 0.0
    hint = "" if damped else "; nothing damps the motion (mass_damping, stiffness_damping)"
    return f"not at rest after {solver.duration:g} s: residual {residual:.1e} of the load{hint}"
