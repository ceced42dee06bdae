"""Segmentation of a record into loading, holds and unloading; smoothing of the depth in each phase.

Strokes are those of `calibration.measurements._records`; holds are split off, and the boundaries are moved to
where straight lines on either side fit a noisy depth best.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import PokeTrial
from calibration.measurements._records import strokes

Array = NDArray[np.float64]

TURN = 0.02  # least reversal at a turning point, as a fraction of the record's range of depth
NOISE = 6.5  # the same, in standard deviations of the depth; more for long records (`_by_noise`)
STAGE = 2e-3  # fraction of the largest depth below which a motion is the stage's own, stated or not
# samples by which a boundary may be moved, and samples on either side that are used for this
MOVED, WINDOW = 6, 14
ENDS, NEAR, CALM = 7, 0.5, 5  # samples at a stroke's ends, distance (in tolerances) to an end, median window
# Increase of the squared deviations of the depth, in sd^2, that justifies a hold: it has three parameters
# (two ends and a depth), chosen among many alternatives.
MORE = 15.0
SAMPLES = 500  # of a record with noise, or up to twice as many: averages of its own
REST = 0.15  # least duration of a hold, as a fraction of the time of the stroke's motion

HIGHEST = 6  # highest polynomial degree of a phase's depth in time
LEAST = 8  # least number of samples of a phase that is smoothed
AGREES = 1.3  # largest rms of the depth about the smooth one, over the stated noise

_NAMES = {1.0: "loading", 0.0: "hold", -1.0: "unloading"}


@dataclass(frozen=True, kw_only=True)
class Phase:
    """A part of a record in which the indenter moves in one direction, or rests.

    Attributes
    ----------
    points : slice of its samples.
    direction : +1 loading, 0 hold, -1 unloading.
    cycle : number of the loading that it belongs to, from 1.
    """

    points: slice
    direction: float
    cycle: int

    @property
    def label(self) -> str:
        return f"{_NAMES[self.direction]} {self.cycle}"


def phases_of(trial: PokeTrial) -> list[Phase]:
    """Phases of a trial in the order of the record.

    They are found in averages of successive samples where a record with noise has many: in the few samples
    around a corner it would not move by more than its noise, and each possible corner costs all samples.
    """
    size = trial.record.depth.size
    each = max(1, size // SAMPLES) if trial.depth_sd > 0.0 else 1
    first = np.arange(0, size, each)
    count = np.diff(first, append=size)
    depth, time = (np.add.reduceat(x, first) / count for x in (trial.record.depth, trial.record.time))
    found = _phases(time, depth, trial.depth_sd / float(np.sqrt(each)))
    return [replace(p, points=slice(each * p.points.start, min(each * p.points.stop, size))) for p in found]


def _phases(time: Array, depth: Array, sd: float) -> list[Phase]:
    stage = STAGE * float(np.abs(depth).max())
    tolerance = max(TURN * float(np.ptp(depth)), _by_noise(depth.size) * sd, stage)
    found: list[Phase] = []
    cycle = 0
    for s in strokes(depth, tolerance):
        direction = s.direction or 1.0  # a record that never turns counts as loading
        cycle += direction > 0
        number = max(cycle, 1)
        a, b = s.points.start, s.points.stop
        first, last = _moving(depth[a:b], time[a:b], tolerance)
        for low, high, moves in ((0, first, 0.0), (first, last, direction), (last, b - a, 0.0)):
            if high <= low:
                continue
            # a hold at the end of the preceding stroke continues at this stroke's start
            if moves == 0.0 and found and found[-1].direction == 0.0:
                found[-1] = replace(found[-1], points=slice(found[-1].points.start, a + high))
            else:
                found.append(Phase(points=slice(a + low, a + high), direction=moves, cycle=number))
    return found if sd == 0.0 else _settled(found, time, depth, sd)


def _by_noise(samples: int) -> float:
    """Reversal of a depth at rest that noise alone hardly makes, in standard deviations.

    The range of n normal readings is below 2 sqrt(2 ln n) in nearly all records.
    """
    return max(NOISE, 2.0 * float(np.sqrt(2.0 * np.log(samples))))


# -- depth without its noise --


def smooth_depth(
    time: Array, depth: Array, phases: Sequence[Phase], sd: float
) -> tuple[Array, tuple[int, ...]]:
    """Smooth the depth in each phase by a polynomial in time.

    An indenter is driven smoothly, and forces simulated at noisy depths would carry that noise into the fit.

    Parameters
    ----------
    time, depth : samples of the record [s], [m], shape (k,).
    phases : phases of the record.
    sd : standard deviation of one reading of the depth [m].

    Returns
    -------
    depth : ndarray, shape (k,)
        Smoothed depth [m].
    degrees : tuple of int
        Degree of each phase, the lowest that agrees with the stated noise. It is -1, and the depth is
        unchanged, if none does, if the phase is too short, or if `sd` is 0.
    """
    found, degrees = depth.copy(), []
    for p in phases:
        t, d = time[p.points], depth[p.points]
        degrees.append(-1)
        for degree in range(min(HIGHEST, d.size // 3) + 1) if sd > 0.0 and d.size >= LEAST else ():
            line = np.polynomial.Legendre.fit(t, d, degree)(t)
            rms = float(np.sqrt(np.sum((d - line) ** 2) / (d.size - degree - 1)))
            if rms <= AGREES * sd:
                found[p.points] = line
                degrees[-1] = degree
                break
    return found, tuple(degrees)


def remaining_noise(time: Array, samples: int, degree: int) -> Array:
    """Error modes of a smoothed phase at some of its times (k,), one sd each; shape (k, degree + 1).

    They are the Legendre polynomials with the sd of their coefficients, relative to the noise of one sample.

    Parameters
    ----------
    time : times in the phase [s], shape (k,).
    samples : number of samples of the phase.
    degree : degree of its polynomial.
    """
    low, high = float(time.min()), float(time.max())
    unit = 2.0 * (time - low) / (high - low) - 1.0 if high > low else np.zeros(time.size)
    each = np.sqrt((2.0 * np.arange(degree + 1) + 1.0) / samples)
    return np.asarray(np.polynomial.legendre.legvander(unit, degree) * each)


# -- holds --


def _moving(depth: Array, time: Array, tolerance: float) -> tuple[int, int]:
    """Index of the first moving sample of a stroke, and of the first sample at rest at its end.

    Rests that are too short for a hold belong to the stroke.
    """
    from scipy.ndimage import median_filter

    size = depth.size
    if size < 4:
        return 0, size
    # medians of several samples: if a stroke begins and ends at rest, its first and last samples are extremes
    # of the noise, and the rest would seem to move relative to them
    some = max(1, min(ENDS, size // 8))
    start, end = float(np.median(depth[:some])), float(np.median(depth[-some:]))
    near = NEAR * tolerance
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


def _settled(phases: list[Phase], time: Array, depth: Array, sd: float) -> list[Phase]:
    """Refine the boundaries and remove spurious holds.

    Holds that are too short, or that noise of `sd` on the adjacent strokes explains, are merged into these
    strokes; after each merge the boundaries are refined again.
    """
    found = _sharper(phases, time, depth)
    while True:
        needless = next((k for k in range(len(found)) if not _needed(found, k, time, depth, sd)), None)
        if needless is None:
            return found
        found = _sharper(_without(found, needless), time, depth)


def _needed(phases: list[Phase], k: int, time: Array, depth: Array, sd: float) -> bool:
    """True if a phase is a stroke, or a hold that is long enough and improves the fit beyond noise.

    The fit without the hold is that of the adjacent strokes, extended to their best common turning point.
    """
    hold = phases[k]
    beside = [q for q in phases[max(k - 1, 0) : k + 2] if q.direction != 0.0]
    if hold.direction != 0.0 or not beside:
        return True
    if _duration(hold, time) <= REST * max(_duration(q, time) for q in beside):
        return False
    low = max(phases[k - 1].points.start, hold.points.start - WINDOW) if k > 0 else hold.points.start
    high = (
        min(phases[k + 1].points.stop, hold.points.stop + WINDOW) if k + 1 < len(phases) else hold.points.stop
    )
    three = [slice(low, hold.points.start), hold.points, slice(hold.points.stop, high)]
    held = sum(_line_misfit(time[p], depth[p], level=p == hold.points) for p in three if p.stop - p.start > 2)
    if len(beside) == 2:
        cuts = time[low + 3 : high - 2]
        # without samples around the hold there is no evidence against it
        two = min((_bent_misfit(time[low:high], depth[low:high], at, *beside) for at in cuts), default=np.inf)
    else:
        two = _line_misfit(time[low:high], depth[low:high], level=False)
    return two > held + MORE * sd**2


def _without(phases: list[Phase], k: int) -> list[Phase]:
    """Remove hold `k`: its samples go to the adjacent stroke, half to each if there are two."""
    start, stop = phases[k].points.start, phases[k].points.stop
    cut = start if k == 0 else stop if k + 1 == len(phases) else (start + stop) // 2
    found = [replace(p) for p in phases]
    if k > 0:
        found[k - 1] = replace(found[k - 1], points=slice(found[k - 1].points.start, cut))
    if k + 1 < len(found):
        found[k + 1] = replace(found[k + 1], points=slice(cut, found[k + 1].points.stop))
    return found[:k] + found[k + 1 :]


def _duration(phase: Phase, time: Array) -> float:
    return float(time[phase.points.stop - 1] - time[phase.points.start])


def _sharper(phases: list[Phase], time: Array, depth: Array) -> list[Phase]:
    """Move each boundary to the best fit of the depth by two lines that meet there, constant in a hold."""
    found = list(phases)
    for k in range(len(found) - 1):
        a, b = found[k], found[k + 1]
        low = max(a.points.start, a.points.stop - WINDOW)
        high = min(b.points.stop, b.points.start + WINDOW)
        cuts = range(max(low + 3, a.points.stop - MOVED), min(high - 3, a.points.stop + MOVED) + 1)
        if not cuts:
            continue
        misfits = [_bent_misfit(time[low:high], depth[low:high], time[c], a, b) for c in cuts]
        cut = cuts[int(np.argmin(misfits))]
        found[k] = replace(a, points=slice(a.points.start, cut))
        found[k + 1] = replace(b, points=slice(cut, b.points.stop))
    return found


def _bent_misfit(time: Array, depth: Array, at: float, a: Phase, b: Phase) -> float:
    """Sum of squared residuals of a line with a kink at time `at`, constant on the side of a hold."""
    before, after = np.minimum(time - at, 0.0), np.maximum(time - at, 0.0)
    columns = [np.ones(time.size)]
    columns += [side for side, p in ((before, a), (after, b)) if p.direction != 0.0]
    basis = np.linalg.qr(np.column_stack(columns))[0]
    return float(depth @ depth - np.sum((basis.T @ depth) ** 2))


def _line_misfit(time: Array, depth: Array, *, level: bool) -> float:
    """Sum of squared residuals of a line, or of a constant (`level`)."""
    t, d = time - time.mean(), depth - depth.mean()
    return float(d @ d - (0.0 if level else (t @ d) ** 2 / (t @ t)))
