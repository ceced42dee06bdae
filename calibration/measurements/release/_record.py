"""Records of cantilever releases: marker displacements before release, in vibration and at equilibrium."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment, Marker, MaterialBelief
from calibration.measurements._records import OfBeam
from calibration.measurements.release._beam import BeamParameters
from calibration.measurements.release.ringdown import ringdown

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Rows = NDArray[np.bool_]

# A marker counts as released after it has moved by MOVED standard deviations and by this fraction of its
# displacement at equilibrium.
MOVED, FURTHER = 10.0, 0.1
FIRST, LAST = 1.2, 12.0  # range of the free vibration that is compared, in periods since the release
FEWEST = 3.0  # least number of these periods in a record
BIN = 6.0  # least number of means per period
BLOCKS = 8  # number of means after the vibration, equidistant in the logarithm of time
NEAR = 0.5  # distance from the clamp, in heights of the section, within which markers may sit on the clamp
DIRECTIONS_DIFFER = 1e-3  # largest angle between the tip force of a hung mass and gravity [rad]


@dataclass(frozen=True, eq=False, kw_only=True)
class Sampled:
    """Means of one marker's samples in b groups.

    Attributes
    ----------
    index : indices of its samples among the record's times.
    starts : first sample of each group, an index into `index`, shape (b,).
    counts : number of samples in each group, shape (b,).
    measured : mean displacement of each group in x and z [m], shape (b, 2).
    """

    index: Index
    starts: Index
    counts: Array
    measured: Array

    def means(self, values: Array) -> Array:
        """Means (b, 2) of values (t, 2) given at all times of the record."""
        return np.asarray(np.add.reduceat(values[self.index], self.starts, axis=0) / self.counts[:, None])


class OfMarkers(OfBeam):
    """Attributes of a record of markers by its trial."""

    @property
    def name(self) -> str:
        return self.trial.id

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        times = [c.time for c in self.trial.captures if c.outline is not None]
        times += [float(m.time[-1]) for m in self.trial.markers]
        return self._ranges(times)


@dataclass(frozen=True, eq=False, kw_only=True)
class Record(OfMarkers):
    """The markers of one trial.

    Its rows are, for each marker in x and then in z, the sample before the release and the means after it.

    Attributes
    ----------
    trial : the trial.
    parameters : parameters of its beam, without modulus and damping.
    names : names of the m markers.
    positions : (x, z) of each marker on the straight beam [m].
    across : y of each marker [m], shape (m,).
    near_clamp : True for markers that may sit on the clamp, shape (m,).
    time : times of the samples of all markers [s], shape (t,).
    sampled : means of each marker's samples.
    held : displacement in the first sample, before the release [m], shape (m, 2); NaN if unknown.
    release_time : first guess of the release time [s].
    period : period of the free vibration [s].
    damping_ratio : damping ratio of the free vibration.
    equilibrium : mean displacement in the last fifth of the record [m], shape (m, 2).
    sd : standard deviation of one sample [m].
    """

    trial: BeamTrial
    parameters: BeamParameters
    names: tuple[str, ...]
    positions: tuple[tuple[float, float], ...]
    across: Array
    near_clamp: Rows
    time: Array
    sampled: tuple[Sampled, ...]
    held: Array
    release_time: float
    period: float
    damping_ratio: float
    equilibrium: Array
    sd: float

    @property
    def relaxation_time(self) -> float:
        """Relaxation time of the stiffness-proportional damping with this damping ratio [s]."""
        return self.damping_ratio * self.period / np.pi

    @property
    def loaded(self) -> bool:
        return self.parameters.tip_mass > 0.0

    @property
    def load(self) -> str:
        """Label of the load on the free end."""
        return f"{1e3 * self.parameters.tip_mass:.3g} g hung" if self.loaded else "own weight"

    @cached_property
    def groups(self) -> Mapping[str, str]:
        return {
            "material": self.material,
            "specimen": self.specimen,
            "load": self.load,
            "trial": self.name,
        }

    @property
    def behind_face(self) -> Rows:
        """True for markers behind the clamp's face, which certainly sit on the clamp, shape (m,)."""
        return np.array([x < 0.0 for x, _ in self.positions])

    @property
    def outer(self) -> Rows:
        """True for markers of the outer half of the beam, shape (m,)."""
        return np.array([x > 0.5 * self.parameters.length for x, _ in self.positions])

    @cached_property
    def points(self) -> int:
        """Number of rows."""
        return 2 * sum(1 + len(s.starts) for s in self.sampled)

    def rows(self, of_time: Callable[[int], Array], held: Array) -> Array:
        """Rows of all markers from their displacements.

        Parameters
        ----------
        of_time : function from a marker's index to its displacement at the record's times, shape (t, 2).
        held : displacement before the release, shape (m, 2).
        """
        parts = []
        for i, s in enumerate(self.sampled):
            means = s.means(of_time(i))
            for axis in range(2):
                parts.append(np.concatenate([held[i : i + 1, axis], means[:, axis]]))
        return np.concatenate(parts)

    def measured(self) -> Array:
        """Measured displacement of each row [m]."""
        parts = []
        for i, s in enumerate(self.sampled):
            for axis in range(2):
                parts.append(np.concatenate([self.held[i : i + 1, axis], s.measured[:, axis]]))
        return np.concatenate(parts)

    def measuring(self, rows: Array) -> Record:
        """Record with other measured values in its rows; unknown ones before the release stay unknown."""
        held, sampled, first = self.held.copy(), [], 0
        for i, s in enumerate(self.sampled):
            n = 1 + len(s.starts)
            both = rows[first : first + 2 * n].reshape(2, n)
            held[i] = np.where(np.isfinite(self.held[i]), both[:, 0], np.nan)
            sampled.append(replace(s, measured=both[:, 1:].T))
            first += 2 * n
        return replace(self, held=held, sampled=tuple(sampled))

    def longer(self, factor: float) -> Record:
        """Record whose part after the free vibration lasts `factor` times as long."""
        if factor == 1.0:
            return self
        since = self.time - self.release_time
        late = since > LAST * self.period
        time = self.time + np.where(late, (factor - 1.0) * (since - LAST * self.period), 0.0)
        return replace(self, time=time)

    def labels(self) -> tuple[Index, Index, Array]:
        """Marker, axis (0 x, 1 z) and mean time since the guessed release [s] of each row.

        The time is NaN for the sample before the release.
        """
        marker, axis, time = [], [], []
        for i, s in enumerate(self.sampled):
            mean = s.means(np.column_stack([self.time, self.time]))[:, 0] - self.release_time
            for a in range(2):
                n = 1 + len(s.starts)
                marker.append(np.full(n, i))
                axis.append(np.full(n, a))
                time.append(np.concatenate([[np.nan], mean]))
        return np.concatenate(marker), np.concatenate(axis), np.concatenate(time)

    def deviations(self) -> Array:
        """Standard deviation of each row by white noise [m]; inf for rows without a measurement."""
        parts = []
        for i, s in enumerate(self.sampled):
            for axis in range(2):
                first = self.sd if np.isfinite(self.held[i, axis]) else np.inf
                parts.append(np.concatenate([[first], self.sd / np.sqrt(s.counts)]))
        return np.concatenate(parts)


def hung_mass(trial: BeamTrial) -> float:
    """Mass whose weight is the trial's tip force [kg]; InputError if the force is not along gravity."""
    force, gravity = np.asarray(trial.tip_force), np.asarray(trial.gravity)
    pull, g = float(np.linalg.norm(force)), float(np.linalg.norm(gravity))
    if pull == 0.0:
        return 0.0
    if g == 0.0 or float(np.linalg.norm(force / pull - gravity / g)) > DIRECTIONS_DIFFER:
        raise InputError(
            f"experiment.yaml: trials.{trial.id}.tip_force_N: expected a force along gravity for a hung mass;"
            " give the mass that moves with the tip"
        )
    return pull / g


def stated_density(trial: BeamTrial, belief: MaterialBelief) -> float:
    """Density [kg/m3]; InputError if the lab does not state it."""
    if belief.density is None:
        raise InputError(
            f"experiment.yaml: materials.{trial.material}.density_kg_m3: expected, since its weight bends"
            f" {trial.id}"
        )
    return belief.density


def stated_noise(trial: BeamTrial) -> float:
    """Standard deviation of a marker's displacement [m]; InputError if the lab does not state it."""
    if trial.marker_sd is None or not trial.marker_sd > 0.0:
        raise InputError(
            f"experiment.yaml: trials.{trial.id}.marker_sd_mm: expected above 0 to weigh markers by"
        )
    return trial.marker_sd


def chosen_markers(trial: BeamTrial, names: Sequence[str] | None) -> tuple[Marker, ...]:
    """Markers of these names (None for all); InputError if there are none, or a name is unknown."""
    known = {m.name: m for m in trial.markers}
    if not known:
        raise InputError(f"experiment.yaml: trials.{trial.id}.markers: expected markers, got none")
    for name in names or ():
        if name not in known:
            raise InputError(
                f"experiment.yaml: trials.{trial.id}.markers: expected {name} among"
                f" {', '.join(sorted(known))}"
            )
    return tuple(known.values()) if names is None else tuple(known[n] for n in names)


def records_of(experiment: Experiment) -> list[Record]:
    """Records of all trials with markers; the InputError for an incomplete trial names what it lacks."""
    trials = [t for t in experiment.trials if isinstance(t, BeamTrial) and t.markers]
    return [_record(t, experiment) for t in trials]


def why_no_record(trial: BeamTrial, experiment: Experiment) -> str:
    """Reason (the message of `records_of`) why a trial with markers has no record; "" if it has one."""
    try:
        _record(trial, experiment)
    except InputError as problem:
        return str(problem)
    return ""


def _record(trial: BeamTrial, experiment: Experiment) -> Record:
    where = f"experiment.yaml: trials.{trial.id}"
    if trial.supports != "clamped-free":
        raise InputError(f"{where}.supports: expected clamped-free for markers through time")
    density = stated_density(trial, experiment.materials[trial.material])
    sd = stated_noise(trial)
    parameters = BeamParameters(
        section=trial.section,
        shear_modulus=1.0,
        density=density,
        length=trial.free_length,
        gravity=(trial.gravity[0], trial.gravity[2]),
        tip_force=(trial.tip_force[0], trial.tip_force[2]),
        tip_mass=hung_mass(trial),
        load_height=trial.tip_force_height,
    )
    outer = [m for m in trial.markers if m.position[0] > 0.5 * trial.free_length]
    if not outer:
        raise InputError(f"{where}.marker_positions_mm: expected a marker on the beam's outer half")
    moved = _first_moved(trial, sd)
    if moved is None:
        raise InputError(f"{where}.markers: expected a release, but no marker of the outer half moves")
    interval = float(np.median(np.diff(outer[0].time)))
    release_time = moved - interval
    time, drop = outer[0].time - release_time, outer[0].displacement[:, 2]
    try:
        ring = ringdown(time, drop, first=3.0 * interval, last=3.0)
    except ValueError as problem:
        raise InputError(f"{where}.markers: {problem}") from None
    period = 1.0 / ring.frequency
    if time[-1] < (FIRST + FEWEST) * period:
        raise InputError(
            f"{where}.markers: expected {FIRST + FEWEST:g} periods of free vibration after the release"
            f" ({(FIRST + FEWEST) * period:.2g} s), got {max(time[-1], 0.0):.2g} s"
        )
    height = 2.0 * trial.section.half_height
    near = np.array([m.position[0] < NEAR * height for m in trial.markers])
    every = np.unique(np.concatenate([m.time for m in trial.markers]))
    sampled, held, equilibrium = [], [], []
    for m, close in zip(trial.markers, near, strict=True):
        plane = m.displacement[:, [0, 2]]
        sampled.append(_means(m.time - release_time, plane, np.searchsorted(every, m.time), period, where))
        # a marker at the clamp can slip at the release: only its motion is compared
        still = m.time[0] < moved - interval and not close
        held.append(plane[0] if still else np.full(2, np.nan))
        equilibrium.append(plane[m.time > m.time[-1] - 0.2 * (m.time[-1] - release_time)].mean(axis=0))
    return Record(
        trial=trial,
        parameters=parameters,
        names=tuple(m.name for m in trial.markers),
        positions=tuple((m.position[0], m.position[2]) for m in trial.markers),
        across=np.array([m.position[1] for m in trial.markers]),
        near_clamp=near,
        time=every,
        sampled=tuple(sampled),
        held=np.array(held),
        release_time=release_time,
        period=period,
        damping_ratio=max(ring.damping_ratio, 1e-3),
        equilibrium=np.array(equilibrium),
        sd=sd,
    )


def _first_moved(trial: BeamTrial, sd: float) -> float | None:
    """First time at which a marker of the outer half has clearly moved [s]; None if none moves."""
    signs = []
    for m in trial.markers:
        if m.position[0] > 0.5 * trial.free_length:
            away = np.abs(m.displacement[:, 2] - m.displacement[0, 2])
            clear = max(MOVED * sd, FURTHER * abs(float(m.displacement[-1, 2])))
            hit = np.flatnonzero(away > clear)
            if hit.size:
                signs.append(float(m.time[hit[0]]))
    return min(signs) if signs else None


def _means(time: Array, plane: Array, index: Index, period: float, where: str) -> Sampled:
    """Means of a marker's samples over groups.

    Groups are equidistant in time during the free vibration, and in the logarithm of time after it.
    InputError for fewer than ten samples in the vibration.
    """
    vibrating = np.flatnonzero((time > FIRST * period) & (time <= LAST * period))
    later = np.flatnonzero(time > LAST * period)
    if vibrating.size < 10:
        raise InputError(f"{where}.markers: expected ten samples of each marker in its free vibration")
    step = float(np.median(np.diff(time[vibrating])))
    size = max(int(period / BIN / step), 1)
    starts = list(vibrating[::size])
    if later.size:
        edges = np.geomspace(time[later[0]], time[later[-1]] * (1.0 + 1e-9), BLOCKS + 1)[:-1]
        starts += sorted(set(later[0] + np.searchsorted(time[later], edges)))
    first, used = vibrating[0], slice(vibrating[0], None)
    counts = np.diff([*starts, len(time)]).astype(float)
    begin = np.array(starts) - first
    measured = np.add.reduceat(plane[used], begin, axis=0) / counts[:, None]
    return Sampled(index=index[used], starts=begin, counts=counts, measured=measured)


def reference_time(records: Sequence[Record]) -> float:
    """Geometric mean of the records' periods over 2 pi [s]."""
    return float(np.exp(np.mean(np.log([r.period for r in records])))) / (2.0 * np.pi)
