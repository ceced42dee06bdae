"""Profile-likelihood intervals: where chi-square, minimised over all other coordinates, has risen enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.inference.polish import Polished
from calibration.inference.problem import Problem
from calibration.inference.uncertainty import PRIOR_SHARE, WIDTH, Estimate, Identification, yardstick

Array = NDArray[np.float64]

RISE = WIDTH  # root of what chi-square rises by from the best point to the end of a 95 % interval
ROUNDS = 8  # of an end, without those that it waits
AT_REST = 4  # rounds for the other coordinates to come to rest at one point
RESTLESS = 2  # points at which they do not, after which the linear end stands
LINEAR = 0.03  # of a parameter: an sd below this is propagated linearly
CLOSE = 0.05  # an end whose rise is so near to RISE stands
LEFT = 0.2  # chi-square that another step of the other coordinates may promise at an end


def profile(problem: Problem, end: Polished, known: Identification) -> tuple[Estimate, ...]:
    """The estimates with their intervals ending where chi-square, minimised over all other coordinates, has
    risen by 3.84 (S. S. Wilks, Ann. Math. Stat. 9, 1938); `sd` and `seen` stay those of linear theory.

    Where the other coordinates do not come to rest on the way to an end (in a valley that curves much, or
    along a bound), it is the linear one, or one farther away.

    Left as they are: all of them where every coordinate's sd is under 3 % (there the linear interval serves),
    those of a coordinate that its prior decides, and an end that no point with an answer leads to. The others
    are taken along by Newton steps with the Jacobian of `end`, updated by what each point shows (C. G.
    Broyden, Math. Comput. 19, 1965); each round is two batches of at most two candidates a coordinate.
    """
    wanted = [i for i in range(len(end.u)) if not _by_prior(problem, known, i)]
    if all(known.estimates[i].sd < LINEAR * yardstick(problem.parametrisation, i, end.u[i]) for i in wanted):
        return known.estimates
    ends = [_End(problem, end, known, i, side) for i in wanted for side in (-1, 1)]
    while open_ends := [e for e in ends if not e.done and e.rounds < ROUNDS]:
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
        self.span = np.sqrt(np.diag(known.covariance))
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
        self.jacobian = end.jacobian.copy()
        self.last = (end.u, end.residuals)  # point to which it belongs
        self.left = 0.0  # what another step of the others promises at the last point
        self.waited = self.restless = self.rounds = 0
        self.best = self._chi2(end.residuals)

    def point(self) -> Array:
        return self._held(self.end.u + self.reach * self.course)

    def taken_along(self, point: Array, residuals: Array) -> Array:
        """The point with all other coordinates moved to where the linearised chi-square is least."""
        if not np.isfinite(residuals).all():
            return point
        others, step, _ = self._step(residuals)
        moved = point.copy()
        moved[others] += step
        return self._held(moved)

    def _step(self, residuals: Array) -> tuple[list[int], Array, float]:
        """The other coordinates, their Newton step, and the chi-square that it promises to take away."""
        others = [k for k in range(len(self.end.u)) if k != self.i]
        J = self.jacobian[:, others] * self._weights(len(residuals))[:, None]
        span = self.bounds[others, 1] - self.bounds[others, 0]
        gradient = J.T @ (residuals * self._weights(len(residuals)))
        step = np.asarray(-np.linalg.solve(J.T @ J + np.diag(1e-6 * span**-2.0), gradient), dtype=float)
        return others, step, -float(gradient @ step)

    def learn(self, tried: list[tuple[Array, Array]]) -> None:
        """Next points to evaluate, from (point, residuals) of this round."""
        known = [(v, rows) for v, rows in tried if np.isfinite(rows).all()]
        rise = np.inf
        if known:
            for v, rows in known:
                self._update(v, rows)
            v, rows = min(known, key=lambda pair: self._chi2(pair[1]))
            rise = float(np.sqrt(max(self._chi2(rows) - self.best, 0.0)))
            self.left = self._step(rows)[2]
            self.course = (v - self.end.u) / self.reach
            if self.left > LEFT and rise > RISE - CLOSE:
                self.waited += 1
                if self.waited <= AT_REST:
                    return
                self.restless += 1
                if self.restless == RESTLESS:
                    self.reach, self.done = self.linear, True
                    return
        self.waited, self.rounds = 0, self.rounds + 1
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

    def _update(self, point: Array, residuals: Array) -> None:
        """Change the Jacobian so that it leads from the last point to this one."""
        before, rows = self.last
        step = (point - before) / self.span
        size = float(step @ step)
        if size > 0.0:
            error = residuals - rows - self.jacobian @ (point - before)
            self.jacobian += np.outer(error, step / self.span) / size
        self.last = point, residuals

    def reached(self) -> float:
        (near, _), (far, high) = self.inside, self.outside
        if self.done:
            reach = self.reach
        elif near == 0.0 and not np.isfinite(high):
            reach = self.linear
        else:  # rounds ran out: the far end of what is left, which is wider rather than narrower
            reach = min(far, self.room)
        if self.left > LEFT:
            reach = max(reach, self.linear)
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
