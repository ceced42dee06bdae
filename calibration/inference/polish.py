"""Gauss-Newton polish with step control, from where CMA-ES ended: each linearisation is one batch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.inference.problem import Problem

Array = NDArray[np.float64]

LADDER = (0.0, 1.0, 30.0, 1000.0, 3e4)
# goes down too where full steps fail again and again: curved valleys of relaxation times and fractions
FINE_LADDER = (0.0, 0.03, 1.0, 30.0, 1000.0)
NEAR = 0.02  # of a coordinate's spread, 0.6 % of a modulus: so near, nuisances are as they were taken, ...
NEARER = 1.0  # ... if the data do not tell the points apart either: as many standard deviations
STALLED = 10  # steps that together may gain less than a tenth of what counts as settled, before it ends
AT_BOUND = 1e-3  # of its range: so near to a bound, a coordinate that is pushed there counts as being there


@dataclass(frozen=True, eq=False, kw_only=True)
class Polished:
    """Result of a polish.

    Attributes
    ----------
    u : array, shape (n,)
    cost : float
    residuals, jacobian : array, shape (m,), (m, n)
        At u, the prior's rows last.
    converged : bool
        The last full step would have gained less than the tolerance.
    message : str
        Why not.
    steps : int
    """

    u: Array
    cost: float
    residuals: Array
    jacobian: Array
    converged: bool
    message: str
    steps: int


def polish(
    problem: Problem,
    start: Array,
    *,
    max_steps: int = 16,
    tolerance: float = 0.002,
    settled: float = 0.4,
    difference: float = 0.1,
    ladder: Sequence[float] = LADDER,
) -> Polished:
    """Minimise the problem's cost by damped Gauss-Newton steps.

    Nuisances are taken at the start, and again at the end point unless that is near. A coordinate at its
    bound stays there while the cost falls beyond it. Along a valley without an end (terms that are too much
    alike) steps gain next to nothing: after `STALLED` of them it ends, not converged.

    Parameters
    ----------
    problem : Problem
    start : array, shape (n,)
    max_steps : int
    tolerance : float
        Stop when the quadratic model promises less [chi-square]: the default is 0.04 sd of one parameter.
    settled : float
        Where no step finds what it promises, so much still counts as converged: the default is 0.6 sd.
    difference : float
        Of the central differences, in each coordinate's spread; smaller ones drown in the solver's tolerance.
    ladder : sequence of float
        Dampings tried in one batch, over the present one.

    Raises
    ------
    ValueError
        The start, or a point on the way, has no equilibrium.
    """
    bounds = problem.parametrisation.bounds
    u = np.clip(np.asarray(start, dtype=float), bounds[:, 0], bounds[:, 1])
    damping, taken = 1e-3, u
    costs_before: list[float] = []
    if not problem.linearise(u):
        raise ValueError("no equilibrium at the start of the polish")
    for step in range(1, max_steps + 1):
        residuals, jacobian = _linearised(problem, u, difference)
        cost = float(residuals @ residuals)
        gradient, curvature = jacobian.T @ residuals, jacobian.T @ jacobian
        near = AT_BOUND * (bounds[:, 1] - bounds[:, 0])
        free = ~(
            ((u <= bounds[:, 0] + near) & (gradient > 0)) | ((u >= bounds[:, 1] - near) & (gradient < 0))
        )
        promise = _promise(gradient[free], curvature[np.ix_(free, free)])
        message = ""
        costs_before.append(cost)
        gained = max(costs_before[-STALLED - 1 :]) - cost
        stalled = len(costs_before) > STALLED and gained < 0.1 * settled
        if stalled and promise >= tolerance:
            message = f"{STALLED} steps lowered chi-square by {gained:.2g}, though {promise:.2g} was promised"
        elif promise >= tolerance:
            # several lengths of damping at once: they are one batch of scenes
            tries = damping * np.array(ladder)
            moves = np.array([_move(u, gradient, curvature, free, d, bounds) for d in tries])
            costs = problem.costs(moves)
            best = int(costs.argmin())
            if costs[best] < cost - 0.1 * tolerance:
                damping = max(1e-6, tries[best] if best else damping / 30.0)
                u = moves[best]
                continue
            message = f"no step lowers chi-square, though {promise:.2g} was promised"
        done = promise < settled
        moved = u - taken
        fresh = bool((np.abs(moved) <= NEAR * problem.parametrisation.spread).all())
        fresh = fresh and float(moved @ curvature @ moved) <= NEARER**2
        if fresh or not done or not problem.linearise(u):
            return Polished(
                u=u,
                cost=cost,
                residuals=residuals,
                jacobian=jacobian,
                converged=done,
                message="" if done else message,
                steps=step,
            )
        taken = u
    residuals, jacobian = _linearised(problem, u, difference)
    return Polished(
        u=u,
        cost=float(residuals @ residuals),
        residuals=residuals,
        jacobian=jacobian,
        converged=False,
        message=f"not converged in {max_steps} steps",
        steps=max_steps,
    )


def _linearised(problem: Problem, u: Array, difference: float) -> tuple[Array, Array]:
    n = len(u)
    bounds = problem.parametrisation.bounds
    steps = difference * problem.parametrisation.spread
    high = np.minimum(u + steps, bounds[:, 1])
    low = np.maximum(u - steps, bounds[:, 0])
    # where a neighbour outside the law's domain or without equilibrium has no answer, its side is left out
    population = np.vstack([u, u + np.diag(high - u), u + np.diag(low - u)])
    rows = problem.residuals(population)
    if not np.isfinite(rows[0]).all():
        raise ValueError("no equilibrium at a point of the polish")
    jacobian = np.empty((rows.shape[1], n))
    for i in range(n):
        up, down = rows[1 + i], rows[1 + n + i]
        a, b = (high[i], up) if np.isfinite(up).all() else (u[i], rows[0])
        c, d = (low[i], down) if np.isfinite(down).all() else (u[i], rows[0])
        if a == c:
            raise ValueError(
                f"no derivative by {problem.parametrisation.names[i]}: neither side has an answer"
            )
        jacobian[:, i] = (b - d) / (a - c)
    return rows[0], jacobian


def _promise(gradient: Array, curvature: Array) -> float:
    """Chi-square that a full Gauss-Newton step would gain, by the quadratic model."""
    if not len(gradient):
        return 0.0
    return float(gradient @ np.linalg.lstsq(curvature, gradient, rcond=1e-12)[0])


def _move(
    u: Array, gradient: Array, curvature: Array, free: NDArray[np.bool_], damping: float, bounds: Array
) -> Array:
    move = np.zeros_like(u)
    inner = curvature[np.ix_(free, free)]
    scale = damping * np.diag(np.diag(inner)) + 1e-12 * np.trace(inner) * np.eye(len(inner))
    move[free] = -np.linalg.solve(inner + scale, gradient[free])
    return np.clip(u + move, bounds[:, 0], bounds[:, 1])
