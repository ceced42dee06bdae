"""What a trial's markers say: held, swinging and settled, in means of neighbouring samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._setting import Setting
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment
from calibration.motion import hung_mass, ringdown
from tisim import Circle

Array = NDArray[np.float64]
Index = NDArray[np.int64]

MOVED, FURTHER = 10.0, 0.1  # sd, and part of the way to rest, that tell that a marker has been let go
FIRST, LAST = 1.2, 12.0  # periods since the release between which the swing is looked at
FEWEST = 3.0  # of them that a record must hold
BIN = 6.0  # means a period, at least
BLOCKS = 8  # of what comes after the swing, even in the logarithm of time
NEAR = 0.5  # heights: markers so near to the clamp may sit on it


@dataclass(frozen=True, eq=False, kw_only=True)
class Sampled:
    """One marker: means of its samples `index` of the record's times, each group from one of `starts`; what
    was measured in them, (b, 2) [m] in x and z, and how many samples each holds."""

    index: Index
    starts: Index
    counts: Array
    measured: Array

    def means(self, values: Array) -> Array:
        """(t, 2) at all of the record's times to (b, 2)."""
        return np.asarray(np.add.reduceat(values[self.index], self.starts, axis=0) / self.counts[:, None])


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """A trial as the search sees it. setting: of its bar, but for the modulus and the damping.

    time (t,): of all samples used [s]; places: (x, z) of each marker [m], across: its y; near: which markers
    may sit on the clamp. released: first guess [s]; period: of the swing [s]; ratio: its damping ratio.
    settled: where the markers end, (m, 2). held: (m, 2) in the first sample, still held; NaN where it says
    nothing.
    """

    trial: BeamTrial
    setting: Setting
    names: tuple[str, ...]
    places: tuple[tuple[float, float], ...]
    across: Array
    near: NDArray[np.bool_]
    time: Array
    sampled: tuple[Sampled, ...]
    held: Array
    released: float
    period: float
    ratio: float
    settled: Array
    sd: float

    @property
    def name(self) -> str:
        return self.trial.id

    @property
    def specimen(self) -> str:
        return self.trial.specimen or self.trial.material

    @property
    def loaded(self) -> bool:
        return self.setting.tip_mass > 0.0

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Markers behind the clamp's face, which sit on it for sure."""
        return np.array([x < 0.0 for x, _ in self.places])

    @property
    def tips(self) -> NDArray[np.bool_]:
        """Markers of the outer half."""
        return np.array([x > 0.5 * self.setting.length for x, _ in self.places])

    def flat(self, of_time: Callable[[int], Array], held: Array) -> Array:
        """Rows of all markers: of each in x, then in z, the held sample and the means. of_time: (t, 2) of a
        marker by number; held: (m, 2)."""
        parts = []
        for i, s in enumerate(self.sampled):
            means = s.means(of_time(i))
            for axis in range(2):
                parts.append(np.concatenate([held[i : i + 1, axis], means[:, axis]]))
        return np.concatenate(parts)

    def measured(self) -> Array:
        parts = []
        for i, s in enumerate(self.sampled):
            for axis in range(2):
                parts.append(np.concatenate([self.held[i : i + 1, axis], s.measured[:, axis]]))
        return np.concatenate(parts)

    def measuring(self, rows: Array) -> Record:
        """The record with other values in its rows."""
        held, sampled, first = self.held.copy(), [], 0
        for i, s in enumerate(self.sampled):
            n = 1 + len(s.starts)
            both = rows[first : first + 2 * n].reshape(2, n)
            held[i] = np.where(np.isfinite(self.held[i]), both[:, 0], np.nan)
            sampled.append(replace(s, measured=both[:, 1:].T))
            first += 2 * n
        return replace(self, held=held, sampled=tuple(sampled))

    def labels(self) -> tuple[Index, Index, Array]:
        """Of each row: marker, axis (0 x, 1 z), mean time since the guessed release (NaN: held)."""
        marker, axis, time = [], [], []
        for i, s in enumerate(self.sampled):
            mean = s.means(np.column_stack([self.time, self.time]))[:, 0] - self.released
            for a in range(2):
                n = 1 + len(s.starts)
                marker.append(np.full(n, i))
                axis.append(np.full(n, a))
                time.append(np.concatenate([[np.nan], mean]))
        return np.concatenate(marker), np.concatenate(axis), np.concatenate(time)

    def deviations(self) -> Array:
        """Standard deviation of each row by white noise [m]; inf where there is no measurement."""
        parts = []
        for i, s in enumerate(self.sampled):
            for axis in range(2):
                first = self.sd if np.isfinite(self.held[i, axis]) else np.inf
                parts.append(np.concatenate([[first], self.sd / np.sqrt(s.counts)]))
        return np.concatenate(parts)


def holds_let_go(experiment: Experiment) -> bool:
    """Whether a beam has markers through time."""
    return any(isinstance(t, BeamTrial) and t.markers for t in experiment.trials)


def all_let_go(experiment: Experiment) -> bool:
    """Whether beams have these, and none was traced."""
    beams = [t for t in experiment.trials if isinstance(t, BeamTrial)]
    return holds_let_go(experiment) and not any(c.outline for t in beams for c in t.captures)


def records_of(experiment: Experiment) -> list[Record]:
    """Of all trials with markers; InputError names what one of them lacks."""
    trials = [t for t in experiment.trials if isinstance(t, BeamTrial) and t.markers]
    return [_record(t, experiment) for t in trials]


def _record(trial: BeamTrial, experiment: Experiment) -> Record:
    where = f"experiment.yaml: trials.{trial.id}"
    belief = experiment.materials[trial.material]
    if trial.supports != "clamped-free":
        raise InputError(f"{where}.supports: expected clamped-free for markers through time")
    if belief.density is None:
        raise InputError(
            f"experiment.yaml: materials.{trial.material}.density_kg_m3: expected, since its weight bends"
            f" {trial.id}"
        )
    if trial.marker_sd is None or not trial.marker_sd > 0.0:
        raise InputError(f"{where}.marker_sd_mm: expected above 0 to weigh markers by")
    setting = Setting(
        section=trial.section,
        shear=1.0,
        density=belief.density,
        length=trial.free_length,
        gravity=(trial.gravity[0], trial.gravity[2]),
        tip_force=(trial.tip_force[0], trial.tip_force[2]),
        tip_mass=hung_mass(trial),
    )
    outer = [m for m in trial.markers if m.position[0] > 0.5 * trial.free_length]
    if not outer:
        raise InputError(f"{where}.marker_positions_mm: expected a marker on the bar's outer half")
    moved = _first_moved(trial)
    if moved is None:
        raise InputError(f"{where}.markers: expected a release, but no marker of the outer half moves")
    interval = float(np.median(np.diff(outer[0].time)))
    released = moved - interval
    time, drop = outer[0].time - released, outer[0].displacement[:, 2]
    try:
        ring = ringdown(time, drop, first=3.0 * interval, last=3.0)
    except ValueError as problem:
        raise InputError(f"{where}.markers: {problem}") from None
    period = 1.0 / ring.frequency
    if time[-1] < (FIRST + FEWEST) * period:
        raise InputError(
            f"{where}.markers: expected {FIRST + FEWEST:g} periods of the swing after the release"
            f" ({(FIRST + FEWEST) * period:.2g} s), got {max(time[-1], 0.0):.2g} s"
        )
    height = 2.0 * trial.section.radius if isinstance(trial.section, Circle) else trial.section.height
    near = np.array([m.position[0] < NEAR * height for m in trial.markers])
    every = np.unique(np.concatenate([m.time for m in trial.markers]))
    sampled, held, settled = [], [], []
    for m, close in zip(trial.markers, near, strict=True):
        plane = m.displacement[:, [0, 2]]
        sampled.append(_means(m.time - released, plane, np.searchsorted(every, m.time), period, where))
        # what sits at the clamp may slip when the bar is let go: only its motion speaks
        still = m.time[0] < moved - interval and not close
        held.append(plane[0] if still else np.full(2, np.nan))
        settled.append(plane[m.time > m.time[-1] - 0.2 * (m.time[-1] - released)].mean(axis=0))
    return Record(
        trial=trial,
        setting=setting,
        names=tuple(m.name for m in trial.markers),
        places=tuple((m.position[0], m.position[2]) for m in trial.markers),
        across=np.array([m.position[1] for m in trial.markers]),
        near=near,
        time=every,
        sampled=tuple(sampled),
        held=np.array(held),
        released=released,
        period=period,
        ratio=max(ring.damping_ratio, 1e-3),
        settled=np.array(settled),
        sd=trial.marker_sd,
    )


def _first_moved(trial: BeamTrial) -> float | None:
    assert trial.marker_sd is not None
    signs = []
    for m in trial.markers:
        if m.position[0] > 0.5 * trial.free_length:
            away = np.abs(m.displacement[:, 2] - m.displacement[0, 2])
            clear = max(MOVED * trial.marker_sd, FURTHER * abs(float(m.displacement[-1, 2])))
            hit = np.flatnonzero(away > clear)
            if hit.size:
                signs.append(float(m.time[hit[0]]))
    return min(signs) if signs else None


def _means(time: Array, plane: Array, index: Index, period: float, where: str) -> Sampled:
    """Groups of a marker's samples: of the swing even in time, of what comes after even in its logarithm."""
    ringing = np.flatnonzero((time > FIRST * period) & (time <= LAST * period))
    later = np.flatnonzero(time > LAST * period)
    if ringing.size < 10:
        raise InputError(f"{where}.markers: expected ten samples of each marker in its swing")
    step = float(np.median(np.diff(time[ringing])))
    size = max(int(period / BIN / step), 1)
    starts = list(ringing[::size])
    if later.size:
        edges = np.geomspace(time[later[0]], time[later[-1]] * (1.0 + 1e-9), BLOCKS + 1)[:-1]
        starts += sorted(set(later[0] + np.searchsorted(time[later], edges)))
    first, used = ringing[0], slice(ringing[0], None)
    counts = np.diff([*starts, len(time)]).astype(float)
    begin = np.array(starts) - first
    measured = np.add.reduceat(plane[used], begin, axis=0) / counts[:, None]
    return Sampled(index=index[used], starts=begin, counts=counts, measured=measured)


def further(record: Record, stretch: float) -> Record:
    """The record as if it had gone on, after its swing, for so many times as long."""
    if stretch == 1.0:
        return record
    since = record.time - record.released
    late = since > LAST * record.period
    time = record.time + np.where(late, (stretch - 1.0) * (since - LAST * record.period), 0.0)
    return replace(record, time=time)


def groups_of(records: Sequence[Record]) -> dict[str, list[int]]:
    """Records by what hangs on their bars."""
    found: dict[str, list[int]] = {}
    for k, r in enumerate(records):
        load = f"{1e3 * r.setting.tip_mass:.3g} g hung" if r.loaded else "own weight"
        found.setdefault(load, []).append(k)
    return found
