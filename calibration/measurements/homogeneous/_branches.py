"""Branches of a homogeneous test: its strokes between turning points, their unloading and strain rates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponTrial
from calibration.measurements._course import NOISE
from calibration.measurements._records import Stroke, strokes
from calibration.measurements.homogeneous._course import window_of
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]

TURN = 0.03  # least reversal at a turning point, as a fraction of the record's range
LATE = 0.3  # time after the end of a ramp, as a fraction of its duration, from which a hold begins


def branches_of(trial: CouponTrial) -> list[Stroke]:
    """Strokes in the order of the record, each with the sign of its net change of stretch (1 if 0)."""
    x = trial.stretch
    found = []
    for s in strokes(x, turning(trial)):
        last = min(s.points.stop, x.size - 1)
        found.append(Stroke(points=s.points, direction=float(np.sign(x[last] - x[s.points.start]) or 1.0)))
    return found


def turning(trial: CouponTrial) -> float:
    """Least reversal of the stretch at a turning point."""
    return max(TURN * float(np.ptp(trial.stretch)), NOISE * trial.stretch_sd)


def rates_of(trial: CouponTrial, parts: Sequence[Stroke]) -> Array:
    """|d stretch / d time| of each point [1/s].

    It is the mean of the ramp between 10 and 90 % of its stretch, so that noise does not enter. In a hold it
    is the ramp's stretch over the time since the ramp began, which falls as 1/time. NaN without a clock.
    """
    found = np.full(trial.stretch.size, np.nan)
    if trial.time is None:
        return found
    begun, travelled = 0.0, 0.0  # start and stretch of the preceding ramp
    for b in parts:
        x, t = trial.stretch[b.points], trial.time[b.points]
        reach = slice(b.points.start, min(b.points.stop + 1, trial.stretch.size))
        travel = float(np.ptp(trial.stretch[reach]))
        done = np.abs(x - x[0])
        early = np.flatnonzero(done <= 0.1 * travel)
        late = np.flatnonzero(done >= 0.9 * travel)
        if travel == 0.0 or not late.size or t[late[0]] <= t[early[-1]]:
            continue
        between = float(t[late[0]] - t[early[-1]])
        made = float(done[late[0]] - done[early[-1]])
        rate = made / between
        start = float(t[early[-1]]) - done[early[-1]] / rate
        end = start + travel / rate
        here = np.full(x.size, rate)
        held = t > end + LATE * between
        here[held] = travel / (t[held] - start)
        if travelled > 0.0:  # the preceding hold continues
            held = t < start - LATE * between
            here[held] = travelled / (t[held] - begun)
        found[b.points] = here
        begun, travelled = start, travel
    return found


def unloading_points(trial: CouponTrial, b: Stroke) -> NDArray[np.bool_]:
    """Mask of a branch's points that return towards rest; beyond rest, and beyond noise, they load again."""
    s = trial.stretch[b.points]
    noise = turning(trial)
    gone = b.direction * (s - 1.0)
    if gone[0] > -noise:
        return np.zeros(s.size, dtype=bool)
    return np.full(s.size, True) if gone.max() <= noise else gone < 0.0


def loads_again(turn: Array) -> bool:
    """True if a loading follows an unloading."""
    unloading = np.isfinite(turn)
    return bool((~unloading[int(np.argmax(unloading)) :]).any())


def protocol_window(trials: Sequence[CouponTrial]) -> ProtocolWindow:
    """Range of the times of ramps and holds, and number of peak strains, that tests cover."""
    return window_of(trials, [branches_of(t) for t in trials])
