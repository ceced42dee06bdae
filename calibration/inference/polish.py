"""Polish from where CMA-ES ended: SciPy's bounded least squares, each linearisation one batch of scenes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, lsq_linear

from calibration.inference.problem import Problem

Array = NDArray[np.float64]

STALLED = 10  # steps that together may gain less than a tenth of what counts as settled, before it ends
AT_BOUND = 1e-3  # of its range: so near to a bound, a coordinate that is pushed there counts as being there
LEAST = 1e-9  # room of a coordinate at its bound: the linear problem takes no empty interval
SHORTEST = 1e-5  # relative length of a step below which no step is said to lower chi-square


@dataclass(frozen=True, eq=False, kw_only=True)
class Polished:
    """Result of a polish.

    Attributes
    ----------
    u : array, shape (n,)
    cost : float
    residuals, jacobian : array, shape (m,), (m, n)
        Whitened residuals and their Jacobian at u, the prior's rows last.
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
    max_steps: int = 80,
    tolerance: float = 0.002,
    settled: float = 0.4,
    difference: float = 0.1,
) -> Polished:
    """Minimise the problem's cost by Gauss-Newton steps in a trust region within the bounds.

    The method is SciPy's `trf` (M. A. Branch, T. F. Coleman and Y. Li, SIAM J. Sci. Comput. 21, 1999).

    Nuisances are taken at the start, and again at the end point. A coordinate at its bound stays there while
    the cost falls beyond it. Along a valley without an end (terms that are too much alike) steps gain next to
    nothing: after `STALLED` of them it ends, not converged.

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
        Step of the central differences, in each coordinate's spread; the error of smaller ones is dominated
        by the solver's tolerance.

    Raises
    ------
    ValueError
        The start, or a point on the way, has no equilibrium.
    """
    bounds = problem.parametrisation.bounds
    u = np.clip(np.asarray(start, dtype=float), bounds[:, 0], bounds[:, 1])
    if not problem.linearise(u):
        raise ValueError("no equilibrium at the start of the polish")
    steps = 0
    while True:
        way = _Descent(problem, max_steps - steps, tolerance, 0.1 * settled, difference)
        message = way.go(u)
        steps += way.steps
        moved, u = not np.array_equal(way.u, u), way.u
        if not moved or steps >= max_steps or way.promise >= settled or not problem.linearise(u):
            break
    done = way.promise < settled
    return Polished(
        u=u,
        cost=way.cost,
        residuals=way.residuals,
        jacobian=way.jacobian,
        converged=done,
        message="" if done else message,
        steps=steps,
    )


class _EndedError(Exception):
    """The descent has come to its end, for the reason that it says; none where it is settled."""


class _Descent:
    """A descent from a point.

    Attributes
    ----------
    u, residuals, jacobian : where it is.
    promise : chi-square that a full step would gain by the quadratic model.
    """

    def __init__(self, problem: Problem, most: int, tolerance: float, little: float, difference: float):
        self._problem, self._bounds = problem, problem.parametrisation.bounds
        self._most, self._tolerance, self._little = most, tolerance, little
        self._steps = difference * problem.parametrisation.spread
        self._costs: list[float] = []
        self._seen: tuple[Array, Array] = (np.empty(0), np.empty(0))  # the last point, and its residuals
        self.u: Array = np.empty(0)
        self.residuals: Array = np.empty(0)
        self.jacobian: Array = np.empty((0, 0))
        self.promise = np.inf

    @property
    def steps(self) -> int:
        """Number of linearisations."""
        return len(self._costs)

    @property
    def cost(self) -> float:
        return self._costs[-1]

    def go(self, start: Array) -> str:
        """Go from start (n,) as far as it goes; why it ended, empty where it is settled."""
        try:
            self._jacobian(start)
            least_squares(
                self._residuals,
                start,
                jac=self._jacobian,
                bounds=(self._bounds[:, 0], self._bounds[:, 1]),
                x_scale=self._problem.parametrisation.spread,
                ftol=1e-12,
                xtol=SHORTEST,
                gtol=1e-12,
            )
        except _EndedError as end:
            return str(end)
        predicted = f"although the linearised model predicts a decrease of {self.promise:.2g}"
        return f"no step lowers chi-square, {predicted}"

    def _residuals(self, u: Array) -> Array:
        if not np.array_equal(u, self._seen[0]):
            self._seen = u.copy(), self._problem.residuals(u[None])[0]
        return self._seen[1]

    def _jacobian(self, u: Array) -> Array:
        """Jacobian (m, n) at an accepted point; _EndedError where the descent ends there."""
        if np.array_equal(u, self.u):
            return self.jacobian
        residuals = self._residuals(u)
        if not np.isfinite(residuals).all():
            raise ValueError("no equilibrium at a point of the polish")
        jacobian = self._differences(u, residuals)
        self.u, self.residuals, self.jacobian = u.copy(), residuals, jacobian
        self.promise = self._promise()
        self._costs.append(float(residuals @ residuals))
        if self.promise < self._tolerance:
            raise _EndedError
        gained = max(self._costs[-STALLED - 1 :]) - self.cost
        if self.steps > STALLED and gained < self._little:
            raise _EndedError(
                f"{STALLED} steps lowered chi-square by {gained:.2g} in all, although the linearised model"
                f" predicts a decrease of {self.promise:.2g}"
            )
        if self.steps >= self._most:
            raise _EndedError(f"not converged in {self._most} steps")
        return jacobian

    def _promise(self) -> float:
        """Chi-square that the best step within the bounds would gain, by the quadratic model."""
        room = self._bounds - self.u[:, None]
        step = lsq_linear(
            self.jacobian,
            -self.residuals,
            bounds=(np.minimum(room[:, 0], -LEAST), np.maximum(room[:, 1], LEAST)),
        ).x
        left = self.residuals + self.jacobian @ step
        return float(self.residuals @ self.residuals - left @ left)

    def _differences(self, u: Array, residuals: Array) -> Array:
        """Jacobian (m, n) by central differences, one batch of scenes; where a neighbour outside the law's
        domain or without equilibrium has no answer, its side is left out."""
        n = len(u)
        high = np.minimum(u + self._steps, self._bounds[:, 1])
        low = np.maximum(u - self._steps, self._bounds[:, 0])
        rows = self._problem.residuals(np.vstack([u + np.diag(high - u), u + np.diag(low - u)]))
        jacobian = np.empty((rows.shape[1], n))
        for i in range(n):
            up, down = rows[i], rows[n + i]
            a, b = (high[i], up) if np.isfinite(up).all() else (u[i], residuals)
            c, d = (low[i], down) if np.isfinite(down).all() else (u[i], residuals)
            if a == c:
                raise ValueError(
                    f"no derivative by {self._problem.parametrisation.names[i]}: neither side has an answer"
                )
            jacobian[:, i] = (b - d) / (a - c)
        return jacobian
