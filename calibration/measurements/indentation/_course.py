"""The course of an indentation as it was measured: depth against time, from rest on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import PokeTrial
from calibration.measurements._records import bins, holds
from calibration.measurements.indentation._phases import Phase, phases_of
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

STILL = 0.01  # fraction of the record's range within which a hold stays
NOISE = 6.0  # standard deviations of the depth that are no motion
BEGINNING = 4  # rows by which the speed of a first loading is known
DIFFERENT = 1.1  # ratio of largest depths that count as two


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """What drives a record, in straight lines from rest on: its points, and the corners between phases.

    Attributes
    ----------
    time : [s], shape (f,).
    depth : from first touch [m], shape (f,).
    at : where the record's points are among them, shape (k,).
    """

    time: Array
    depth: Array
    at: Rows

    def only(self, kept: NDArray[np.bool_]) -> Course:
        """Some of its points; what drove the material stays."""
        return replace(self, at=self.at[kept])

    def moved(self, shift: Array | float) -> Array:
        """Depths (f,) with the points shifted [m], shape (k,) or one number."""
        own = np.broadcast_to(np.asarray(shift, dtype=float), self.at.shape)
        return np.asarray(self.depth + np.interp(self.time, self.time[self.at], own))


def course_of(time: Array, depth: Array, phases: Sequence[Phase], points: Array, depths: Array) -> Course:
    """Of the rows of a record.

    Parameters
    ----------
    time, depth : of the rows, shape (t,).
    points, depths : times and depths of the points, means of neighbouring rows, shape (k,).
    """
    corners = np.unique([0, *(p.points.start for p in phases), time.size - 1])
    lead = _lead(time, depth, phases[0])
    every = np.concatenate([lead, time[corners], points])
    driven = np.concatenate([np.zeros(lead.size), depth[corners], depths])
    # a corner comes before a point at its time, which then adds nothing
    order = np.argsort(every, kind="stable")
    place = np.empty(order.size, dtype=np.intp)
    place[order] = np.arange(order.size)
    return Course(time=every[order], depth=driven[order], at=place[lead.size + corners.size :])


def _lead(time: Array, depth: Array, first: Phase) -> Array:
    """When the indenter touched [s], shape (1,), where the record begins below the surface; none else."""
    if depth[0] <= 0.0:
        return np.zeros(0)
    last = min(BEGINNING, first.points.stop, depth.size - 1)
    made = depth[last] - depth[0]
    if made <= 0.0:
        return time[:1]  # it was there at once
    return np.array([time[0] - (time[last] - time[0]) * depth[0] / made])


def with_holds(trial: PokeTrial, phases: Sequence[Phase]) -> list[Phase]:
    """Phases with the holds that they contain as phases of their own: after a ramp of a few rows a hold is
    most of a stroke, and counts as a part of it where time does not count."""
    depth = trial.record.depth
    rests = holds(trial.record.time, depth, max(STILL * float(np.ptp(depth)), NOISE * trial.depth_sd))
    found = []
    for p in phases:
        inside = [h for h in rests if h.start < p.points.stop and h.stop > p.points.start]
        cuts = {p.points.start, p.points.stop}
        if p.direction != 0.0:
            cuts |= {i for h in inside for i in (h.start, h.stop) if p.points.start < i < p.points.stop}
        for a, b in pairwise(sorted(cuts)):
            held = any(h.start <= a and b <= h.stop for h in inside)
            direction = 0.0 if held and a > 0 else p.direction
            found.append(replace(p, points=slice(a, b), direction=direction))
    return found


def bins_over_time(time: Array, phase: Phase, most: int) -> tuple[Rows, Array]:
    """As `bins`; those of a hold grow with the time since it began."""
    size = phase.points.stop - phase.points.start
    if phase.direction != 0.0 or size <= most:
        return bins(phase.points, most)
    since = time[phase.points] - time[phase.points.start]
    scale = np.log1p(since / since[1])
    first = np.flatnonzero(np.diff(np.floor(most * scale / scale[-1]), prepend=-1.0))
    return first, np.diff(np.append(first, size)).astype(float)


def window_of(trials: Sequence[PokeTrial]) -> ProtocolWindow:
    """Between which times the ramps and holds of indentations show relaxation."""
    ramps, waits, lengths, peaks = [], [], [], []
    for trial in trials:
        time, phases = trial.record.time, with_holds(trial, phases_of(trial))
        lengths.append(float(time[-1] - time[0]))
        for p in phases:
            took = float(time[min(p.points.stop, time.size - 1)] - time[p.points.start])
            if p.direction != 0.0:
                ramps.append(took)
            elif p.points.start > 0:
                waits.append(took)
        for a, b in pairwise([p for p in phases if p.direction != 0.0]):
            if a.direction > 0.0 > b.direction:
                peaks.append(float(trial.record.depth[a.points].max()))
    peaks.sort()
    different = sum(k == 0 or peak > DIFFERENT * peaks[k - 1] for k, peak in enumerate(peaks))
    last = max(waits or lengths, default=0.0)
    first = min([r for r in ramps if r > 0.0], default=last)
    return ProtocolWindow(first=min(first, last), last=last, peaks=different)
