"""Creep of a beam that is loaded by its weight at time 0: the laboratory's bricks with internal stresses.

At time 0 the beam takes its instantaneous equilibrium; there is no inertia. Compressibility does not relax.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.elements import Bricks, assemble
from benchmarks.blind.beams.model import Beam, Model, Resolution, held_face, mesh
from benchmarks.blind.beams.solver import NoEquilibriumError, Shape, newton_step, solve
from benchmarks.blind.timed.convolution import Memory, step_times
from benchmarks.blind.timed.material import Prony

Array = NDArray[np.float64]
GROWTH = 0.3  # longest time step over the time since release


def hang(
    beam: Beam,
    prony: Prony,
    times: Sequence[float],
    *,
    resolution: Resolution | None = None,
    growth: float = GROWTH,
) -> list[Shape]:
    """Shapes at times after release [s], in ascending order; 0 may be among them.

    Parameters
    ----------
    beam : Beam
        `mu` is the long-time modulus.
    growth : float
        Longest time step over the time since release.

    Raises
    ------
    NoEquilibriumError
        Its text names the time.
    ValueError
        If a clamp is compliant or pinned.
    """
    if beam.compliance or beam.far_pinned:
        raise ValueError("creeping beam: expected clamps that hold")
    at_once = prony.instantaneous
    start = solve(
        replace(beam, mu=at_once * beam.mu, bulk_ratio=beam.bulk_ratio / at_once), resolution=resolution
    )
    model = mesh(beam, resolution or Resolution())
    x = start.x
    p = np.zeros((len(model.element), model.bricks.pressure.shape[1]))
    memory = Memory(prony, (*model.bricks.weight.shape, 3, 3))
    wanted = np.asarray(times, dtype=float)
    steps = step_times(wanted[wanted > 0.0], float(prony.tau.min()), growth)
    found, now = [], 0.0
    for time in (0.0, *steps):
        try:
            x, p = _equilibrium(model, x, p, *memory.begin(time - now))
        except NoEquilibriumError as error:
            raise NoEquilibriumError(f"at {time:.4g} s: {error}") from error
        memory.accept(isochoric(model.bricks, x.reshape(-1, 3)[model.element], model.mu, beam.stiffening))
        now = time
        if time in wanted:
            found.append(Shape(model, x, start.turn, len(steps)))
    return found


def isochoric(mesh: Bricks, x: Array, mu: Array, stiffening: float) -> Array:
    """S_iso of mu/2 [(I1bar - 3) + a (I1bar - 3)^2] at the quadrature points (e, q, 3, 3)."""
    F = np.matmul(mesh.gradient, x[:, None]).swapaxes(-1, -2)
    C = F.swapaxes(-1, -2) @ F
    scale = np.linalg.det(C) ** (-1 / 3)
    trace = np.trace(C, axis1=-2, axis2=-1)
    factor = mu * scale * (1 + 2 * stiffening * (scale * trace - 3))
    return np.asarray(factor[..., None, None] * (np.eye(3) - trace[..., None, None] / 3 * np.linalg.inv(C)))


def _equilibrium(model: Model, x: Array, p: Array, scale: float, history: Array) -> tuple[Array, Array]:
    """Newton's method with the step's potential scale W + history : C/2, on positions and pressures."""
    beam, mesh = model.beam, model.bricks
    ends = (0, -1) if beam.bridge else (0,)
    turn = np.array([beam.near_tilt, 0.0][: len(ends)])
    loose, spring = np.zeros(0, dtype=np.intp), np.full(len(ends), np.inf)
    x = x.copy()
    for _ in range(12):
        slopes, moves = [], np.zeros_like(x)
        for k, end in enumerate(ends):
            face, slope = held_face(model, end, float(turn[k]))
            moves[end] = face - x[end]
            slopes.append(slope)
        here = x.reshape(-1, 3)[model.element]
        parts = assemble(mesh, here, p, scale * model.mu, beam.stiffening, beam.bulk_ratio / scale)
        force, matrix = _with_history(mesh, here, history)
        dx, _ = newton_step(
            model, parts.force + force, parts.matrix + matrix, 1.0, moves, slopes, loose, spring, 0 * turn
        )
        largest = np.abs(dx).max()
        if not largest < beam.length:
            break
        x = x + dx
        du = dx.reshape(-1, 3)[model.element].reshape(len(p), -1)
        p = p + parts.shift + np.einsum("ebk,ek->eb", parts.recover, du)
        if largest < 2e-7:
            return x, p
    raise NoEquilibriumError("no equilibrium of a creeping beam")


def _with_history(mesh: Bricks, x: Array, history: Array) -> tuple[Array, Array]:
    """Force (e, a, 3) and matrix (e, a, 3, b, 3) of the energy history : C/2."""
    F = np.matmul(mesh.gradient, x[:, None]).swapaxes(-1, -2)
    weighted = history * mesh.weight[..., None, None]
    force = np.einsum("eqja,eqij->eai", mesh.gradient, F @ weighted, optimize=True)
    between = np.einsum("eqia,eqij,eqjb->eab", mesh.gradient, weighted, mesh.gradient, optimize=True)
    return force, np.einsum("eab,ik->eaibk", between, np.eye(3))
