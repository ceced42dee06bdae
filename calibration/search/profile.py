"""Intervals by the likelihood itself, where a parameter's bar is too wide for linear error propagation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.search.identify import PRIOR_SHARE, Estimate, Identification, yardstick
from calibration.search.polish import Polished
from calibration.search.problem import Problem

Array = NDArray[np.float64]

RISE = 1.96  # root of what chi-square rises by from the best point to the end of a 95 % interval
ROUNDS = 8
LINEAR = 0.03  # of a parameter: an sd below this is propagated linearly
CLOSE = 0.1  # an end whose rise is so near to RISE stands


def profile(problem: Problem, end: Polished, known: Identification) -> tuple[Estimate, ...]:
    """The estimates with their intervals ending where chi-square, minimised over all other coordinates, has
    risen by 3.84 (S. S. Wilks, Ann. Math. Stat. 9, 1938); `sd` and `seen` stay those of linear theory.

    Left as they are: all of them where every coordinate's sd is under 3 % (there the linear interval serves),
    those of a coordinate that its prior decides, and an end that no point with an answer leads to. The others
    are taken along by simplified Newton steps with the Jacobian of `end`; each round is two batches of at
    most two candidates a coordinate.
    """
    wanted = [i for i in range(len(end.u)) if not _by_prior(problem, known, i)]
    if all(known.estimates[i].sd < LINEAR * yardstick(problem.parametrisation, i, end.u[i]) for i in wanted):
        return known.estimates
    ends = [_End(problem, end, known, i, side) for i in wanted for side in (-1, 1)]
    for _ in range(ROUNDS):
        open_ends = [e for e in ends if not e.done]
        if not open_ends:
            break
        first = np.array([e.point() for e in open_ends])
        rows = problem.residuals(first)
        second = np.array([e.taken_along(v, r) for e, v, r in zip(open_ends, first, rows, strict=True)])
        better = problem.residuals(second)
        for k, e in enumerate(open_ends):
            e.learn([(first[k], rows[k]), (second[k], better[k])])
    found = list(known.estimates)
    for i in wanted:
        low, high = (e.reached() for e in ends if e.i == i)
        value = problem.parametrisation.coordinates[i].value
        found[i] = replace(found[i], low=value(low), high=value(high))
    return tuple(found)


class _End:
    """One end of one coordinate's interval: `reach` is the distance from the best point that is tried next,
    `course` what all coordinates move by for each unit of it."""

    def __init__(self, problem: Problem, end: Polished, known: Identification, i: int, side: int) -> None:
        self.end, self.i, self.side = end, i, side
        self.bounds = problem.parametrisation.bounds
        _, sd = problem.parametrisation.prior()
        self.priors = int(np.isfinite(sd).sum())  # rows of the residuals, the last ones
        self.scale = known.scale
        self.room = abs(self.bounds[i, (1 + side) // 2] - end.u[i])
        covariance = known.covariance
        self.course = side * covariance[:, i] / covariance[i, i]
        self.reach = min(self.room, RISE * float(np.sqrt(covariance[i, i])))
        self.linear = self.reach
        # reach and rise where chi-square has risen too little, and too much (inf: no answer)
        self.inside, self.outside = (0.0, 0.0), (np.inf, np.inf)
        self.done = self.room == 0.0
        self.best = self._chi2(end.residuals)

    def point(self) -> Array:
        return self._held(self.end.u + self.reach * self.course)

    def taken_along(self, point: Array, residuals: Array) -> Array:
        """The point with all other coordinates moved to where the linearised chi-square is least."""
        if not np.isfinite(residuals).all():
            return point
        others = [k for k in range(len(point)) if k != self.i]
        J = self.end.jacobian[:, others] * self._weights(len(residuals))[:, None]
        span = self.bounds[others, 1] - self.bounds[others, 0]
        curvature = J.T @ J + np.diag(1e-6 * span**-2.0)
        moved = point.copy()
        moved[others] -= np.linalg.solve(curvature, J.T @ (residuals * self._weights(len(residuals))))
        return self._held(moved)

    def learn(self, tried: list[tuple[Array, Array]]) -> None:
        """Where to try next, from (point, residuals) of this round."""
        known = [(self._chi2(rows), v) for v, rows in tried if np.isfinite(rows).all()]
        rise = np.inf
        if known:
            chi2, v = min(known, key=lambda pair: pair[0])
            rise = float(np.sqrt(max(chi2 - self.best, 0.0)))
            self.course = (v - self.end.u) / self.reach
        width = self.outside[0] - self.inside[0]
        if rise < RISE:
            self.inside = (self.reach, rise)
        else:
            self.outside = (self.reach, rise)
        if abs(rise - RISE) < CLOSE or (rise < RISE and self.reach >= self.room):
            self.done = True
            return
        (near, low), (far, high) = self.inside, self.outside
        if not np.isfinite(far):
            self.reach = min(self.room, near * min(4.0, RISE / max(low, 1e-9)))
        elif not np.isfinite(high) or far - near > 0.5 * width:
            self.reach = 0.5 * (near + far)
        else:
            self.reach = near + (far - near) * (RISE - low) / (high - low)

    def reached(self) -> float:
        (near, _), (far, high) = self.inside, self.outside
        if self.done:
            reach = self.reach
        elif near == 0.0 and not np.isfinite(high):
            reach = self.linear
        else:  # rounds ran out: the far end of what is left, which is wider rather than narrower
            reach = min(far, self.room)
        return float(np.clip(self.end.u[self.i] + self.side * reach, *self.bounds[self.i]))

    def _held(self, v: Array) -> Array:
        """Within the bounds, coordinate i where it was asked for."""
        v = np.clip(v, self.bounds[:, 0], self.bounds[:, 1])
        v[self.i] = np.clip(self.end.u[self.i] + self.side * self.reach, *self.bounds[self.i])
        return np.asarray(v)

    def _weights(self, rows: int) -> Array:
        w = np.full(rows, self.scale**-0.5)
        w[rows - self.priors :] = 1.0
        return w

    def _chi2(self, residuals: Array) -> float:
        r = residuals * self._weights(len(residuals))
        return float(r @ r)


def _by_prior(problem: Problem, known: Identification, i: int) -> bool:
    _, sd = problem.parametrisation.prior()
    return known.estimates[i].sd > PRIOR_SHARE * sd[i]
