"""Loading history of a homogeneous test as measured: stretch against time, ramps and holds.

A history-dependent material is integrated along the record, with linear interpolation between rows; for long
records the computed stress is averaged over the same rows as the measured stress.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponMode, CouponTrial
from calibration.measurements._course import holds, ramp_start, unmoved, window_from
from calibration.measurements._records import Stroke, strokes
from calibration.measurements.homogeneous.kinematics import first_excess
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

STEP = 0.01  # largest change of stretch per step: the stress is taken as linear in time within it
NEAR = 25  # half width [rows] of the moving average of the stretch in a hold


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """Loading history of a record, from rest at its first time.

    Attributes
    ----------
    time, stretch : time [s] and stretch at the rows of the record and at points between them, shape (f,).
        Time is 0 throughout if the record has no clock.
    owner : index of the record's point to which each belongs, shape (f,).
    rows : indices of the record's rows among them, shape (rows,).
    first, count : first row of each of the k points, and number of rows that it is the mean of, shape (k,).
    kept : indices of the points that the record keeps.
    before : stretch of largest I1 - 3 in earlier tests of the specimen; 1 if there are none.
    pushes : True if it is driven by platens, which push but do not pull.
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
        """Means of values (f,) over the rows of each kept point."""
        return np.asarray((np.add.reduceat(values[self.rows], self.first) / self.count)[self.kept])

    def moved(self, shift: Array) -> Array:
        """Stretches (f,), shifted by `shift` at the kept points."""
        if not shift.any():
            return self.stretch
        whole = np.zeros(len(self.first))
        whole[self.kept] = shift
        return np.asarray(self.stretch + whole[self.owner])

    def only(self, kept: NDArray[np.bool_]) -> Course:
        """Copy with a subset of the kept points; `kept` is a mask over them."""
        return replace(self, kept=self.kept[kept])


def course_of(trial: CouponTrial, first: Rows, count: Array, before: float, holds: Sequence[slice]) -> Course:
    """Loading history of a trial.

    Parameters
    ----------
    trial : the trial.
    first, count : first row of each point of the record, and its number of rows.
    before : stretch of largest I1 - 3 in earlier tests of the specimen.
    holds : rows of each hold, in which the stretch is smoothed.
    """
    time = np.zeros(trial.stretch.size) if trial.time is None else trial.time - trial.time[0]
    stretch = _quiet(trial.stretch, holds)
    lead = _lead(time, stretch, holds, trial.stretch_sd)
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
    """Stretch with a moving average over up to 2 NEAR + 1 rows in each hold.

    Otherwise its noise would count as new peak strains and cause spurious softening.
    """
    found, sums = stretch.copy(), np.concatenate([[0.0], np.cumsum(stretch - 1.0)])
    for h in holds:
        i = np.arange(h.start, h.stop)
        half = np.minimum(np.minimum(i - h.start, h.stop - 1 - i), NEAR)
        found[h] = 1.0 + (sums[i + half + 1] - sums[i - half]) / (2 * half + 1)
    return found


def _lead(time: Array, stretch: Array, holds: Sequence[slice], sd: float) -> Array:
    """Extrapolated start of the first ramp [s], shape (1,); empty if the record begins at rest or by a jump.

    The first row can lie on the ramp, since rows may be means of several samples.
    """
    first = strokes(stretch, unmoved(float(np.abs(stretch - 1.0).max()), sd))[0]
    stop = min([first.points.stop, *(h.start for h in holds)])
    found = ramp_start(time, stretch - 1.0, stop, sd)
    return np.zeros(0) if found is None else np.array([found])


def holds_of(trial: CouponTrial) -> list[slice]:
    """Rows of each hold (`calibration.measurements._course.holds`); empty without a clock."""
    if trial.time is None:
        return []
    return holds(trial.time, trial.stretch, unmoved(float(np.ptp(trial.stretch)), trial.stretch_sd))


def window_of(trials: Sequence[CouponTrial], branches: Sequence[Sequence[Stroke]]) -> ProtocolWindow:
    """Range of times and number of different peak strains that tests cover.

    branches : strokes of each trial.
    """
    ramps, waits, lengths, peaks = [], [], [], []
    intervals: list[float] = []
    for trial, runs in zip(trials, branches, strict=True):
        excess = first_excess(trial.mode, trial.stretch)
        for a, b in pairwise(runs):
            if excess[b.points.start] > max(excess[a.points.start], excess[b.points.stop - 1]):
                peaks.append(float(excess[b.points.start]))
        if trial.time is None:
            continue
        lengths.append(float(trial.time[-1] - trial.time[0]))
        intervals += np.diff(trial.time).tolist()
        rests = holds_of(trial)
        waits += [float(trial.time[h.stop - 1] - trial.time[h.start]) for h in rests]
        corners = {0, trial.stretch.size - 1, *(s.points.start for s in runs[1:])}
        corners |= {i for h in rests for i in (h.start, h.stop - 1)}
        still = {(h.start, h.stop - 1) for h in rests}
        inside = sorted(c for c in corners if not any(h.start < c < h.stop - 1 for h in rests))
        least = unmoved(float(np.abs(trial.stretch - 1.0).max()), trial.stretch_sd)
        ramps += [
            float(trial.time[b] - trial.time[a])
            for a, b in pairwise(inside)
            if (a, b) not in still and abs(trial.stretch[b] - trial.stretch[a]) > least
        ]
    return window_from(ramps=ramps, waits=waits, lengths=lengths, intervals=intervals, peaks=peaks)


def largest_before(mode: CouponMode, stretch: Array, before: float) -> float:
    """Stretch of largest I1 - 3 among `stretch` and `before`."""
    whole = np.append(stretch, before)
    return float(whole[int(np.argmax(first_excess(mode, whole)))])
