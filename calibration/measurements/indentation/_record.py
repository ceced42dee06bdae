"""The record of one indentation, thinned, with its history: phases, deepest depth before, cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import PokeTrial
from calibration.measurements._records import bins
from calibration.measurements.homogeneous import unstated_sd
from calibration.measurements.indentation._course import Course, bins_over_time, course_of, with_holds
from calibration.measurements.indentation._phases import phases_of, smooth_depth
from calibration.measurements.indentation._scene import (
    Geometry,
    approach,
    block_names,
    geometry_of,
)

Array = NDArray[np.float64]

LEAST = 5  # points that a record needs
# A piece of the way that takes PAUSE times as long as the median piece is a hold.
PIECES, PAUSE = 50, 5.0
MOST = 50  # points that are kept of a phase: more are averaged in bins of neighbours

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
    """The points of one trial, in the order in which they were measured; arrays (k,) unless stated.

    Attributes
    ----------
    name : of the trial.
    blocks : names of its block, by size and with its material.
    geometry : block, indenter and contact point.
    time : [s].
    depth : from first touch [m], negative above the surface.
    force : along the indenter [N].
    across : force across it, along `Geometry.across` [N], shape (k, 2); None where the lab has no vectors.
    count : samples in each point.
    own_sd : of the force [N], without the part that the depth's error adds.
    depth_error : of each point's depth [m], where it keeps its noise.
    depth_sd : of the depth of one sample, and of first touch [m].
    phase : number of the phase.
    labels : of the phases.
    degrees : of the polynomials that the phases' depths were smoothed by; -1 for none.
    direction : +1 loading, 0 hold, -1 unloading.
    cycle : number of the loading, from 1.
    peak : deepest depth at this contact point of this specimen, before and up to each point [m].
    cycle_peak : deepest depth of its cycle up to each point [m].
    unloaded : 1 after the first unloading there, 0 before.
    estimated : the lab states no error of the force.
    ranges : see `calibration.measurements.Record`; of the depth as the lab recorded it.
    course : for materials that remember; None where it was made for others.
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
        """[m], at least 0.1 mm."""
        return max(float(self.depth.max()), 1e-4)

    @property
    def unloads(self) -> bool:
        return bool((self.direction < 0).any())

    @property
    def reloaded(self) -> bool:
        """It was loaded again after an unloading, in this record or in an earlier one."""
        return bool((self.cycle > 1).any() or self.unloaded[0] > 0.0)

    def only(self, kept: NDArray[np.bool_]) -> Record:
        """Some of its points. The force of a material that relaxes depends on all earlier ones."""
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
    """One record a trial. Indentations of one named specimen at one contact point are taken in the order of
    the file: a later one remembers how deep the earlier ones went. courses : for a material that relaxes:
    holds count by their time, and each record begins at rest."""
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
    """Records as far as they are compared.

    Parameters
    ----------
    max_depth : nothing deeper [m]; None for any depth.
    first_loading : only up to the first hold or reversal after first touch.

    Returns
    -------
    The records, and a sentence for each that was shortened.
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
    """Points up to the end of the first loading that goes below the surface, or to a hold on its way, shape
    (k,)."""
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
    """Points before a hold on the way to a depth, if there is one: where a piece of the way takes far too
    long. `phases_of` has no such holds: it takes them for a part of the stroke.

    Parameters
    ----------
    peak : deepest depth so far [m].
    tolerance : depth by which it may wander without going anywhere [m].
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
    """InputError for a record that says nothing of stiffness: it has hardly any point, does not go below the
    surface, or does not push at its deepest."""
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
    own = (
        np.full(depth.size, trial.force_sd)
        if trial.force_sd is not None
        else unstated_sd(raw.time, raw.force, raw.force)
    )
    across = None if raw.force_vector is None else raw.force_vector @ geometry.across.T
    columns: dict[str, list[Array]] = {name: [] for name in (*_ARRAYS, "across")}
    for n, p in enumerate(phases):
        first, count = bins_over_time(raw.time, p, MOST) if courses else bins(p.points, MOST)

        def mean(
            x: Array, points: slice = p.points, first: NDArray[np.intp] = first, count: Array = count
        ) -> Array:
            total = np.add.reduceat(x[points], first, axis=0)
            return np.asarray(total / count.reshape(-1, *([1] * (x.ndim - 1))))

        for name, value in (
            ("time", mean(raw.time)),
            ("depth", mean(depth)),
            ("force", mean(raw.force)),
            ("count", count),
            ("own_sd", mean(own) / np.sqrt(count)),
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
        specimen=trial.specimen or trial.material,
        blocks=block_names(trial),
        geometry=geometry,
        across=None if across is None else sides,
        depth_sd=trial.depth_sd,
        labels=tuple(p.label for p in phases),
        degrees=degrees,
        estimated=trial.force_sd is None,
        ranges={
            "depth_mm": (1e3 * float(raw.depth.min()), 1e3 * float(raw.depth.max())),
            "time_s": (float(raw.time[0]), float(raw.time[-1])),
        },
        course=course_of(raw.time, depth, phases, whole["time"], whole["depth"]) if courses else None,
        **whole,
    )
