"""Implicit dynamics by the second-order backward difference formula (BDF2).

With D u the backward difference of u at the new time (variable steps: Hairer, Norsett & Wanner, Solving
Ordinary Differential Equations I, III.5), each step solves

    M D v + c_M M v + f(x) + c_K D f(x) = p,    v = D x

for the positions x at its end: consistent mass M, internal forces f, dead load p. Rayleigh damping uses the
stiffness at the *current* positions, since D f is K(x) v to second order. (With the stiffness at rest, the
rotation of a bent beam would act as a change of volume, which the bulk modulus resists.)

BDF2 is preferred to generalised-alpha for three reasons. It is L-stable, so that the sudden release and the
stiff volumetric modes of nearly incompressible tissue decay in a few steps without a parameter. It needs no
acceleration at the start. All its terms are evaluated at the end of the step, so that damping and its tangent
are exact at no cost. In return a mode with w dt = 0.1 loses 0.0025 % of its amplitude per step, and its
period is 0.3 % too long (a third of (w dt)^2). The first step is backward Euler, which keeps the order.

The stress of a viscous material at the end of the step derives from the step's potential
(`tisim.discretisation.history`), which is of second order as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import DiscretisedBody
from tisim.discretisation.mass import consistent_mass, on_pattern
from tisim.linear.direct import LinearSolveError
from tisim.nonlinear.newton import newton
from tisim.problems._registry import OnStep, skip
from tisim.problems.dynamics.frames import (
    Frames,
    Intervals,
    Run,
    at_rest,
    not_at_rest,
    static_residual,
)
from tisim.result import Status
from tisim.scene import Solver

Array = NDArray[np.float64]

MOST_HALVINGS = 10  # of the time step, before the run fails
CALM_STEPS = 4  # consecutive successful steps before a halved step is doubled again
SHARPER = 0.1  # tolerance of a step as a fraction of the solver's, so that rest can be detected
ROUNDING = 1e-15


@dataclass(frozen=True, eq=False)
class State:
    """Displacement u [m], velocity v [m/s], acceleration a [m/s2], internal force f [N], each (n, 3)."""

    u: Array
    v: Array
    a: Array
    f: Array


def difference(step: float, before: float | None) -> tuple[float, float, float]:
    """Weights of D at the new, the last and the second-last time [1/s].

    Parameters
    ----------
    step, before : float
        Length of this and of the last step [s]; `before` is None in the first step (backward Euler). A step
        may be twice the last one (zero-stable below 1 + sqrt 2).
    """
    if before is None:
        return 1.0 / step, -1.0 / step, 0.0
    r = step / before
    return (1 + 2 * r) / ((1 + r) * step), -(1 + r) / step, r * r / ((1 + r) * step)


class ImplicitSystem:
    """The equation of one time step (see `tisim.nonlinear.newton.System`).

    The element pressures are independent unknowns (as in `BeamSystem.free_pressures`), so that second-order
    errors of volume do not cut the Newton steps.
    """

    def __init__(self, body: DiscretisedBody, solver: Solver, scale: float) -> None:
        self.body, self.solver, self.scale = body, solver, scale
        self.mass = consistent_mass(body.discretisation.mesh, body.material.density, body.added_mass)
        self._mass_blocks = on_pattern(self.mass, body.discretisation.pattern)[:, None, None] * np.eye(3)
        self.newton_iterations = 0
        self.factorisations = 0

    def begin(self, step: float, last: State, before: tuple[State, float] | None) -> Array:
        """Set the difference formula of a step of length `step` [s]; return the predicted positions (n, 3).

        `before` is the second-last state and the length of the last step, None in the first step.
        """
        self.body.begin(step)
        c, c1, c2 = difference(step, before[1] if before else None)
        older = before[0] if before else last
        self.c = c
        self._u, self._v, self._f = (c1 * getattr(last, k) + c2 * getattr(older, k) for k in ("u", "v", "f"))
        nodes = self.body.discretisation.mesh.nodes
        moved = np.zeros_like(nodes)
        free = self.body.discretisation.pattern.free
        moved[free] = step * last.v[free] + 0.5 * step**2 * last.a[free]
        self._pressure = self.body.pressures(nodes + last.u, moved)
        return np.asarray(nodes + last.u + moved)

    def state(self, x: Array, f: Array) -> State:
        u = x - self.body.discretisation.mesh.nodes
        v = self.c * u + self._u
        return State(u, v, self.c * v + self._v, f)

    def balance(self, state: State) -> Array:
        """Inertia, damping and internal forces less the load at all nodes [N], shape (n, 3)."""
        s = self.solver
        rate = self.c * state.f + self._f
        drag = np.asarray(self.mass @ (state.a + s.mass_damping * state.v))
        return np.asarray(drag + state.f + s.stiffness_damping * rate - self.body.dead_load)

    def potential(self, x: Array) -> tuple[float, float]:
        return self.body.energy(x)  # required by the protocol; there is no line search

    def linearise(self, x: Array) -> tuple[Array, float]:
        discretisation, c, s = self.body.discretisation, self.c, self.solver
        self.newton_iterations += 1
        self._blocks, force, self.min_jacobian = self.body.stiffness(x, self._pressure)
        self._blocks *= 1.0 + c * s.stiffness_damping
        self._blocks += c * (c + s.mass_damping) * self._mass_blocks
        residual = self.body.discretisation.free_components(self.balance(self.state(x, force)))
        if self.min_jacobian <= 0.0:
            residual[:] = np.nan
        # short steps amplify the rounding of positions, which bounds the residual that can be reached
        diagonal = discretisation.pattern.diagonal(self._blocks)
        noise = ROUNDING * float(np.linalg.norm(diagonal * x[discretisation.pattern.free]))
        return residual, self.scale + noise / (SHARPER * s.tolerance)

    def step(self, residual: Array, *, forcing: float) -> Array:  # noqa: ARG002 - the solve is exact
        discretisation = self.body.discretisation
        discretisation.hold(self._blocks)
        discretisation.solver.factorise(self._blocks)
        self.factorisations += 1
        step = discretisation.solver.solve(-residual)
        if not np.isfinite(step).all():
            raise LinearSolveError("the step's matrix is singular")
        return step

    def advance(self, x: Array, step: Array) -> Array:
        moved = x.copy()
        moved[self.body.discretisation.pattern.free] += step
        self._pressure = self.body.pressures(x, moved - x)
        return moved

    def second_step(self, residual: Array) -> Array | None:  # noqa: ARG002 - there is no second tangent
        return None

    def searches(self) -> bool:
        return False

    def residual_norm(self, x: Array) -> float:
        force, _ = self.body.internal_forces(x)
        residual = self.body.discretisation.free_components(self.balance(self.state(x, force)))
        return float(np.linalg.norm(residual))

    def largest_step(self) -> float:
        return np.inf


def march(
    body: DiscretisedBody,
    solver: Solver,
    *,
    start: Array | None = None,
    velocity: Array | None = None,
    on_step: OnStep = skip,
) -> Run:
    """Integrate the motion of a body after its release.

    Parameters
    ----------
    body : DiscretisedBody
    solver : Solver
    start, velocity : ndarray of float, shape (n, 3), optional
        Positions [m] and velocities [m/s] at time 0: the rest shape and zero by default.
    on_step : OnStep
    """
    parts = Intervals.of(solver)
    nodes = body.discretisation.mesh.nodes
    x = nodes.copy() if start is None else start.copy()
    v = np.zeros_like(nodes) if velocity is None else velocity.copy()
    last = State(x - nodes, v, np.zeros_like(v), body.internal_forces(x)[0])
    # without a load, the residual is measured by the internal force at the release
    scale = body.load_norm() or float(np.linalg.norm(last.f)) or 1.0
    system = ImplicitSystem(body, solver, scale)
    frames = Frames(body)
    before: tuple[State, float] | None = None
    whole = 2**MOST_HALVINGS  # time is counted in units of the shortest step, so that frames are met exactly
    ticks, halvings, calm, steps, cuts = 0, 0, 0, 0, 0
    relative = static_residual(body, last.f)

    def ended(status: Status, message: str) -> Run:
        return Run(
            status,
            message,
            frames,
            parts.length * ticks / whole,
            steps,
            system.newton_iterations,
            system.factorisations,
            cuts,
        )

    tolerance = SHARPER * solver.tolerance
    while ticks < parts.count * whole:
        step = parts.length / 2**halvings
        guess = system.begin(step, last, before)
        outcome = newton(system, guess, tolerance=tolerance, max_iterations=solver.max_iterations)
        if outcome.status is not Status.CONVERGED:
            if halvings == MOST_HALVINGS:
                time = parts.length * ticks / whole
                return ended(outcome.status, f"no step of {step:.1e} s from {time:.4g} s on converges")
            halvings, calm, cuts = halvings + 1, 0, cuts + 1
            continue
        ticks += whole >> halvings
        steps, calm = steps + 1, calm + 1
        force, min_jacobian = body.internal_forces(outcome.x)
        body.accept(outcome.x)
        before, last = (last, step), system.state(outcome.x, force)
        relative = static_residual(body, force)
        kinetic = 0.5 * float(np.vdot(last.v, system.mass @ last.v))
        rest = solver.until_rest and at_rest(body, outcome.x, relative, kinetic, solver.tolerance)
        interval, within = divmod(ticks, whole)
        if rest or ticks == parts.count * whole or (within == 0 and interval % parts.stride == 0):
            time = parts.length * ticks / whole
            frames.keep(time, outcome.x, system.balance(last), min_jacobian, relative)
            on_step(ticks / (parts.count * whole))
        if rest:
            return ended(Status.CONVERGED, "")
        if halvings and calm >= CALM_STEPS and ticks % (whole >> (halvings - 1)) == 0:
            halvings, calm = halvings - 1, 0
    if solver.until_rest:
        return ended(Status.UNFINISHED, not_at_rest(relative, solver))
    return ended(Status.CONVERGED, "")
