"""Records of homogeneous tests: thinned, with their history (branches, earlier peak strain, rate)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import CouponMode, CouponTrial, specimen_of
from calibration.measurements._course import NOISE, bins_over_time
from calibration.measurements._records import Stroke, bins, strokes
from calibration.measurements.homogeneous._course import (
    Course,
    course_of,
    holds_of,
    largest_before,
    window_of,
)
from calibration.measurements.homogeneous._scatter import FEWEST, SMALLEST_RELATIVE, grows, slope, unstated_sd
from calibration.measurements.homogeneous.kinematics import first_excess
from calibration.parameters import ProtocolWindow

Array = NDArray[np.float64]
# from the mode and the stretch (k,) of a record's points: mask of those that are compared
Selects = Callable[[CouponMode, Array], NDArray[np.bool_]]

MOST = 100  # largest number of points of a branch: more are averaged in bins of neighbours
TURN = 0.03  # least reversal at a turning point, as a fraction of the record's range
SAME_REACH, SAME_RATE = 0.05, 1.2  # relative difference of strain, and ratio of rates, between repeats
LATE = 0.3  # time after the end of a ramp, as a fraction of its duration, from which a hold begins


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Points of one trial in the order of measurement; all arrays have shape (k,).

    Attributes
    ----------
    name : name of the trial.
    material, specimen : of the trial; the specimen is the material's name if the trial names none.
    mode : mode of loading.
    stretch : stretch in the driven direction; 1 + gamma in simple shear.
    stress, sd : nominal stress and its standard deviation [Pa].
    time : [s]; NaN without a clock.
    branch : number of the stroke of each point.
    turn : I1 - 3 at the preceding turning point during unloading; NaN otherwise.
    peak : largest I1 - 3 of the specimen so far.
    reloaded : True if the specimen was loaded again after an unloading, in this or an earlier trial.
    remembers : True if the specimen was loaded in an earlier trial.
    rate : rate of the stretch [1/s]; in a hold, the stretch of its ramp over the time since the ramp began;
        NaN without a clock.
    estimated : True if the lab states no error of the stress, so that sd comes from the scatter.
    scatter_points : number of points from whose scatter it comes; ASSUMED if these are too few; 0 if it is
        stated, or the scatter is below the least error (SMALLEST_RELATIVE).
    ranges : see `calibration.measurements._model.Record`.
    earlier : number of earlier repeats (same specimen, mode, largest strain and rate).
    alike : number of all repeats, including this record.
    course : loading history, for history-dependent materials; None otherwise.
    """

    name: str
    material: str
    specimen: str
    mode: CouponMode
    stretch: Array
    stress: Array
    sd: Array
    time: Array
    branch: Array
    turn: Array
    peak: Array
    reloaded: bool
    remembers: bool
    rate: Array
    estimated: bool
    scatter_points: int
    ranges: Mapping[str, tuple[float, float]]
    earlier: int = 0
    alike: int = 1
    course: Course | None = None

    @property
    def points(self) -> int:
        return self.stretch.size

    @cached_property
    def groups(self) -> Mapping[str, str]:
        return {
            "material": self.material,
            "specimen": self.specimen,
            "mode": str(self.mode),
            "trial": self.name,
        }

    @property
    def unloads(self) -> bool:
        return bool(np.isfinite(self.turn).any())

    def only(self, kept: NDArray[np.bool_]) -> Record:
        """Record of a subset of the points; `kept` is a mask (k,)."""
        arrays = ("stretch", "stress", "sd", "time", "branch", "turn", "peak", "rate")
        course = None if self.course is None else self.course.only(kept)
        return replace(self, course=course, **{name: getattr(self, name)[kept] for name in arrays})


def everything(_: CouponMode, stretch: Array) -> NDArray[np.bool_]:
    """Mask of a record's points of which all are compared."""
    return np.ones(stretch.shape, dtype=bool)


def records_of(
    trials: Sequence[CouponTrial], *, courses: bool = False, selects: Selects = everything
) -> list[Record]:
    """Records of trials, one per trial.

    The trials of a named specimen are taken in the order of the file: `peak` includes its earlier trials of
    the same mode.

    Parameters
    ----------
    trials : the trials.
    courses : True for a history-dependent material: records have their course, and the bins of holds are
        spaced by time.
    selects : mask of the points that the caller compares, and from which alone an error that the lab does not
        state is estimated; the records have the others too.

    Raises
    ------
    InputError
        If the error of a stress is neither stated nor can be estimated.
    """
    found: list[Record] = []
    seen: dict[tuple[str, str], float] = {}
    furthest: dict[tuple[str, str], float] = {}
    for t in trials:
        own = (t.specimen or f"trial {t.id}", t.mode)
        record = _record(t, seen.get(own, 0.0), furthest.get(own, 1.0) if courses else None, selects)
        found.append(record)
        top = float(first_excess(t.mode, record.stretch).max())
        seen[own] = max(seen.get(own, 0.0), top)
        furthest[own] = largest_before(t.mode, t.stretch, furthest.get(own, 1.0))
    return [
        replace(
            r,
            earlier=sum(_alike(r, other) for other in found[:k]),
            alike=sum(_alike(r, other) for other in found),
        )
        for k, r in enumerate(found)
    ]


def _alike(one: Record, other: Record) -> bool:
    """True if two records are repeats of one test. Trials of a material that name no specimen share one."""
    if (one.material, one.specimen, one.mode) != (other.material, other.specimen, other.mode):
        return False
    reaches = [float(r.stretch[np.argmax(np.abs(r.stretch - 1.0))] - 1.0) for r in (one, other)]
    rates = [float(np.median(r.rate)) for r in (one, other)]
    clocks = [not np.isnan(rate) for rate in rates]
    same_rate = max(rates) <= SAME_RATE * min(rates) if all(clocks) else not any(clocks)
    return bool(abs(reaches[0] - reaches[1]) <= SAME_REACH * abs(reaches[0])) and bool(same_rate)


def _record(trial: CouponTrial, before: float, furthest: float | None, selects: Selects) -> Record:
    """Record of a trial.

    before, furthest : largest I1 - 3 of earlier trials, and its stretch; `furthest` is None without a course.
    """
    parts = branches_of(trial)
    timed = furthest is not None and trial.time is not None
    holds = holds_of(trial) if timed else []
    excess = first_excess(trial.mode, trial.stretch)
    turn = np.full(excess.size, np.nan)
    for b in parts[1:]:
        unloading = _unloading(trial, b)
        turn[b.points] = np.where(unloading, excess[b.points.start], np.nan)
    raw_time = np.full(excess.size, np.nan) if trial.time is None else trial.time
    raw_rate = rates_of(trial, parts)
    peak = np.maximum.accumulate(np.maximum(excess, before))
    rows: dict[str, list[Array]] = {n: [] for n in _AVERAGED}
    means: list[Mapping[str, Array]] = []
    numbers, firsts, counts, samples = [], [], [], []
    for n, b in enumerate(parts):
        if timed:
            first, count = bins_over_time(raw_time, b.points, holds, MOST)
        else:
            first, count = bins(b.points, MOST, driven=trial.stretch, sd=trial.stretch_sd)
        weight = np.ones(len(excess)) if trial.samples is None else trial.samples
        samples.append(np.add.reduceat(weight[b.points], first))
        firsts.append(b.points.start + first)
        counts.append(count)
        raw = {
            "stretch": trial.stretch,
            "stress": trial.stress,
            "time": raw_time,
            "turn": turn,
            "peak": peak,
            "rate": raw_rate,
        }
        means.append({k: np.add.reduceat((weight * x)[b.points], first) / samples[n] for k, x in raw.items()})
        for name in _AVERAGED:
            rows[name].append(means[n][name])
        numbers.append(np.full(first.size, float(n)))
    whole: dict[str, Any] = {name: np.concatenate(parts_) for name, parts_ in rows.items()}
    kept = selects(trial.mode, whole["stretch"])
    used = np.repeat(kept, np.concatenate(counts).astype(int))
    own_sd = _own_sd(trial, parts, raw_time if timed else trial.stretch, means, counts, samples, used)
    sd = np.concatenate(
        [
            _sd_over_time(trial, b, holds, means[n], firsts[n] - b.points.start, samples[n], own)
            if timed
            else _sd(trial, means[n]["stretch"], means[n]["stress"], samples[n], own)
            for (n, b), own in zip(enumerate(parts), own_sd, strict=True)
        ]
    )
    if not (np.isfinite(sd) & (sd > np.finfo(float).tiny)).all():
        raise InputError(f"trials.{trial.id}: expected some stress that is not 0, or a stated stress_sd_kPa")
    again = before > 0.0 or bool(np.isfinite(turn).any() and _loads_again(turn))
    return Record(
        name=trial.id,
        material=trial.material,
        specimen=specimen_of(trial),
        mode=trial.mode,
        sd=sd,
        branch=np.concatenate(numbers),
        reloaded=again,
        remembers=before > 0.0,
        estimated=trial.stress_sd is None,
        scatter_points=_scatter_points(trial, sd[kept], used),
        ranges=_ranges(trial, used if used.any() else ~used),
        course=None
        if furthest is None
        else course_of(trial, np.concatenate(firsts), np.concatenate(counts), furthest, holds),
        **whole,
    )


_AVERAGED = ("stretch", "stress", "time", "turn", "peak", "rate")


def _ranges(trial: CouponTrial, used: NDArray[np.bool_]) -> dict[str, tuple[float, float]]:
    """Ranges of a trial's points that are compared, by the quantity's name in files."""
    measured = {"stretch": trial.stretch} | ({} if trial.time is None else {"time_s": trial.time})
    return {name: (float(x[used].min()), float(x[used].max())) for name, x in measured.items()}


def _unloading(trial: CouponTrial, b: Stroke) -> NDArray[np.bool_]:
    """Mask of a branch's points that return towards rest; beyond rest, and beyond noise, they load again."""
    s = trial.stretch[b.points]
    noise = turning(trial)
    gone = b.direction * (s - 1.0)
    if gone[0] > -noise:
        return np.zeros(s.size, dtype=bool)
    return np.full(s.size, True) if gone.max() <= noise else gone < 0.0


def _loads_again(turn: Array) -> bool:
    """True if a loading follows an unloading."""
    unloading = np.isfinite(turn)
    return bool((~unloading[int(np.argmax(unloading)) :]).any())


def _sd(trial: CouponTrial, stretch: Array, stress: Array, samples: Array, own: Array) -> Array:
    """Standard deviation of the means in a branch's bins [Pa], including the stretch error.

    samples : number of samples of the record in each bin; own : error of the stress alone.
    """
    if trial.stretch_sd == 0.0:
        return own
    return np.asarray(
        np.hypot(own, slope(stretch, stress, trial.stretch_sd) * trial.stretch_sd / np.sqrt(samples))
    )


def _sd_over_time(
    trial: CouponTrial,
    b: Stroke,
    holds: Sequence[slice],
    mean: Mapping[str, Array],
    first: NDArray[np.intp],
    samples: Array,
    own: Array,
) -> Array:
    """As `_sd`; a hold has the slope of the last ramp."""
    if trial.stretch_sd == 0.0:
        return own
    rows = b.points.start + first
    moves = ~np.array([any(h.start <= i < h.stop for h in holds) for i in rows])
    if np.count_nonzero(moves) < 5:
        return own
    slopes = slope(mean["stretch"][moves], mean["stress"][moves], trial.stretch_sd)
    last = np.maximum(np.cumsum(moves) - 1, 0)
    return np.asarray(np.hypot(own, slopes[last] * trial.stretch_sd / np.sqrt(samples)))


def _own_sd(
    trial: CouponTrial,
    parts: Sequence[Stroke],
    over: Array,
    means: Sequence[Mapping[str, Array]],
    counts: Sequence[Array],
    samples: Sequence[Array],
    used: NDArray[np.bool_],
) -> list[Array]:
    """Standard deviation of the stress alone [Pa] of the means in each branch's bins.

    An error estimated from the scatter is at least SMALLEST_RELATIVE of the record's largest stress, for any
    number of averaged points. Whether it grows with the stress is a question to the whole record.

    Parameters
    ----------
    over : abscissa of the trial, for the scatter about a smooth curve.
    counts, samples : of points, and of samples of the record, in each bin.
    used : mask of the trial's points that are compared.
    """
    if trial.stress_sd is not None:
        return [np.asarray(trial.stress_sd / np.sqrt(n)) for n in samples]
    curves = [(over[b.points][used[b.points]], trial.stress[b.points][used[b.points]]) for b in parts]
    relative, least = grows(curves), _least_sd(trial)
    return [
        np.maximum(unstated_sd(*curve, mean["stress"], count, relative=relative), least)
        for curve, mean, count in zip(curves, means, counts, strict=True)
    ]


def _least_sd(trial: CouponTrial) -> float:
    """Least standard deviation of a stress that the lab does not state [Pa].

    A load cell is accurate to a fraction of its range, which held the whole record, not of each reading, or
    of the part that is compared (studies/compression/diagnosis.md).
    """
    return SMALLEST_RELATIVE * float(np.abs(trial.stress).max(initial=0.0))


ASSUMED = 3  # as if from the scatter of so few points: nearly nothing is known of an sd that is assumed


def _scatter_points(trial: CouponTrial, sd: Array, used: NDArray[np.bool_]) -> int:
    """See `Record.scatter_points`; sd : of the means that are compared, used : mask of the trial's points."""
    if trial.stress_sd is not None:
        return 0
    if len(np.unique((trial.stretch if trial.time is None else trial.time)[used])) < FEWEST:
        return ASSUMED
    scatters = float(np.median(sd)) > 1.01 * _least_sd(trial)
    return int(np.count_nonzero(used)) if scatters else 0


def turning(trial: CouponTrial) -> float:
    """Least reversal of the stretch at a turning point."""
    return max(TURN * float(np.ptp(trial.stretch)), NOISE * trial.stretch_sd)


def branches_of(trial: CouponTrial) -> list[Stroke]:
    """Strokes in the order of the record, each with the sign of its net change of stretch (1 if 0)."""
    x = trial.stretch
    found = []
    for s in strokes(x, turning(trial)):
        last = min(s.points.stop, x.size - 1)
        found.append(Stroke(points=s.points, direction=float(np.sign(x[last] - x[s.points.start]) or 1.0)))
    return found


def protocol_window(trials: Sequence[CouponTrial]) -> ProtocolWindow:
    """Range of the times of ramps and holds, and number of peak strains, that tests cover."""
    return window_of(trials, [branches_of(t) for t in trials])


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


def protocol(r: Record) -> tuple[str, int, float, float]:
    """Mode, number of strokes, largest |ln stretch| and median rate [1/s] (0 without a clock)."""
    rates = r.rate[np.isfinite(r.rate)]
    far = float(np.abs(np.log(np.maximum(r.stretch, 1e-3))).max())
    return str(r.mode), len(np.unique(r.branch)), far, float(np.median(rates)) if rates.size else 0.0
