"""Forward map of cantilever releases: coordinates other than the moduli, simulated rows of each record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._baseline import Baseline, Extra
from calibration.measurements.release._beam import BeamParameters, Pair
from calibration.measurements.release._fem import Correction
from calibration.measurements.release._record import LAST, Record
from calibration.measurements.release._vibration import beam_markers, clamp_markers, free_vibration
from calibration.measurements.release.experiments import unchanged
from tisim.parts import Spectrum

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

# unit of a trial's own coordinates: release time [s], and start as a fraction of the equilibrium
RELEASE = 0.01
START = 0.1
RELEASE_SD, START_SD = 0.03, 0.2  # sd of their priors [s], [-]
RELAXATION_TIME, RELAXATION_SD = 2e-3, 3.0  # centre [s] of the prior, and sd of the logarithm
WITH_CLAMP, WITH_CLAMP_SD = 0.5, 0.5  # centre and sd of the fraction by which markers move with the clamp
# Error of ln G between loads: the unit of the coordinate, and the sd, from the error of the reduced beam (its
# frequency differs from FEM's by 0.1 to 0.3 %). Its effect on the phase of the last periods is too large for
# a linear nuisance.
LOAD, LOAD_SD = 0.02, 0.003
# Largest phase difference at the end of the vibration, in periods; beyond it a search does not converge.
OUT_OF_PHASE = 0.4
REMEMBERED = 400  # cached results
DRAG_SD = 3.0  # sd of the mass-proportional damping by the hung mass [1/s]
ELASTIC = Spectrum(equilibrium=1.0, strengths=np.zeros(0), times=np.zeros(0))


@dataclass(frozen=True, kw_only=True)
class Own:
    """Unknowns of one record.

    Attributes
    ----------
    release_time : [s].
    start : shape at the release, as a fraction of the equilibrium.
    with_clamp : fraction by which markers next to the clamp move with it.
    drag : mass-proportional damping by the hung mass [1/s].
    """

    release_time: float
    start: float
    with_clamp: float
    drag: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Coordinates:
    """Extras of a baseline for cantilever releases.

    In this order: ln(relaxation time / 1 s) of each material, unless its law has a spectrum (`tisim.Prony`),
    which causes damping itself; for each trial the release time (unit 10 ms, relative to the first guess) and
    the start (unit 0.1 of the equilibrium); the reduced beam's error at each load except the first (unit
    0.02 in ln G); if the law has a spectrum, for each trial with a hung mass the damping by the suspension,
    which is not a property of the material; for each specimen with markers next to the clamp, the fraction by
    which they move with the clamp.

    Attributes
    ----------
    baseline : baseline with these extras.
    trials, loads : names.
    dragged : trials with a damping by the hung mass.
    near : specimens with markers next to the clamp.
    """

    baseline: Baseline
    trials: tuple[str, ...]
    loads: tuple[str, ...]
    dragged: tuple[str, ...]
    near: tuple[str, ...]

    @classmethod
    def of(cls, records: Sequence[Record], plain: Baseline) -> Coordinates:
        """Add the extras of these records to a plain baseline."""
        trials = tuple(r.name for r in records)
        loads = tuple(dict.fromkeys(r.load for r in records))
        dragged = tuple(r.name for r in records if r.loaded and viscous(plain))
        near = tuple(dict.fromkeys(r.specimen for r in records if (r.near_clamp & ~r.behind_face).any()))
        extras = [
            *(
                Extra(name=f"{m} relaxation time", sd=RELAXATION_SD, centre=float(np.log(RELAXATION_TIME)))
                for m in plain.materials
                if not viscous(plain)
            ),
            *(
                Extra(name=f"{t} {quantity}", sd=sd)
                for t in trials
                for quantity, sd in (("release", RELEASE_SD / RELEASE), ("start", START_SD / START))
            ),
            *(Extra(name=f"error with {load}", sd=LOAD_SD / LOAD) for load in loads[1:]),
            *(Extra(name=f"{t} drag", sd=DRAG_SD) for t in dragged),
            *(Extra(name=f"{s} fraction with the clamp", sd=WITH_CLAMP_SD, centre=WITH_CLAMP) for s in near),
        ]
        return cls(baseline=plain.with_extras(extras), trials=trials, loads=loads, dragged=dragged, near=near)

    def shear_modulus(self, record: Record, u: Array) -> float:
        """Shear modulus of a record's beam [Pa], including the error of its load.

        It is the long-time modulus if the material has a spectrum.
        """
        error = LOAD * float(u[self.of_load(record.load)]) if record.load != self.loads[0] else 0.0
        return self.baseline.shear_modulus(record.specimen, u) * float(np.exp(error))

    def relaxation_time(self, record: Record, u: Array) -> float:
        """Relaxation time of a record's material [s]; 0 if it has a spectrum."""
        return 0.0 if viscous(self.baseline) else float(np.exp(u[self.of_material(record.material)]))

    def spectrum(self, record: Record, u: Array) -> Spectrum:
        """Relaxation spectrum of a record's material, relative to its long-time modulus."""
        if not viscous(self.baseline):
            return ELASTIC
        found = self.baseline.material(record.specimen, u).viscosity
        assert found is not None
        return found.spectrum()

    def own(self, record: Record, u: Array) -> Own:
        """Unknowns of a record at coordinates u (n,)."""
        first = self.of_trial(record)
        fraction = 0.0
        if record.specimen in self.near:
            fraction = float(u[self._of_near(record.specimen)])
        return Own(
            release_time=record.release_time + RELEASE * float(u[first]),
            start=START * float(u[first + 1]),
            with_clamp=fraction,
            drag=float(u[self._of_drag(record)]) if record.name in self.dragged else 0.0,
        )

    def constrained(
        self, records: Sequence[Record], compared: Rows, vibrating: Rows, row_record: NDArray[np.intp]
    ) -> Rows:
        """Mask (n,) of the coordinates that given rows constrain.

        The coordinates of a trial are constrained by its free vibration only; those of markers next to the
        clamp count as constrained always.

        Parameters
        ----------
        records : the records.
        compared : mask of the rows in use, shape (rows,).
        vibrating : mask of the rows of the free vibration, shape (rows,).
        row_record : index of the record of each row, shape (rows,).
        """
        found = np.zeros(len(self.baseline.names), dtype=bool)
        found[len(found) - len(self.near) :] = True
        for k, r in enumerate(records):
            mine = compared & (row_record == k)
            if mine.any():
                found |= self.baseline.informed_by(r, whole_material=False)
                found[self.of_material(r.material)] |= not viscous(self.baseline)
                if r.load != self.loads[0]:
                    found[self.of_load(r.load)] = True
            if (mine & vibrating).any():
                first = self.of_trial(r)
                found[first : first + 2] = True
                if r.name in self.dragged:
                    found[self._of_drag(r)] = True
        return found

    def depended_on(self, record: Record) -> Rows:
        """Mask (n,) of the coordinates on which the simulation of a record depends."""
        found = self.baseline.informed_by(record, whole_material=False)
        found[self.of_material(record.material)] |= not viscous(self.baseline)
        first = self.of_trial(record)
        found[first : first + 2] = True
        if record.load != self.loads[0]:
            found[self.of_load(record.load)] = True
        if record.name in self.dragged:
            found[self._of_drag(record)] = True
        if record.specimen in self.near:
            found[self._of_near(record.specimen)] = True
        return found

    def of_material(self, material: str) -> int:
        """Index of a material's relaxation time, if it has no spectrum."""
        return self.baseline.first_extra + self.baseline.materials.index(material)

    def of_trial(self, record: Record) -> int:
        """Index of the first coordinate of a record's trial."""
        begin = self.baseline.first_extra
        if not viscous(self.baseline):
            begin += len(self.baseline.materials)
        return begin + 2 * self.trials.index(record.name)

    def of_load(self, load: str) -> int:
        """Index of the error at a load other than the first."""
        end = len(self.baseline.names) - len(self.near) - len(self.dragged)
        return end - len(self.loads) + self.loads.index(load)

    def _of_drag(self, record: Record) -> int:
        """Index of the damping by the hung mass of a trial."""
        end = len(self.baseline.names) - len(self.near)
        return end - len(self.dragged) + self.dragged.index(record.name)

    def _of_near(self, specimen: str) -> int:
        """Index of the fraction by which a specimen's markers move with the clamp."""
        return len(self.baseline.names) - len(self.near) + self.near.index(specimen)


def viscous(baseline: Baseline) -> bool:
    """True if the baseline's law has a relaxation spectrum."""
    return any(p.field == "viscosity" for p in baseline.law.parts)


def at_frequency(
    long_time: float, spectrum: Spectrum, reference_time: float
) -> tuple[float, tuple[Pair, ...]]:
    """Storage modulus [Pa] at the angular frequency 1 / `reference_time`, and branches relative to it.

    The branches are those of `BeamParameters.branches`. long_time : long-time modulus [Pa].
    """
    ratio = np.asarray(spectrum.times) / reference_time
    strengths = np.asarray(spectrum.strengths)
    storage = float(spectrum.equilibrium + np.sum(strengths * ratio**2 / (1.0 + ratio**2)))
    parts = [float(g) for g in strengths / storage]
    branches = tuple((g, float(t)) for g, t in zip(parts, spectrum.times, strict=True) if g != 0.0)
    return long_time * storage, branches


@dataclass(frozen=True, eq=False, kw_only=True)
class ForwardMap:
    """Simulated rows of each record.

    Attributes
    ----------
    records : the records.
    coordinates : definition of u.
    corrections : correction of each record by FEM.
    reference_time : reference time of all beams [s]; see `BeamParameters`.
    changed : function to the parameters in a predicted experiment; unless it is `unchanged`, the vibration
        need not be in phase with the record's.
    """

    records: Sequence[Record]
    coordinates: Coordinates
    corrections: Sequence[Correction]
    reference_time: float
    changed: Callable[[BeamParameters], BeamParameters] = unchanged
    _known: dict[object, Array] = field(default_factory=dict, init=False, repr=False)

    def baseline_parameters(self, k: int, u: Array) -> BeamParameters:
        """Parameters of a record's beam without effects."""
        r = self.records[k]
        shear, branches = at_frequency(
            self.coordinates.shear_modulus(r, u), self.coordinates.spectrum(r, u), self.reference_time
        )
        return replace(
            r.parameters,
            shear_modulus=shear,
            branches=branches,
            relaxation_time=self.coordinates.relaxation_time(r, u),
            stiff_root=self.corrections[k].stiff_root,
            reference_time=self.reference_time,
            extra_inertia=self.corrections[k].extra_inertia,
            mass_damping=self.own(k, u).drag,
        )

    def own(self, k: int, u: Array) -> Own:
        return self.coordinates.own(self.records[k], u)

    def rows(self, k: int, parameters: BeamParameters, own: Own) -> Array:
        """Simulated rows of record `k` [m], without nuisances.

        Results are cached, since most coordinates belong to other records. ValueError if the beam has no
        stable equilibrium, or its vibration gets out of phase with the record.
        """
        key = (k, parameters, own)
        if key not in self._known:
            if len(self._known) >= REMEMBERED:
                self._known.pop(next(iter(self._known)))
            r = self.records[k]
            moved = self._displacements(k, parameters, own, r.time - own.release_time)
            self._known[key] = r.rows(lambda i: moved[i], np.zeros((len(r.positions), 2)))
        return self._known[key]

    def tip_height(self, k: int, parameters: BeamParameters, own: Own, time: Array) -> Array:
        """Mean height of record `k`'s outer markers [m], shape (t,), at times since the guessed release."""
        r = self.records[k]
        moved = self._displacements(k, parameters, own, time + r.release_time - own.release_time)
        return np.asarray(moved[r.outer, :, 1].mean(axis=0))

    def _displacements(self, k: int, parameters: BeamParameters, own: Own, since: Array) -> Array:
        """Displacement of record `k`'s markers (m, t, 2) [m]; since : time [s] by the lab's clock."""
        r, correction = self.records[k], self.corrections[k]
        time = since * (1.0 + parameters.clock_rate)
        motion = free_vibration(parameters, start=own.start)
        if parameters.rubbing:
            motion = replace(motion, rubbed=parameters.rubbing / correction.drop)
        q = motion.coordinates(time)
        moved = beam_markers(parameters, q, r.positions).displacement
        drop = -moved[r.outer, :, 1].mean(axis=0)
        moved = moved + correction.markers[:, None, :] * (drop / correction.drop)[None, :, None]
        if r.near_clamp.any():
            clamped = clamp_markers(parameters, q, r.positions).displacement
            fraction = np.where(r.behind_face, 1.0, own.with_clamp)[:, None, None]
            moved[r.near_clamp] += (fraction * (clamped - moved))[r.near_clamp]
        if parameters.held_below:
            rest = beam_markers(parameters, motion.equilibrium[None, :], r.positions).displacement
            held = rest + correction.markers[:, None, :]
            moved = moved - parameters.held_below / correction.drop * held * ~r.behind_face[:, None, None]
        moved = moved * (time > 0.0)[None, :, None]
        slip = abs(motion.frequencies[0] * (1.0 + parameters.clock_rate) * r.period - 1.0) * LAST
        if self.changed is unchanged and slip > OUT_OF_PHASE:
            raise ValueError("the simulated vibration gets out of phase with the measured one")
        c, s = (1.0 + parameters.image_scale) * np.array(
            [np.cos(parameters.camera_roll), np.sin(parameters.camera_roll)]
        )
        return np.stack([c * moved[..., 0] - s * moved[..., 1], s * moved[..., 0] + c * moved[..., 1]], -1)


def start_of(forward: ForwardMap) -> Array:
    """Start coordinates (n,) of a fit.

    Moduli match the measured frequencies, relaxation times the damping ratios; release times minimise the
    squared misfit. ValueError if a beam has no equilibrium.
    """
    records, coordinates = forward.records, forward.coordinates
    baseline = coordinates.baseline
    moduli = {}
    for name in baseline.specimens:
        mine = [r for r in records if r.specimen == name]
        logs = [np.log(_modulus(r, forward.corrections[0].stiff_root)) for r in mine]
        moduli[name] = float(np.exp(np.mean(logs)))
    u = baseline.start(moduli)
    if viscous(baseline):  # the vibration determines the storage modulus, not the long-time one
        ratio = at_frequency(1.0, coordinates.spectrum(records[0], u), forward.reference_time)[0]
        u = baseline.start({name: shear / ratio for name, shear in moduli.items()})
    for name in baseline.materials if not viscous(baseline) else ():
        mine = [r for r in records if r.material == name]
        u[coordinates.of_material(name)] = np.mean([np.log(r.relaxation_time) for r in mine])
    for k, r in enumerate(records):
        parameters, own = forward.baseline_parameters(k, u), forward.own(k, u)
        there = np.isfinite(r.deviations())
        tries = np.linspace(-RELEASE_SD, RELEASE_SD, 61)
        costs = []
        for t in r.release_time + tries:
            simulated = forward.rows(k, parameters, replace(own, release_time=float(t)))
            costs.append(float(np.sum(((simulated - r.measured())[there]) ** 2)))
        u[coordinates.of_trial(r)] = tries[int(np.argmin(costs))] / RELEASE
    return u


def _modulus(record: Record, stiff_root: float) -> float:
    """Shear modulus [Pa] for which the reduced beam has the record's frequency."""
    shear = 1e5
    usual = replace(record.parameters, stiff_root=stiff_root)
    for _ in range(40):
        try:
            found = float(free_vibration(replace(usual, shear_modulus=shear)).frequencies[0])
        except ValueError:  # too soft for its load
            shear *= 4.0
            continue
        if abs(found * record.period - 1.0) < 1e-4:
            break
        shear *= float(np.clip((1.0 / (found * record.period)) ** 2, 0.3, 4.0))
    return shear
