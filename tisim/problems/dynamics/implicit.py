"""Implicit dynamics by the second-order backward difference formula (BDF2).

With D u the backward difference of u at the new time (variable steps: Hairer, Norsett & Wanner, Solving
Ordinary Differential Equations I, III.5), each step solves

    M D v + c_M M v + f(x) + c_K D f(x) = p,    v = D x

for the positions x at its end: consistent mass M, internal forces f, dead load p. Damping is Rayleigh's,
with the stiffness at the *current* positions, since D f is K(x) v to second order. (With the stiffness at
rest a bent beam's turning would be taken for a change of volume and held back by the bulk modulus.)

Why BDF2 and not generalised-alpha: it is L-stable, so that the sudden release and the stiff volumetric
modes of nearly incompressible tissue die out in a few steps without a parameter; it needs no acceleration
at the start; all its terms stand at the end of the step, which makes the damping and its tangent exact at
no cost. The price: a mode with w dt = 0.1 loses 0.0025 % of its amplitude a step, and its period is 0.3 %
long (a third of (w dt)^2). The first step is backward Euler's, which keeps the order.

A viscous material's stress at the end of the step is that of the step's potential
(`tisim.discretisation.history`), of second order as well.
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
    load_size,
    not_at_rest,
    static_residual,
)
from tisim.result import Status
from tisim.scene import Solver

Array = NDArray[np.float64]

MOST_HALVINGS = 10  # of the time step, before the run gives up
CALM_STEPS = 4  # that must succeed before a halved step doubles again
SHARPER = 0.1  # part of the tolerance that a step is solved to, so that rest can be told from it
ROUNDING = 1e-15


@dataclass(frozen=True, eq=False)
class State:
    """Displacement u [m], velocity v [m/s], acceleration a [m/s2], internal force f [N], each (n, 3)."""

    u: Array
    v: Array
    a: Array
    f: Array


def difference(step: float, before: float | None) -> tuple[float, float, float]:
    """Weights of D at the new, the last and the last but one time [1/s]; before: length of the last step.

    A step may be twice the one before (zero-stable below 1 + sqrt 2).
    """
    if before is None:
        return 1.0 / step, -1.0 / step, 0.0
    r = step / before
    return (1 + 2 * r) / ((1 + r) * step), -(1 + r) / step, r * r / ((1 + r) * step)


class ImplicitSystem:
    """The equation of one step, as Newton wants it (see `tisim.nonlinear.newton.System`).

    The element pressures are unknowns of their own (as in `BeamSystem.free_pressures`), so that steps are
    whole and not cut by second-order errors of volume.
    """

    def __init__(self, body: DiscretisedBody, solver: Solver, scale: float) -> None:
        self.body, self.solver, self.scale = body, solver, scale
        self.mass = consistent_mass(body.discretisation.mesh, body.material.density, body.added_mass)
        self._mass_blocks = on_pattern(self.mass, body.discretisation.pattern)[:, None, None] * np.eye(3)
        self.newton_iterations = 0
        self.factorisations = 0

    def begin(self, step: float, last: State, before: tuple[State, float] | None) -> Array:
        """Set the step's difference formula; returns the predicted positions."""
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
        """Inertia, damping and internal forces less the load, over all nodes (n, 3) [N]."""
        s = self.solver
        rate = self.c * state.f + self._f
        drag = np.asarray(self.mass @ (state.a + s.mass_damping * state.v))
        return np.asarray(drag + state.f + s.stiffness_damping * rate - self.body.dead_load)

    def potential(self, x: Array) -> tuple[float, float]:
        return self.body.energy(x)  # for the protocol: steps are taken whole

    def linearise(self, x: Array) -> tuple[Array, float]:
        discretisation, c, s = self.body.discretisation, self.c, self.solver
        self.newton_iterations += 1
        self._blocks, force, self.min_jacobian = self.body.stiffness(x, self._pressure)
        self._blocks *= 1.0 + c * s.stiffness_damping
        self._blocks += c * (c + s.mass_damping) * self._mass_blocks
        residual = self._free(self.balance(self.state(x, force)))
        if self.min_jacobian <= 0.0:
            residual[:] = np.nan
        # short steps magnify the rounding of positions: nothing can be asked for below that
        diagonal = self._blocks[discretisation.pattern.indptr[:-1]][:, [0, 1, 2], [0, 1, 2]]
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
        return float(np.linalg.norm(self._free(self.balance(self.state(x, force)))))

    def largest_step(self) -> float:
        return np.inf

    def _free(self, force: Array) -> Array:
        residual = force[self.body.discretisation.pattern.free]
        residual[self.body.discretisation.held] = 0.0
        return residual


def march(
    body: DiscretisedBody,
    solver: Solver,
    *,
    start: Array | None = None,
    velocity: Array | None = None,
    on_step: OnStep = skip,
) -> Run:
    """Release the body at `start` (n, 3) [m] (the rest shape) with `velocity` (n, 3) [m/s] (none)."""
    parts = Intervals.of(solver)
    nodes = body.discretisation.mesh.nodes
    x = nodes.copy() if start is None else start.copy()
    v = np.zeros_like(nodes) if velocity is None else velocity.copy()
    last = State(x - nodes, v, np.zeros_like(v), body.internal_forces(x)[0])
    # without a load the force that the body was released with is the measure
    scale = load_size(body) or float(np.linalg.norm(last.f)) or 1.0
    system = ImplicitSystem(body, solver, scale)
    frames = Frames(body)
    before: tuple[State, float] | None = None
    whole = 2**MOST_HALVINGS  # time is counted in the shortest step, so that frames are met exactly
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
