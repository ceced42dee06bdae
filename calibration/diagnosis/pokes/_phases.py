"""Loading, holds and unloading: a record cut where the rod turns or rests."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import PokeTrial

Array = NDArray[np.float64]

TURN = 0.02  # part of the record's range of depth that a real turn goes back by
NOISE = 5.0  # standard deviations of the depth that are no turn
# samples by which noise may have moved a boundary, and those beside it that tell where it was
MOVED, WINDOW = 6, 14
ENDS, NEAR = 7, 0.7  # samples that tell where a stroke begins and ends, and how near counts as there
ROUNDS = 10  # of moving boundaries
ONE = 1.3  # of the noise: what is left about one line through a rest and a stroke, if there is no rest
REST = 0.15  # part of a stroke's time that it must stand still at its end to be a hold


@dataclass(frozen=True, kw_only=True)
class Phase:
    """points: where in the record. kind: "loading", "hold" or "unloading"; cycle: which loading of the record
    it belongs to, from 1."""

    points: slice
    kind: str
    cycle: int

    @property
    def label(self) -> str:
        return f"{self.kind} {self.cycle}"


def phases_of(trial: PokeTrial) -> list[Phase]:
    """Phases in the order of the record."""
    depth, time = trial.record.depth, trial.record.time
    back = max(TURN * float(np.ptp(depth)), NOISE * trial.depth_sd)
    found: list[Phase] = []
    cycle = 0
    for a, b, direction in _strokes(depth, back):
        cycle += direction > 0
        kind, number = ("loading", cycle) if direction > 0 else ("unloading", max(cycle, 1))
        first, last = _moving(depth[a:b], time[a:b], back)
        for lo, hi, what in ((0, first, "hold"), (first, last, kind), (last, b - a, "hold")):
            if hi <= lo:
                continue
            # a rest that the stroke before ends with goes on at this stroke's start
            if what == "hold" and found and found[-1].kind == "hold":
                found[-1] = Phase(
                    points=slice(found[-1].points.start, a + hi), kind=what, cycle=found[-1].cycle
                )
            else:
                found.append(Phase(points=slice(a + lo, a + hi), kind=what, cycle=max(number, 1)))
    return found if trial.depth_sd == 0.0 else _settled(found, time, depth, trial.depth_sd)


def _settled(phases: list[Phase], time: Array, depth: Array, sd: float) -> list[Phase]:
    """Boundaries moved until they stay; then rests too short to be holds, and those at an end of the record
    that noise of `sd` on a stroke explains, go to the strokes beside them."""
    found = phases
    for _ in range(ROUNDS):
        before, found = found, _sharper(found, time, depth)
        if found == before:
            break
    kept: list[Phase] = []
    for k, p in enumerate(found):
        beside = [q for q in found[max(k - 1, 0) : k + 2] if q.kind != "hold"]
        longest = max((_lasts(q, time) for q in beside), default=0.0)
        short = _lasts(p, time) <= REST * longest
        if p.kind == "hold" and len(beside) == 1 and not short:
            both = slice(
                min(p.points.start, beside[0].points.start), max(p.points.stop, beside[0].points.stop)
            )
            left = _off(time[both], depth[both], rests=False) / max(both.stop - both.start - 2, 1)
            short = left <= (ONE * sd) ** 2
        if p.kind != "hold" or not short:
            kept.append(p)
        elif kept:  # to the stroke that it ends
            kept[-1] = replace(kept[-1], points=slice(kept[-1].points.start, p.points.stop))
        else:
            found[k + 1] = replace(found[k + 1], points=slice(p.points.start, found[k + 1].points.stop))
    return kept


def _lasts(phase: Phase, time: Array) -> float:
    return float(time[phase.points.stop - 1] - time[phase.points.start])


def _sharper(phases: list[Phase], time: Array, depth: Array) -> list[Phase]:
    """The same with boundaries where two lines, one on either side, level in a hold, come nearest to a noisy
    depth."""
    found = list(phases)
    for k in range(len(found) - 1):
        a, b = found[k], found[k + 1]
        low = max(a.points.start, a.points.stop - WINDOW)
        high = min(b.points.stop, b.points.start + WINDOW)
        cuts = range(max(low + 3, a.points.stop - MOVED), min(high - 3, a.points.stop + MOVED) + 1)
        if not cuts:
            continue
        left = [
            _off(time[low:c], depth[low:c], rests=a.kind == "hold")
            + _off(time[c:high], depth[c:high], rests=b.kind == "hold")
            for c in cuts
        ]
        cut = cuts[int(np.argmin(left))]
        found[k] = replace(a, points=slice(a.points.start, cut))
        found[k + 1] = replace(b, points=slice(cut, b.points.stop))
    return found


def _off(time: Array, depth: Array, *, rests: bool) -> float:
    """Squared sum of what a line leaves, a level one where the rod rests."""
    t, d = time - time.mean(), depth - depth.mean()
    return float(d @ d - (0.0 if rests else (t @ d) ** 2 / (t @ t)))


def _strokes(depth: Array, back: float) -> list[tuple[int, int, float]]:
    """(first, end, direction) of monotone parts, apart from noise; each begins at the turning point
    before."""
    turns = [0]
    directions: list[float] = []
    top = bottom = 0
    direction = 0.0
    for i in range(1, depth.size):
        top = i if depth[i] > depth[top] else top
        bottom = i if depth[i] < depth[bottom] else bottom
        if direction >= 0.0 and depth[top] - depth[i] > back:
            if direction > 0.0:
                turns.append(top)
            directions.append(-1.0)
            direction, bottom, top = -1.0, i, i
        elif direction <= 0.0 and depth[i] - depth[bottom] > back:
            if direction < 0.0:
                turns.append(bottom)
            directions.append(1.0)
            direction, bottom, top = 1.0, i, i
    ends = [*turns[1:], depth.size]
    return list(zip(turns, ends, directions or [1.0], strict=True))


def _moving(depth: Array, time: Array, back: float) -> tuple[int, int]:
    """Where a stroke starts to move and where it has arrived, in points of it; rests too short to be holds
    belong to the stroke."""
    size = depth.size
    if size < 4:
        return 0, size
    # several samples each: the first and the last are extremes of the noise where a stroke begins and ends at
    # a rest, and a rest about them would seem to move
    some = max(1, min(ENDS, size // 8))
    start, end = float(np.median(depth[:some])), float(np.median(depth[-some:]))
    near = NEAR * back
    left = np.flatnonzero(np.abs(depth - start) > near)
    arrived = np.flatnonzero(np.abs(depth - end) > near)
    if not left.size or not arrived.size:
        return 0, size
    first, last = int(left[0]), int(arrived[-1]) + 1
    travel = max(float(time[min(last, size - 1)] - time[first]), 0.0)
    if time[first] - time[0] <= REST * travel:
        first = 0
    if time[-1] - time[min(last, size - 1)] <= REST * travel:
        last = size
    return first, last
