"""Explicit dynamics by central differences with lumped mass (leapfrog; Belytschko et al., Nonlinear Finite
Elements for Continua and Structures, 6.2).

    M (v(+) - v(-)) / dt + c_M M (v(+) + v(-)) / 2 + f(x) + c_K df/dt = p,    x(+) = x + dt v(+)

M is diagonal (`tisim.discretisation.mass.lumped_mass`) and v is stored at half steps. df/dt, which is K(x) v
at the *current* positions as in the implicit method, is the difference of the last two internal forces.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import eigsh

from tisim.discretisation.body import DiscretisedBody
from tisim.discretisation.mass import lumped_mass
from tisim.kernels.leapfrog import (
    DRIFT,
    KINETIC,
    LOST,
    MIN_JACOBIAN,
    SCALE,
    STATE_SIZE,
    STEPS,
    leapfrog_kernel,
)
from tisim.problems._registry import OnStep, skip
from tisim.problems.dynamics.frames import Frames, Intervals, Run, at_rest, not_at_rest, static_residual
from tisim.result import Status
from tisim.scene import Solver

Array = NDArray[np.float64]

SAFETY = 0.9  # time step as a fraction of the stable step
LIMIT = 0.01  # error of the energy balance, relative to the largest energy so far, that ends a run
ROUNDING = 1e-13  # energy that is rounding, over shear modulus and volume
RECHECK = 500  # number of steps after which the largest frequency is computed again


def moving_mass(body: DiscretisedBody) -> Array:
    """Lumped mass of each component [kg], 0 for fixed and held components, shape (n, 3)."""
    pattern = body.discretisation.pattern
    mass = np.zeros((body.discretisation.mesh.n_nodes, 3))
    lumped = lumped_mass(body.discretisation.mesh, body.material.density) + body.added_mass
    mass[pattern.free] = lumped[pattern.free, None] * ~body.discretisation.held
    return mass


def highest_frequency(body: DiscretisedBody, x: Array, mass: Array) -> float:
    """Largest eigenfrequency at x: square root of the largest eigenvalue of M^-1 K(x) [rad/s].

    Lanczos' method, with a relative tolerance of 1e-3 on the eigenvalue, from below.
    """
    pattern = body.discretisation.pattern
    blocks, _, _ = body.stiffness(x)
    n = len(pattern.free)
    upper = sparse.triu(sparse.bsr_matrix((blocks, pattern.indices, pattern.indptr), shape=(3 * n, 3 * n)))
    free = mass[pattern.free].ravel()
    scaling = sparse.diags_array(np.where(free > 0.0, 1.0 / np.sqrt(np.where(free > 0.0, free, 1.0)), 0.0))
    full = scaling @ (upper + sparse.triu(upper, 1).T) @ scaling
    start = np.random.default_rng(0).standard_normal(3 * n)  # fixed seed: the result is deterministic
    top = eigsh(full.tocsr(), k=1, which="LA", tol=1e-3, v0=start, return_eigenvectors=False)
    return float(np.sqrt(max(float(top[0]), 0.0)))


def stable_step(frequency: float, stiffness_damping: float) -> float:
    """Longest stable time step [s], 2/w (sqrt(1 + r^2) - r) with r = c_K w / 2.

    Stiffness damping shortens it, since its force lags half a step. Mass damping does not, since its velocity
    is centred.
    """
    ratio = 0.5 * stiffness_damping * frequency
    return 2.0 / frequency * (np.sqrt(1.0 + ratio**2) - ratio)


def march(
    body: DiscretisedBody,
    solver: Solver,
    *,
    start: Array | None = None,
    velocity: Array | None = None,
    safety: float = SAFETY,
    on_step: OnStep = skip,
) -> Run:
    """Integrate the motion of a body after its release.

    Parameters
    ----------
    body : DiscretisedBody
    solver : Solver
    start, velocity : ndarray of float, shape (n, 3), optional
        Positions [m] and velocities [m/s] at time 0: the rest shape and zero by default.
    safety : float
        Time step as a fraction of the stable step.
    on_step : OnStep
    """
    parts = Intervals.of(solver)
    nodes = body.discretisation.mesh.nodes
    x = nodes.copy() if start is None else np.array(start, dtype=float)
    mass = moving_mass(body)
    v = np.zeros_like(nodes) if velocity is None else velocity * (mass > 0.0)
    longest = safety * stable_step(highest_frequency(body, x, mass), solver.stiffness_damping)
    count = int(np.ceil(parts.length / longest))
    dt = parts.length / count
    f = body.internal_forces(x - dt * v)[0]  # so that the first df/dt is consistent with the velocity
    v -= 0.5 * dt * _acceleration(body, solver, x, v, f, dt, mass)
    before = np.zeros_like(f)
    state = np.zeros(STATE_SIZE)
    # energies below are rounding: of a body without load, which stays at rest
    state[SCALE] = ROUNDING * body.moduli.shear_modulus * float(body.discretisation.nodal_volume().sum())
    common = body._common(x)  # without a state
    kernel = leapfrog_kernel(body.law, body.features)
    frames = Frames(body)
    dt_before, steps, looked = dt, 0, 0
    relative = np.inf

    def ended(status: Status, message: str, time: float) -> Run:
        drift = float(state[DRIFT] / state[SCALE]) if state[SCALE] > 0.0 else 0.0
        return Run(status, message, frames, time, steps, drift=drift)

    for interval in range(1, parts.count + 1):
        if steps - looked >= RECHECK:
            looked = steps
            frequency = highest_frequency(body, x, mass)
            longest = min(longest, safety * stable_step(frequency, solver.stiffness_damping))
            count = int(np.ceil(parts.length / longest))
            dt = parts.length / count
        kernel(
            x, v, f, before, nodes, body.dead_load, mass, *common[1:5], *common[6:],
            solver.mass_damping, solver.stiffness_damping, dt, dt_before, LIMIT, count, state,
        )  # fmt: skip
        taken, steps, dt_before = int(state[STEPS]) - steps, int(state[STEPS]), dt
        time = parts.length * (interval - 1) + dt * taken
        if state[LOST]:
            return ended(*_failure(state, time, dt), time)
        force, min_jacobian = body.internal_forces(x)
        relative = static_residual(body, force)
        rest = solver.until_rest and at_rest(body, x, relative, float(state[KINETIC]), solver.tolerance)
        if rest or interval == parts.count or interval % parts.stride == 0:
            # the lumped mass of fixed nodes does not move: the supports carry no inertia force
            dynamic = force + solver.stiffness_damping * (force - f) / dt - body.dead_load
            frames.keep(time, x, dynamic, min_jacobian, relative)
            on_step(interval / parts.count)
        if rest:
            return ended(Status.CONVERGED, "", time)
    if solver.until_rest:
        return ended(Status.UNFINISHED, not_at_rest(relative, solver), time)
    return ended(Status.CONVERGED, "", time)


def _acceleration(
    body: DiscretisedBody, solver: Solver, x: Array, v: Array, before: Array, dt: float, mass: Array
) -> Array:
    """Acceleration at x and v (n, 3) [m/s2], 0 for components without mass; before: forces dt earlier [N]."""
    force = body.internal_forces(x)[0]
    rate = solver.stiffness_damping * (force - before) / dt
    push = body.dead_load - force - rate
    return np.where(mass > 0.0, push / np.where(mass > 0.0, mass, 1.0) - solver.mass_damping * v, 0.0)


def _failure(state: Array, time: float, dt: float) -> tuple[Status, str]:
    if state[MIN_JACOBIAN] <= 0.0:
        return Status.INVERTED, f"an element turned over at {time:.4g} s (step {dt:.2e} s)"
    drift = state[DRIFT] / state[SCALE]
    return (
        Status.DIVERGED,
        f"the energy ran away at {time:.4g} s: the step of {dt:.2e} s is not stable (drift {drift:.1e})",
    )
