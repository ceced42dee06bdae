"""Loading, holds and unloading: a record cut where the rod turns or rests."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from calibration.experiment.model import PokeTrial

Array = NDArray[np.float64]

TURN = 0.02  # part of the record's range of depth that a real turn goes back by
NOISE = 6.5  # standard deviations of the depth that are no turn
# samples by which noise may have moved a boundary, and those beside it that tell where it was
MOVED, WINDOW = 6, 14
ENDS, NEAR, CALM = 7, 0.5, 5  # samples that tell where a stroke begins and ends, and how near counts as there
# Squared deviations of the depth by which lines without a hold must be worse than with it: it takes two
# numbers to say where it is and one for its depth, chosen among many places.
MORE = 15.0
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
    """Boundaries moved to where they are; then rests too short to be holds, and those that noise of `sd` on
    the strokes beside them explains, go to these strokes, and boundaries are moved again."""
    found = _sharper(phases, time, depth)
    while True:
        needless = next((k for k in range(len(found)) if not _rests(found, k, time, depth, sd)), None)
        if needless is None:
            return found
        found = _sharper(_without(found, needless), time, depth)


def _rests(phases: list[Phase], k: int, time: Array, depth: Array, sd: float) -> bool:
    """Whether a phase is a stroke, or a hold that has its place: the strokes beside it, run on to where they
    come nearest, are worse by more than what noise does, and it lasts."""
    hold = phases[k]
    beside = [q for q in phases[max(k - 1, 0) : k + 2] if q.kind != "hold"]
    if hold.kind != "hold" or not beside:
        return True
    if _lasts(hold, time) <= REST * max(_lasts(q, time) for q in beside):
        return False
    low = max(phases[k - 1].points.start, hold.points.start - WINDOW) if k > 0 else hold.points.start
    high = (
        min(phases[k + 1].points.stop, hold.points.stop + WINDOW) if k + 1 < len(phases) else hold.points.stop
    )
    three = [slice(low, hold.points.start), hold.points, slice(hold.points.stop, high)]
    held = sum(_off(time[p], depth[p], rests=p == hold.points) for p in three if p.stop - p.start > 2)
    if len(beside) == 2:
        cuts = time[low + 3 : high - 2]
        two = min(_bent(time[low:high], depth[low:high], at, *beside) for at in cuts)
    else:
        two = _off(time[low:high], depth[low:high], rests=False)
    return two > held + MORE * sd**2


def _without(phases: list[Phase], k: int) -> list[Phase]:
    """The hold's points to the stroke before it, or half of them where there is one on either side."""
    start, stop = phases[k].points.start, phases[k].points.stop
    cut = start if k == 0 else stop if k + 1 == len(phases) else (start + stop) // 2
    found = [replace(p) for p in phases]
    if k > 0:
        found[k - 1] = replace(found[k - 1], points=slice(found[k - 1].points.start, cut))
    if k + 1 < len(found):
        found[k + 1] = replace(found[k + 1], points=slice(cut, found[k + 1].points.stop))
    return found[:k] + found[k + 1 :]


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
        left = [_bent(time[low:high], depth[low:high], time[c], a, b) for c in cuts]
        cut = cuts[int(np.argmin(left))]
        found[k] = replace(a, points=slice(a.points.start, cut))
        found[k + 1] = replace(b, points=slice(cut, b.points.stop))
    return found


def _bent(time: Array, depth: Array, at: float, a: Phase, b: Phase) -> float:
    """Squared sum of what a line with a bend at a time leaves, level on the side of a hold."""
    before, after = np.minimum(time - at, 0.0), np.maximum(time - at, 0.0)
    columns = [np.ones(time.size)]
    columns += [side for side, p in ((before, a), (after, b)) if p.kind != "hold"]
    basis = np.linalg.qr(np.column_stack(columns))[0]
    return float(depth @ depth - np.sum((basis.T @ depth) ** 2))


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
    calm = median_filter(depth, min(CALM, some), mode="reflect")
    left = np.flatnonzero(np.abs(calm - start) > near)
    arrived = np.flatnonzero(np.abs(calm - end) > near)
    if not left.size or not arrived.size:
        return 0, size
    first, last = int(left[0]), int(arrived[-1]) + 1
    travel = max(float(time[min(last, size - 1)] - time[first]), 0.0)
    if time[first] - time[0] <= REST * travel:
        first = 0
    if time[-1] - time[min(last, size - 1)] <= REST * travel:
        last = size
    return first, last
