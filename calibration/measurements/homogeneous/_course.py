"""The course of a homogeneous test as it was measured: stretch against time, ramps and holds.

A material that remembers is followed along the record, in straight lines from row to row; of long records the
stress is averaged over the same rows as the measured one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponMode, CouponTrial
from calibration.measurements._records import Stroke, bins, holds
from calibration.measurements.homogeneous.kinematics import first_excess
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

STEP = 0.01  # of stretch at most in one straight line: the stress is taken to be linear in time along it
STILL = 0.01  # fraction of the record's range within which a hold stays
NOISE = 6.0  # standard deviations of the stretch that are no motion
NEAR = 25  # rows to either side that the stretch of a hold is averaged over
BEGINNING = 4  # rows by which the speed of a first ramp is known
DIFFERENT = 1.1  # ratio of largest strains (I1 - 3) that count as two


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """What drives a record, from rest at its first time on.

    Attributes
    ----------
    time, stretch : shape (f,); rows of the record and points between them. Time is 0 throughout where the lab
        has no clock.
    owner : which of the record's points each belongs to, shape (f,).
    rows : where the rows of the record are among them, shape (rows,).
    first, count : first row of each point and how many it is the mean of, shape (k,).
    kept : of the k points, those that the record still has.
    before : stretch furthest from rest in earlier tests of the specimen; 1 without.
    pushes : what drives it are platens, which push and do not pull.
    """

    time: Array
    stretch: Array
    owner: Rows
    rows: Rows
    first: Rows
    count: Array
    kept: Rows
    before: float
    pushes: bool = False

    def means(self, values: Array) -> Array:
        """Means of values (f,) over the rows of each point that is kept."""
        return np.asarray((np.add.reduceat(values[self.rows], self.first) / self.count)[self.kept])

    def moved(self, shift: Array) -> Array:
        """Stretches (f,) with the points that are kept shifted."""
        if not shift.any():
            return self.stretch
        whole = np.zeros(len(self.first))
        whole[self.kept] = shift
        return np.asarray(self.stretch + whole[self.owner])

    def only(self, kept: NDArray[np.bool_]) -> Course:
        """Of the points that are kept, some."""
        return replace(self, kept=self.kept[kept])


def course_of(trial: CouponTrial, first: Rows, count: Array, before: float, holds: Sequence[slice]) -> Course:
    """first, count : rows of each point."""
    time = np.zeros(trial.stretch.size) if trial.time is None else trial.time - trial.time[0]
    stretch = _quiet(trial.stretch, holds)
    lead = _lead(time, stretch)
    corners = np.concatenate([[1.0] * len(lead), stretch])
    pieces = np.maximum(1, np.ceil(np.abs(np.diff(corners)) / STEP)).astype(int)
    knots = np.concatenate([[0], np.cumsum(pieces)])
    rows = knots[len(lead) :]
    at = np.arange(knots[-1] + 1)
    row_owner = np.repeat(np.arange(len(first)), count.astype(int))
    return Course(
        time=np.interp(at, knots, np.concatenate([lead, time])),
        stretch=np.interp(at, knots, corners),
        owner=row_owner[np.searchsorted(rows, at)],
        rows=rows,
        first=first,
        count=count,
        kept=np.arange(len(first)),
        before=before,
    )


def _quiet(stretch: Array, holds: Sequence[slice]) -> Array:
    """Stretch with the means of up to 2 NEAR + 1 rows about each row of a hold: its noise would be taken for
    new largest strains, and soften the specimen beside itself."""
    found, sums = stretch.copy(), np.concatenate([[0.0], np.cumsum(stretch - 1.0)])
    for h in holds:
        i = np.arange(h.start, h.stop)
        half = np.minimum(np.minimum(i - h.start, h.stop - 1 - i), NEAR)
        found[h] = 1.0 + (sums[i + half + 1] - sums[i - half]) / (2 * half + 1)
    return found


def _lead(time: Array, stretch: Array) -> Array:
    """When the test began [s], shape (1,), where its first row is a little way along its first ramp (rows may
    be means of several samples); none where it begins at rest, or with a jump."""
    last = min(BEGINNING, stretch.size - 1)
    gone, made = stretch[0] - 1.0, stretch[last] - stretch[0]
    if gone * made <= 0.0 or time[last] <= time[0] or gone / made > 1.0:
        return np.zeros(0)
    return np.array([time[0] - (time[last] - time[0]) * gone / made])


def holds_of(trial: CouponTrial) -> list[slice]:
    """Rows of each hold: the stretch stays where it is for longer than motion beside it would take."""
    if trial.time is None:
        return []
    tolerance = max(STILL * float(np.ptp(trial.stretch)), NOISE * trial.stretch_sd)
    return holds(trial.time, trial.stretch, tolerance)


def window_of(trials: Sequence[CouponTrial], branches: Sequence[Sequence[Stroke]]) -> ProtocolWindow:
    """What tests show of a material's parts; branches : of each trial."""
    ramps, waits, lengths, peaks = [], [], [], []
    for trial, strokes in zip(trials, branches, strict=True):
        excess = first_excess(trial.mode, trial.stretch)
        for a, b in pairwise(strokes):
            if excess[b.points.start] > max(excess[a.points.start], excess[b.points.stop - 1]):
                peaks.append(float(excess[b.points.start]))
        if trial.time is None:
            continue
        lengths.append(float(trial.time[-1] - trial.time[0]))
        rests = holds_of(trial)
        waits += [float(trial.time[h.stop - 1] - trial.time[h.start]) for h in rests]
        corners = {0, trial.stretch.size - 1, *(s.points.start for s in strokes[1:])}
        corners |= {i for h in rests for i in (h.start, h.stop - 1)}
        still = {(h.start, h.stop - 1) for h in rests}
        inside = sorted(c for c in corners if not any(h.start < c < h.stop - 1 for h in rests))
        ramps += [float(trial.time[b] - trial.time[a]) for a, b in pairwise(inside) if (a, b) not in still]
    different = 0
    for k, peak in enumerate(sorted(peaks)):
        different += k == 0 or peak > DIFFERENT * sorted(peaks)[k - 1]
    last = max(waits or lengths, default=0.0)
    first = min([r for r in ramps if r > 0.0], default=last)
    return ProtocolWindow(first=min(first, last), last=last, peaks=different)


def bins_over_time(
    trial: CouponTrial, points: slice, holds: Sequence[slice], most: int
) -> tuple[Rows, Array]:
    """As `bins`, each ramp and each hold by itself; those of a hold grow with the time since it began."""
    assert trial.time is not None
    corners = {points.start, points.stop}
    corners |= {i for h in holds for i in (h.start, h.stop) if points.start < i < points.stop}
    firsts = []
    for a, b in pairwise(sorted(corners)):
        held = any(h.start <= a and b <= h.stop for h in holds)
        if not held or b - a <= most:
            firsts.append(a + bins(slice(a, b), most)[0])
            continue
        since = trial.time[a:b] - trial.time[a]
        scale = np.log1p(since / since[1])
        number = np.floor(most * scale / scale[-1])
        firsts.append(a + np.flatnonzero(np.diff(number, prepend=-1.0)))
    first = np.concatenate(firsts) - points.start
    return first, np.diff(np.append(first, points.stop - points.start)).astype(float)


def largest_before(mode: CouponMode, stretch: Array, before: float) -> float:
    """The stretch furthest from rest so far."""
    whole = np.append(stretch, before)
    return float(whole[int(np.argmax(first_excess(mode, whole)))])
