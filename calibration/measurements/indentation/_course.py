"""Loading history of an indentation as measured: depth against time, from rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import PokeTrial
from calibration.measurements._course import holds, ramp_start, unmoved, window_from
from calibration.measurements.indentation._phases import STAGE, Phase, phases_of
from calibration.measurements.indentation._scene import approach
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]
Rows = NDArray[np.intp]


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """Loading history of a record, piecewise linear from rest: its points, and the corners between phases.

    Attributes
    ----------
    time : [s], shape (f,).
    depth : depth from first touch [m], shape (f,).
    at : indices of the record's points among them, shape (k,).
    """

    time: Array
    depth: Array
    at: Rows

    def only(self, kept: NDArray[np.bool_]) -> Course:
        """Course with a subset of the points (mask); the loading history stays."""
        return replace(self, at=self.at[kept])

    def moved(self, shift: Array | float) -> Array:
        """Depths (f,) [m], shifted at the points; shift : [m], shape (k,) or one number."""
        own = np.broadcast_to(np.asarray(shift, dtype=float), self.at.shape)
        return np.asarray(self.depth + np.interp(self.time, self.time[self.at], own))


def course_of(time: Array, depth: Array, phases: Sequence[Phase], points: Array, depths: Array) -> Course:
    """Loading history from the rows of a record.

    Parameters
    ----------
    time, depth : time [s] and depth [m] of the rows, shape (t,).
    phases : phases of the record, whose first rows are corners.
    points, depths : times and depths of the points, means of neighbouring rows, shape (k,).
    """
    corners = np.unique([0, *(p.points.start for p in phases), time.size - 1])
    lead = _lead(time, depth, phases[0])
    every = np.concatenate([lead, time[corners], points])
    driven = np.concatenate([np.zeros(lead.size), depth[corners], depths])
    # a corner comes before a point at the same time, so that the point adds no step
    order = np.argsort(every, kind="stable")
    place = np.empty(order.size, dtype=np.intp)
    place[order] = np.arange(order.size)
    return Course(time=every[order], depth=driven[order], at=place[lead.size + corners.size :])


def _lead(time: Array, depth: Array, first: Phase) -> Array:
    """Time of first touch [s], shape (1,), if the record begins below the surface; else empty."""
    if depth[0] <= 0.0:
        return np.zeros(0)
    found = ramp_start(time, depth, first.points.stop)
    return time[:1] if found is None else np.array([found])  # else applied as a jump


def with_holds(trial: PokeTrial, phases: Sequence[Phase]) -> list[Phase]:
    """Phases with their holds as separate phases.

    After a ramp of a few rows a hold is most of a stroke; without time dependence it is part of the stroke.
    """
    depth = trial.record.depth
    stage = STAGE * float(np.abs(depth).max())
    tolerance = max(unmoved(float(np.ptp(depth)), trial.depth_sd), stage)
    rests = holds(trial.record.time, depth, tolerance)
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


def window_of(trials: Sequence[PokeTrial]) -> ProtocolWindow:
    """Range of times of ramps and holds in contact, and number of different peak depths, of indentations."""
    ramps, waits, lengths, peaks = [], [], [], []
    intervals: list[float] = []
    for trial in trials:
        time, phases = trial.record.time, with_holds(trial, phases_of(trial))
        depth = trial.record.depth - approach(trial)
        least = unmoved(float(depth.max()), trial.depth_sd)
        lengths.append(_time_in_contact(time, depth, slice(0, time.size)))
        intervals += np.diff(time).tolist()
        for p in phases:
            took = _time_in_contact(time, depth, p.points)
            end = min(p.points.stop, time.size - 1)
            if abs(depth[end] - depth[p.points.start]) > least and p.direction != 0.0:
                ramps.append(took)
            elif depth[p.points].mean() > least:
                waits.append(took)
        for a, b in pairwise([p for p in phases if p.direction != 0.0]):
            if a.direction > 0.0 > b.direction and (peak := float(depth[a.points].max())) > least:
                peaks.append(peak)
    return window_from(ramps=ramps, waits=waits, lengths=lengths, intervals=intervals, peaks=peaks)


def _time_in_contact(time: Array, depth: Array, points: slice) -> float:
    """Time of a phase below the surface, from the row before to the row after it [s]."""
    touching = points.start + np.flatnonzero(depth[points.start : points.stop + 1] > 0.0)
    if not touching.size:
        return 0.0
    after = min(int(touching[-1]) + 1, points.stop, time.size - 1)
    return float(time[after] - time[max(touching[0] - 1, points.start)])
