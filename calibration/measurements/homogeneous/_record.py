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
from calibration.measurements._course import bins_over_time
from calibration.measurements._records import bins
from calibration.measurements.homogeneous._branches import (
    branches_of,
    loads_again,
    rates_of,
    unloading_points,
)
from calibration.measurements.homogeneous._course import Course, course_of, holds_of, largest_before
from calibration.measurements.homogeneous._point_sd import (
    scatter_points,
    stress_sd,
    with_stretch_error,
    with_stretch_error_over_time,
)
from calibration.measurements.homogeneous.kinematics import first_excess

Array = NDArray[np.float64]
# from the mode and the stretch (k,) of a record's points: mask of those that are compared
Selects = Callable[[CouponMode, Array], NDArray[np.bool_]]

MOST = 100  # largest number of points of a branch: more are averaged in bins of neighbours
SAME_REACH, SAME_RATE = 0.05, 1.2  # relative difference of strain, and ratio of rates, between repeats


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Points of one trial in the order of measurement; all arrays have shape (k,).

    Attributes
    ----------
    name : name of the trial.
    material, specimen : names of both; that of the specimen is the material's if the trial names none.
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
        unloading = unloading_points(trial, b)
        turn[b.points] = np.where(unloading, excess[b.points.start], np.nan)
    raw_time = np.full(excess.size, np.nan) if trial.time is None else trial.time
    peak = np.maximum.accumulate(np.maximum(excess, before))
    raw = {
        "stretch": trial.stretch,
        "stress": trial.stress,
        "time": raw_time,
        "turn": turn,
        "peak": peak,
        "rate": rates_of(trial, parts),
    }
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
        means.append({k: np.add.reduceat((weight * x)[b.points], first) / samples[n] for k, x in raw.items()})
        numbers.append(np.full(first.size, float(n)))
    whole: dict[str, Any] = {name: np.concatenate([m[name] for m in means]) for name in raw}
    kept = selects(trial.mode, whole["stretch"])
    used = np.repeat(kept, np.concatenate(counts).astype(int))
    own_sd = stress_sd(trial, parts, raw_time if timed else trial.stretch, means, counts, samples, used)
    sd = np.concatenate(
        [
            with_stretch_error_over_time(
                trial, b, holds, means[n], firsts[n] - b.points.start, samples[n], own
            )
            if timed
            else with_stretch_error(trial, means[n]["stretch"], means[n]["stress"], samples[n], own)
            for (n, b), own in zip(enumerate(parts), own_sd, strict=True)
        ]
    )
    if not (np.isfinite(sd) & (sd > np.finfo(float).tiny)).all():
        raise InputError(f"trials.{trial.id}: expected some stress that is not 0, or a stated stress_sd_kPa")
    again = before > 0.0 or bool(np.isfinite(turn).any() and loads_again(turn))
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
        scatter_points=scatter_points(trial, sd[kept], used),
        ranges=_ranges(trial, used if used.any() else ~used),
        course=None
        if furthest is None
        else course_of(trial, np.concatenate(firsts), np.concatenate(counts), furthest, holds),
        **whole,
    )


def _ranges(trial: CouponTrial, used: NDArray[np.bool_]) -> dict[str, tuple[float, float]]:
    """Ranges of a trial's points that are compared, by the quantity's name in files."""
    measured = {"stretch": trial.stretch} | ({} if trial.time is None else {"time_s": trial.time})
    return {name: (float(x[used].min()), float(x[used].max())) for name, x in measured.items()}


def protocol(r: Record) -> tuple[str, int, float, float]:
    """Mode, number of strokes, largest |ln stretch| and median rate [1/s] (0 without a clock)."""
    rates = r.rate[np.isfinite(r.rate)]
    far = float(np.abs(np.log(np.maximum(r.stretch, 1e-3))).max())
    return str(r.mode), len(np.unique(r.branch)), far, float(np.median(rates)) if rates.size else 0.0
