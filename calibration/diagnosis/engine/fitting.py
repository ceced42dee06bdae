"""Gauss-Newton over the baseline's coordinates and some effects' amplitudes, in the simulator itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import Linearisation, State

Array = NDArray[np.float64]

TOLERANCE = 0.05  # of chi-square: a twentieth of what one standard deviation of one parameter makes
LONGEST = 0.7  # of a coordinate u in one step; coordinates are logarithms of moduli


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """A state that minimises the squared sum of z, with its derivatives there; converged: or not, and why."""

    linear: Linearisation
    converged: bool
    message: str = ""

    @property
    def state(self) -> State:
        return self.linear.state

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        return self.linear.candidates

    @property
    def z(self) -> Array:
        return self.linear.z

    @property
    def chi2(self) -> float:
        return float(self.linear.z @ self.linear.z)

    @property
    def jacobian(self) -> Array:
        """(m, n + c): by u, then by the amplitudes."""
        return np.column_stack([self.linear.by_u, self.linear.columns])

    def covariance(self) -> Array:
        """Of u and the amplitudes, (n + c, n + c)."""
        size = np.linalg.norm(self.jacobian, axis=0)
        size[size == 0.0] = 1.0  # columns differ by orders of magnitude: one scale before the rank is judged
        scaled = self.jacobian / size
        return np.asarray(np.linalg.pinv(scaled.T @ scaled, hermitian=True) / np.outer(size, size))

    def amplitude(self, candidate: Candidate) -> tuple[float, float]:
        """Value and standard deviation [SI]."""
        n = len(self.state.u) + self.candidates.index(candidate)
        return self.state.amplitudes[candidate], float(np.sqrt(self.covariance()[n, n]))

    @property
    def label(self) -> str:
        return " + ".join(c.label for c in self.candidates) or "baseline"


def fit(
    model: MeasurementModel, start: State, candidates: Sequence[Candidate] = (), *, max_steps: int = 10
) -> Fit:
    """Minimise the squared sum of residuals over u and the amplitudes of `candidates`, from `start`.

    A step that does not lower it is shortened, up to 6 times. ValueError where the start has no answer.
    """
    wanted = tuple(candidates)
    state = _clipped(model, start.u, [start.amplitudes.get(c, 0.0) for c in wanted], wanted)
    linear = model.linearise(state, wanted)
    for _ in range(max_steps):
        jacobian = np.column_stack([linear.by_u, linear.columns])
        move, promise = _step(model, linear, jacobian, wanted)
        if promise < TOLERANCE:
            return Fit(linear=linear, converged=True)
        now = float(linear.z @ linear.z)
        found = _shortened(model, state, move, wanted, now)
        if found is None:
            if promise < 20.0 * TOLERANCE:
                return Fit(linear=linear, converged=True)
            return Fit(
                linear=linear,
                converged=False,
                message=f"no step lowers chi-square, though {promise:.2g} was promised",
            )
        state = found
        linear = model.linearise(state, wanted)
    return Fit(linear=linear, converged=False, message=f"not converged in {max_steps} steps")


def _step(
    model: MeasurementModel, linear: Linearisation, jacobian: Array, wanted: tuple[Candidate, ...]
) -> tuple[Array, float]:
    """Gauss-Newton step and what it promises; amplitudes at a bound that are pushed beyond it stay."""
    n = len(linear.state.u)
    free = np.ones(jacobian.shape[1], dtype=bool)
    gradient = jacobian.T @ linear.z
    for k, c in enumerate(wanted):
        effect, a = model.effects[c.effect], linear.state.amplitudes[c]
        low, high = effect.bounds
        pushed = (a <= low and gradient[n + k] > 0) or (a >= high and gradient[n + k] < 0)
        free[n + k] = not (effect.switch or pushed)
    for _ in range(len(wanted) + 1):
        move = np.zeros(jacobian.shape[1])
        # columns differ by orders of magnitude in scale: bring them to one before the rank is judged
        size = np.linalg.norm(jacobian[:, free], axis=0)
        size[size == 0.0] = 1.0
        move[free] = -np.linalg.lstsq(jacobian[:, free] / size, linear.z, rcond=1e-6)[0] / size
        # the step may lead beyond a bound though the gradient does not
        blocked = _beyond(model, linear, move, wanted)
        if not blocked.any():
            break
        free &= ~blocked
    promise = float(linear.z @ linear.z - np.sum((linear.z + jacobian @ move) ** 2))
    largest = np.abs(move[:n]).max(initial=0.0)
    return move * min(1.0, LONGEST / largest if largest > 0 else 1.0), promise


def _beyond(
    model: MeasurementModel, linear: Linearisation, move: Array, wanted: tuple[Candidate, ...]
) -> NDArray[np.bool_]:
    """Coordinates at a bound that a step would take beyond it."""
    found = np.zeros(move.size, dtype=bool)
    for k, c in enumerate(wanted, start=len(linear.state.u)):
        low, high = model.effects[c.effect].bounds
        a = linear.state.amplitudes[c]
        found[k] = (a <= low and move[k] < 0.0) or (a >= high and move[k] > 0.0)
    return found


def _shortened(
    model: MeasurementModel, state: State, move: Array, wanted: tuple[Candidate, ...], now: float
) -> State | None:
    n = len(state.u)
    for part in 0.5 ** np.arange(6):
        amplitudes = [state.amplitudes[c] + part * move[n + k] for k, c in enumerate(wanted)]
        trial = _clipped(model, state.u + part * move[:n], amplitudes, wanted)
        z = model.residuals([trial])[0]
        cost = float(z @ z)
        if np.isfinite(cost) and cost < now - 0.1 * TOLERANCE:
            return trial
    return None


def _clipped(
    model: MeasurementModel, u: Array, amplitudes: Sequence[float], wanted: tuple[Candidate, ...]
) -> State:
    inside = {
        c: float(np.clip(a, *model.effects[c.effect].bounds)) for c, a in zip(wanted, amplitudes, strict=True)
    }
    return State(u=np.asarray(u, dtype=float), amplitudes=inside)
