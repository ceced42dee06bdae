"""Records of indentations: thinned, with their history (phases, largest earlier depth, cycles)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import PokeTrial, specimen_of
from calibration.measurements._course import bins_over_time
from calibration.measurements._records import bins
from calibration.measurements.homogeneous import SMALLEST_RELATIVE, grows, unstated_sd
from calibration.measurements.indentation._course import Course, course_of, with_holds
from calibration.measurements.indentation._phases import phases_of, smooth_depth
from calibration.measurements.indentation._scene import (
    Geometry,
    approach,
    block_names,
    geometry_of,
)

Array = NDArray[np.float64]

LEAST = 5  # least number of points of a record
# Of PIECES equal parts of the travel, one that takes PAUSE times as long as the median is a hold.
PIECES, PAUSE = 50, 5.0
MOST = 50  # largest number of points of a phase: more are averaged in bins of neighbours

_ARRAYS = (
    "time",
    "depth",
    "force",
    "count",
    "own_sd",
    "depth_error",
    "phase",
    "direction",
    "peak",
    "cycle_peak",
    "cycle",
    "unloaded",
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Points of one trial in the order of measurement; arrays have shape (k,) unless stated.

    Attributes
    ----------
    name : name of the trial.
    material, specimen : names of both; that of the specimen is the material's if the trial names none.
    blocks : names of its block, by size, and by material and size.
    geometry : block, indenter and contact point.
    time : [s].
    depth : depth from first touch [m], negative above the surface.
    force : force along the indenter [N].
    across : forces across it, along `Geometry.across` [N], shape (k, 2); None if the lab has no vectors.
    count : number of samples in each point.
    own_sd : standard deviation of the force [N], without the contribution of the depth's error.
    depth_error : standard deviation of each point's depth [m]; 0 if the depth was smoothed.
    depth_sd : standard deviation of the depth of one sample, and of first touch [m].
    phase : number of the phase.
    labels : labels of the phases.
    degrees : degrees of the polynomials by which the phases' depths were smoothed; -1 for none.
    direction : +1 loading, 0 hold, -1 unloading.
    cycle : number of the loading, from 1.
    peak : largest depth at this contact point of this specimen so far, including earlier trials [m].
    cycle_peak : largest depth of its cycle up to each point [m].
    unloaded : 1 after the first unloading at this contact point, 0 before.
    estimated : True if the lab states no error of the force.
    scatter_points : number of samples from whose scatter it comes; 0 if it is stated, or the least that is
        assumed.
    ranges : see `calibration.measurements._model.Record`; the depth is as recorded by the lab.
    course : loading history, for viscoelastic materials; None otherwise.
    """

    name: str
    material: str
    specimen: str
    blocks: tuple[str, str]
    geometry: Geometry
    time: Array
    depth: Array
    force: Array
    across: Array | None
    count: Array
    own_sd: Array
    depth_error: Array
    depth_sd: float
    phase: Array
    labels: tuple[str, ...]
    degrees: tuple[int, ...]
    direction: Array
    cycle: Array
    peak: Array
    cycle_peak: Array
    unloaded: Array
    estimated: bool
    scatter_points: int
    ranges: Mapping[str, tuple[float, float]]
    course: Course | None = None

    @property
    def points(self) -> int:
        return self.time.size

    @property
    def rod(self) -> str:
        return f"rod {1e3 * self.geometry.rod.radius:g} mm {self.geometry.rod.tip}"

    @cached_property
    def groups(self) -> Mapping[str, str]:
        block, own_block = self.blocks
        return {
            "material": self.material,
            "block": block,
            "material block": own_block,
            "specimen": self.specimen,
            "rod": self.rod,
            "trial": self.name,
        }

    @property
    def deepest(self) -> float:
        """Largest depth [m], at least 0.1 mm."""
        return max(float(self.depth.max()), 1e-4)

    @property
    def unloads(self) -> bool:
        return bool((self.direction < 0).any())

    @property
    def reloaded(self) -> bool:
        """True if it was loaded again after an unloading, in this record or in an earlier one."""
        return bool((self.cycle > 1).any() or self.unloaded[0] > 0.0)

    def only(self, kept: NDArray[np.bool_]) -> Record:
        """Record of a subset of the points (mask); its course keeps the whole loading history."""
        arrays = {name: getattr(self, name)[kept] for name in _ARRAYS}
        across = None if self.across is None else self.across[kept]
        course = None if self.course is None else self.course.only(kept)
        return replace(self, across=across, course=course, **arrays)


def records_of(
    trials: Sequence[PokeTrial],
    geometry: Callable[[PokeTrial], Geometry] = geometry_of,
    *,
    courses: bool = False,
) -> list[Record]:
    """Records of trials, one per trial.

    Indentations of one named specimen at one contact point are taken in the order of the file: `peak` and
    `unloaded` include the earlier ones.

    Parameters
    ----------
    trials : the trials.
    geometry : function from a trial to its geometry.
    courses : True for a viscoelastic material: records have their course, which begins at rest, and the bins
        of holds are spaced by time.
    """
    found: list[Record] = []
    seen: dict[object, float] = {}
    for t in trials:
        own_geometry = geometry(t)
        own = (t.specimen, own_geometry.site) if t.specimen else t.id
        record = _record(t, own_geometry, seen.get(own, 0.0), courses=courses)
        found.append(record)
        seen[own] = max(seen.get(own, 0.0), float(record.peak.max()))
    return found


def part_of(
    records: Sequence[Record], *, max_depth: float | None, first_loading: bool
) -> tuple[list[Record], tuple[str, ...]]:
    """Restrict records to the points that are compared.

    Parameters
    ----------
    records : the records.
    max_depth : largest depth [m]; None for any depth.
    first_loading : if True, only points up to the first hold or reversal after first touch.

    Returns
    -------
    records : list of Record
    sentences : tuple of str
        One for each record that was shortened.
    """
    sentences, shortened = [], []
    for r in records:
        deep = np.zeros(r.points, dtype=bool) if max_depth is None else r.depth > max_depth
        late = ~_first_loading(r) if first_loading else np.zeros(r.points, dtype=bool)
        kept = ~(deep | late)
        if not kept.all():
            why = {
                "after the first loading": int(late.sum()),
                f"deeper than {1e3 * (max_depth or 0.0):g} mm": int((deep & ~late).sum()),
            }
            said = ", ".join(f"{n} {what}" for what, n in why.items() if n)
            sentences.append(f"{r.name}: {np.count_nonzero(~kept)} of {r.points} points are not used: {said}")
            r = r.only(kept)
        shortened.append(r)
    return shortened, tuple(sentences)


def _first_loading(record: Record) -> NDArray[np.bool_]:
    """Mask (k,) of the points up to the end of the first loading below the surface, or to a hold in it."""
    pushed = (record.direction > 0.0) & (record.depth > 0.0)
    if not pushed.any():
        return pushed
    first = int(np.argmax(pushed))
    ended = (np.arange(record.points) > first) & (record.direction <= 0.0)
    end = int(np.argmax(ended)) if ended.any() else record.points
    peak = np.maximum.accumulate(record.depth[first:end])
    tolerance = max(3.0 * record.depth_sd, 1e-3 * float(np.ptp(record.depth)))
    pause = _pause(record.time[first:end], peak, tolerance)
    return np.arange(record.points) < (end if pause is None else first + pause)


def _pause(time: Array, peak: Array, tolerance: float) -> int | None:
    """Number of points before a hold within a loading; None if there is none.

    A hold is a part of the travel that takes much longer than the median (PIECES, PAUSE). `phases_of` counts
    such holds as part of the stroke.

    Parameters
    ----------
    time : [s], shape (k,).
    peak : largest depth so far [m], shape (k,).
    tolerance : scatter of the depth without motion [m].
    """
    grows = np.concatenate([[True], np.diff(peak) > 0.0])
    way = float(peak[-1] - peak[0])
    pieces = int(min(PIECES, way // (2.0 * tolerance), peak.size))
    if pieces < 4:
        return None
    levels = np.linspace(peak[0], peak[-1], pieces + 1)
    stay = np.diff(np.interp(levels, peak[grows], time[grows]))
    long = stay > np.maximum(PAUSE * np.median(stay), 3.0 * np.median(np.diff(time)))
    if not long.any():
        return None
    return max(1, int(np.searchsorted(peak, levels[int(np.argmax(long))], side="right")))


def check_pushed(records: Sequence[Record]) -> None:
    """InputError for a record that does not constrain the stiffness.

    It has fewer than LEAST points, does not go below the surface, or its mean force at the largest depths is
    not positive.
    """
    for r in records:
        if r.points < LEAST:
            raise InputError(
                f"trial {r.name}: record: expected at least {LEAST} points to compare, got {r.points}"
            )
        if not r.depth.max() > 0.0:
            raise InputError(f"trial {r.name}: record: expected a depth beyond the first touch, got none")
        deepest = np.argsort(r.depth)[-max(1, r.points // 5) :]
        if not r.force[deepest].mean() > 0.0:
            raise InputError(f"trial {r.name}: record: expected a force above 0 (pushing) at its deepest")


def _own_sd(trial: PokeTrial, force: Array, count: Array) -> Array:
    """Standard deviation of the means of the forces of a phase [N], shape (k,).

    Unstated, it is that of the scatter of the whole record, and at least a fraction of its largest force for
    any number of averaged samples, as in homogeneous tests: a load cell errs by a fraction of its range.
    """
    if trial.force_sd is not None:
        return np.asarray(trial.force_sd / np.sqrt(count))
    curve = (trial.record.time, trial.record.force)
    return unstated_sd(*curve, force, count, relative=grows([curve]))


def _scatter_points(trial: PokeTrial, own_sd: Array) -> int:
    """See `Record.scatter_points`."""
    force = trial.record.force
    least = SMALLEST_RELATIVE * float(np.abs(force).max())
    return len(force) if trial.force_sd is None and float(np.median(own_sd)) > 1.01 * least else 0


def _record(trial: PokeTrial, geometry: Geometry, before: float, *, courses: bool) -> Record:
    raw = trial.record
    phases = with_holds(trial, phases_of(trial)) if courses else phases_of(trial)
    depth, degrees = smooth_depth(raw.time, raw.depth, phases, trial.depth_sd)
    depth = depth - approach(trial)
    peak = np.maximum.accumulate(np.maximum(depth, before))
    unloaded = np.full(depth.size, float(before > 0.0))
    cycle_peak = np.empty(depth.size)
    for c in {p.cycle for p in phases}:
        mine = np.concatenate([np.arange(p.points.start, p.points.stop) for p in phases if p.cycle == c])
        cycle_peak[mine] = np.maximum.accumulate(np.maximum(depth[mine], 0.0))
    unloading = [p for p in phases if p.direction < 0.0]
    if unloading:
        unloaded[unloading[0].points.start :] = 1.0
    across = None if raw.force_vector is None else raw.force_vector @ geometry.across.T
    columns: dict[str, list[Array]] = {name: [] for name in (*_ARRAYS, "across")}
    for n, p in enumerate(phases):
        held = [p.points] if p.direction == 0.0 else []
        first, count = bins_over_time(raw.time, p.points, held, MOST) if courses else bins(p.points, MOST)

        def mean(
            x: Array, points: slice = p.points, first: NDArray[np.intp] = first, count: Array = count
        ) -> Array:
            total = np.add.reduceat(x[points], first, axis=0)
            return np.asarray(total / count.reshape(-1, *([1] * (x.ndim - 1))))

        force = mean(raw.force)
        for name, value in (
            ("time", mean(raw.time)),
            ("depth", mean(depth)),
            ("force", force),
            ("count", count),
            ("own_sd", _own_sd(trial, force, count)),
            ("phase", np.full(count.size, float(n))),
            ("direction", np.full(count.size, p.direction)),
            ("peak", mean(peak)),
            ("cycle_peak", mean(cycle_peak)),
            ("depth_error", (trial.depth_sd if degrees[n] < 0 else 0.0) / np.sqrt(count)),
            ("cycle", np.full(count.size, float(p.cycle))),
            ("unloaded", (mean(unloaded) > 0.5).astype(float)),
            ("across", np.zeros((count.size, 2)) if across is None else mean(across)),
        ):
            columns[name].append(value)
    whole = {name: np.concatenate(parts) for name, parts in columns.items()}
    sides = whole.pop("across")
    return Record(
        name=trial.id,
        material=trial.material,
        specimen=specimen_of(trial),
        blocks=block_names(trial),
        geometry=geometry,
        across=None if across is None else sides,
        depth_sd=trial.depth_sd,
        labels=tuple(p.label for p in phases),
        degrees=degrees,
        estimated=trial.force_sd is None,
        scatter_points=_scatter_points(trial, whole["own_sd"]),
        ranges={
            "depth_mm": (1e3 * float(raw.depth.min()), 1e3 * float(raw.depth.max())),
            "time_s": (float(raw.time[0]), float(raw.time[-1])),
        },
        course=course_of(raw.time, depth, phases, whole["time"], whole["depth"]) if courses else None,
        **whole,
    )
