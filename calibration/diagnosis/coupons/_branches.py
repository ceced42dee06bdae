"""Loading, unloading and holds: a record cut where it turns, and how fast each part went."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponTrial

Array = NDArray[np.float64]

TURN = 0.03  # part of the record's range that a real turn goes back by
NOISE = 6.0  # standard deviations of the stretch that are no turn
LATE = 0.3  # part of a ramp's time for which it may stand still before this is a hold


@dataclass(frozen=True, kw_only=True)
class Branch:
    """points: where in the record; direction: +1 the stretch grows, -1 it falls."""

    points: slice
    direction: float


def turning(trial: CouponTrial) -> float:
    """How far a stretch goes back where it really turns."""
    return max(TURN * float(np.ptp(trial.stretch)), NOISE * trial.stretch_sd)


def branches_of(trial: CouponTrial) -> list[Branch]:
    """Monotone parts of the stretch in the order of the record, apart from its noise. The first starts at the
    first point, and each at the turning point before it."""
    x = trial.stretch
    back = turning(trial)
    turns = [0]
    top = bottom = 0  # where the extremes since the last turn are
    direction = 0.0
    for i in range(1, x.size):
        top = i if x[i] > x[top] else top
        bottom = i if x[i] < x[bottom] else bottom
        if direction >= 0.0 and x[top] - x[i] > back:
            if direction > 0.0 or x[top] - x[0] > back:
                turns.append(top)
            direction, bottom, top = -1.0, i, i
        elif direction <= 0.0 and x[i] - x[bottom] > back:
            if direction < 0.0 or x[0] - x[bottom] > back:
                turns.append(bottom)
            direction, bottom, top = 1.0, i, i
    starts = [*dict.fromkeys(turns), x.size]
    found = []
    for a, b in pairwise(starts):
        last = min(b, x.size - 1)
        found.append(Branch(points=slice(a, b), direction=float(np.sign(x[last] - x[a]) or 1.0)))
    return found


def rates_of(trial: CouponTrial, parts: Sequence[Branch]) -> Array:
    """|d stretch / d time| of each point [1/s]: that of its whole ramp, so that noise does not enter. In a
    hold: the ramp's stretch over the time since it began, which falls as 1/time and tells how long the
    material had. NaN where there is no time."""
    found = np.full(trial.stretch.size, np.nan)
    if trial.time is None:
        return found
    begun, travelled = 0.0, 0.0  # of the ramp before
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
        if travelled > 0.0:  # still held from before
            held = t < start - LATE * between
            here[held] = travelled / (t[held] - begun)
        found[b.points] = here
        begun, travelled = start, travel
    return found
