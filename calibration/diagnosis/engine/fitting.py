"""Gauss-Newton fit of the baseline's coordinates and effects' amplitudes with the full simulator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import Linearisation, State

Array = NDArray[np.float64]

TOLERANCE = 0.05  # of chi-square: a twentieth of its change by one standard deviation of one parameter
AS_FITTED = 0.002  # tolerance of a calibration, for reported moduli: 0.04 of a standard deviation
LONGEST = 0.7  # largest step of a coordinate u; coordinates are logarithms of moduli
# Levenberg's damping if a plain step fails, relative to the squared length of a column: with nearly dependent
# coordinates (terms of a series law) the plain step leaves the range in which the derivatives are valid
DAMPINGS = (1e-4, 1e-3, 1e-2, 1e-1, 1.0)
FALLING = 0.1  # a step that lowers chi-square by a larger fraction does not count towards `max_steps`
MOST = 5  # largest number of steps, relative to `max_steps`


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """A least-squares fit.

    Attributes
    ----------
    linear : whitened residuals and their derivatives at the final state.
    converged : True if the convergence criterion was met.
    message : reason if it was not; "" otherwise.
    """

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
        """Derivatives of z by u, then by the amplitudes, shape (m, n + c)."""
        return np.column_stack([self.linear.by_u, self.linear.columns])

    def covariance(self) -> Array:
        """Covariance of u and the amplitudes, shape (n + c, n + c)."""
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
    model: MeasurementModel,
    start: State,
    candidates: Sequence[Candidate] = (),
    *,
    max_steps: int = 10,
    tolerance: float = TOLERANCE,
) -> Fit:
    """Minimise chi-square z @ z over u and the amplitudes of `candidates`, starting at `start`.

    A step that does not lower chi-square is halved up to 5 times, then replaced by damped steps. The fit has
    converged if the predicted reduction of a step is below `tolerance`, or if no shortened step lowers
    chi-square and the predicted reduction is below 20 `TOLERANCE`. Only steps that reduce chi-square by less
    than a tenth count towards `max_steps`.

    Raises
    ------
    ValueError : the simulator has no solution at the start.
    """
    wanted = tuple(candidates)
    state = _inside(model, np.r_[start.u, [start.amplitudes.get(c, 0.0) for c in wanted]], wanted)
    linear = model.linearise(state, wanted)
    slow = taken = 0
    while slow < max_steps and taken < MOST * max_steps:
        jacobian = np.column_stack([linear.by_u, linear.columns])
        move, promise = _step(model, linear, jacobian, wanted)
        if promise < tolerance:
            return Fit(linear=linear, converged=True)
        now = float(linear.z @ linear.z)
        found = _shortened(model, state, move, wanted, now - 0.1 * tolerance)
        if found is None and promise < 20.0 * TOLERANCE:
            return Fit(linear=linear, converged=True)
        if found is None:
            found = _damped(model, linear, jacobian, wanted)
        if found is None:
            return Fit(
                linear=linear,
                converged=False,
                message=(
                    "no step lowers chi-square, although the linearised model predicts a decrease of"
                    f" {promise:.2g}"
                ),
            )
        state = found
        linear = model.linearise(state, wanted)
        taken += 1
        slow += float(linear.z @ linear.z) > (1.0 - FALLING) * now
    return Fit(linear=linear, converged=False, message=f"not converged in {taken} steps")


def _step(
    model: MeasurementModel,
    linear: Linearisation,
    jacobian: Array,
    wanted: tuple[Candidate, ...],
    damping: float = 0.0,
) -> tuple[Array, float]:
    """Gauss-Newton step, limited to `LONGEST`, and the reduction of chi-square predicted for the full step.

    Parameters at a bound that the step would push beyond it are held, and so are amplitudes of switches.
    """
    n = len(linear.state.u)
    low, high = _bounds(model, wanted)
    here, gradient = _point(linear.state, wanted), jacobian.T @ linear.z
    free = ~((here <= low) & (gradient > 0.0)) & ~((here >= high) & (gradient < 0.0))
    free[n:] &= ~np.array([model.effects[c.effect].switch for c in wanted], dtype=bool)
    for _ in range(len(free) + 1):
        move = np.zeros(jacobian.shape[1])
        # columns differ by orders of magnitude in scale: bring them to one before the rank is judged
        size = np.linalg.norm(jacobian[:, free], axis=0)
        size[size == 0.0] = 1.0
        move[free] = -_least_squares(jacobian[:, free] / size, linear.z, damping) / size
        # the step may lead beyond a bound though the gradient does not
        blocked = ((here <= low) & (move < 0.0)) | ((here >= high) & (move > 0.0))
        if not blocked.any():
            break
        free &= ~blocked
    promise = float(linear.z @ linear.z - np.sum((linear.z + jacobian @ move) ** 2))
    largest = np.abs(move[:n]).max(initial=0.0)
    return move * min(1.0, LONGEST / largest if largest > 0 else 1.0), promise


def _least_squares(columns: Array, z: Array, damping: float) -> Array:
    """Coefficients (n,) of unit-length columns (m, n) fitted to z (m,), with Tikhonov damping if not 0."""
    if damping == 0.0:
        return np.asarray(np.linalg.lstsq(columns, z, rcond=1e-6)[0])
    rows = np.sqrt(damping) * np.eye(columns.shape[1])
    return np.asarray(
        np.linalg.lstsq(np.vstack([columns, rows]), np.r_[z, np.zeros(len(rows))], rcond=None)[0]
    )


def _point(state: State, wanted: tuple[Candidate, ...]) -> Array:
    """Coordinates u followed by the amplitudes, shape (n + c,)."""
    return np.concatenate([state.u, [state.amplitudes[c] for c in wanted]])


def _bounds(model: MeasurementModel, wanted: tuple[Candidate, ...]) -> tuple[Array, Array]:
    """Lower and upper bounds of u, then of the amplitudes, shape (n + c,) each.

    Upper bounds of u are reduced by `coordinate_step`, so that a forward difference stays within the bounds.
    """
    own = [model.effects[c.effect].bounds for c in wanted]
    low, high = np.vstack([model.baseline.bounds, np.reshape(own, (-1, 2))]).T
    high[: len(model.baseline.bounds)] -= model.coordinate_step
    return low, high


def _damped(
    model: MeasurementModel, linear: Linearisation, jacobian: Array, wanted: tuple[Candidate, ...]
) -> State | None:
    """State after the first damped step that lowers chi-square by more than 0.1 `TOLERANCE`.

    None if none does, or if the predicted reduction falls below `TOLERANCE`.
    """
    now = float(linear.z @ linear.z)
    for damping in DAMPINGS:
        move, promise = _step(model, linear, jacobian, wanted, damping)
        if promise < TOLERANCE:
            return None
        found = _moved(model, linear.state, move, wanted, 1.0)
        z = model.residuals([found])[0]
        if float(z @ z) < now - 0.1 * TOLERANCE:
            return found
    return None


def _moved(
    model: MeasurementModel, state: State, move: Array, wanted: tuple[Candidate, ...], part: float
) -> State:
    return _inside(model, _point(state, wanted) + part * move, wanted)


def _shortened(
    model: MeasurementModel, state: State, move: Array, wanted: tuple[Candidate, ...], below: float
) -> State | None:
    """State after the largest of the fractions 1, 1/2, ..., 1/32 of the step with chi-square < `below`.

    None if there is none.
    """
    for part in 0.5 ** np.arange(6):
        trial = _moved(model, state, move, wanted, part)
        z = model.residuals([trial])[0]
        cost = float(z @ z)
        if np.isfinite(cost) and cost < below:
            return trial
    return None


def _inside(model: MeasurementModel, point: Array, wanted: tuple[Candidate, ...]) -> State:
    """State of coordinates u and amplitudes (`_point`), clipped to their bounds."""
    found = np.clip(point, *_bounds(model, wanted))
    n = len(found) - len(wanted)
    return State(u=found[:n], amplitudes=dict(zip(wanted, found[n:].tolist(), strict=True)))
