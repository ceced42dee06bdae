"""Records of both dynamic methods: frames in time, the criterion of rest, the outcome."""

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
    """States kept of a dynamic run; the released state at time 0 is the rest shape and is not kept.

    time (f,) [s]; positions (f, n, 3) [m]; support_force (f, 3) [N], inertia and damping included;
    min_jacobian (f,); residual (f,): the *static* out-of-balance force at the free nodes relative to the
    applied load, which is what is left to rest (each step's own residual is under the tolerance);
    dissipated (f,) [J]: by viscosity and softening of the material, not by Rayleigh's damping.
    """

    body: DiscretisedBody
    time: list[float] = field(default_factory=list)
    positions: list[Array] = field(default_factory=list)
    support_force: list[Array] = field(default_factory=list)
    min_jacobian: list[float] = field(default_factory=list)
    residual: list[float] = field(default_factory=list)
    dissipated: list[float] = field(default_factory=list)

    def keep(self, time: float, x: Array, dynamic: Array, min_jacobian: float, residual: float) -> None:
        """dynamic (n, 3) [N]: internal, damping and inertia forces less the applied load."""
        discretisation = self.body.discretisation
        support = dynamic[discretisation.fixed].sum(axis=0) * discretisation.multiplicity
        for axis in discretisation.mesh.symmetry:
            support["xyz".index(axis)] = 0.0
        self.time.append(time)
        self.positions.append(x.copy())
        self.support_force.append(support)
        self.min_jacobian.append(min_jacobian)
        self.residual.append(residual)
        self.dissipated.append(self.body.dissipated())


@dataclass(frozen=True, eq=False)
class Run:
    """Outcome of a dynamic run, its frames, its cost.

    time: reached [s]; drift: largest error of the energy balance against the largest energy (explicit).
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
    """The duration cut into equal parts no longer than the time step; every `stride`-th end is a frame."""

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
    """Size of the out-of-balance force at the free nodes, in parts of the load's [-] (without one, [N])."""
    discretisation = body.discretisation
    residual = (force - body.dead_load)[discretisation.pattern.free]
    residual[discretisation.held] = 0.0
    size, load = float(np.linalg.norm(residual)), load_size(body)
    return size / load if load > 0.0 else size


def load_size(body: DiscretisedBody) -> float:
    """Size of the applied load at the free nodes [N]."""
    return float(np.linalg.norm(body.dead_load[body.discretisation.pattern.free]))


def at_rest(body: DiscretisedBody, x: Array, relative: float, kinetic: float, tolerance: float) -> bool:
    """Equilibrium and no motion left that could leave it.

    relative: static residual against the load; kinetic [J]. A swing of amplitude e around equilibrium, in
    parts of the deflection, has a residual of about e and an energy of e^2 times half the load's work, but
    passes the equilibrium itself with no residual at all: both must be small.
    """
    work = abs(float(np.vdot(body.dead_load, x - body.discretisation.mesh.nodes)))
    return relative <= tolerance and kinetic <= tolerance**2 * 0.5 * work


def not_at_rest(residual: float, solver: Solver) -> str:
    """The sentence for a run that ended before the rest it was asked for."""
    damped = solver.mass_damping > 0.0 or solver.stiffness_damping > 0.0
    hint = "" if damped else "; nothing damps the motion (mass_damping, stiffness_damping)"
    return f"not at rest after {solver.duration:g} s: residual {residual:.1e} of the load{hint}"
