"""Measurement model of cantilever releases of all trials together, with effects in a reduced beam.

It compares displacements of markers in the plane of the vibration, in means of neighbouring samples: before
the release, in free vibration (from FIRST periods after the release, since a release by hand is not
instantaneous) and near equilibrium. Their noise is the lab's marker error; nuisances are marginalised: the
cameras' frame, positions and zeros of markers, a twist, the correction of the reduced beam by FEM.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.measurements._baseline import Baseline
from calibration.measurements._joint import joint_fit
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._noise_known import FEWEST, PointNoise, roughness
from calibration.measurements._state import State
from calibration.measurements.release._beam import BeamParameters
from calibration.measurements.release._effect import ReleaseEffect
from calibration.measurements.release._fem import BULK_RATIO, Correction, corrections, uncorrected
from calibration.measurements.release._forward import Coordinates, ForwardMap, start_of, viscous
from calibration.measurements.release._nuisances import discrepancies, nuisance_columns
from calibration.measurements.release._record import FIRST, LAST, Record, records_of, reference_time
from calibration.measurements.release.experiments import EXPERIMENTS, RepeatedRelease
from tisim import Material

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

MOVED = 0.05  # of ln G, after which FEM is run again


class ReleaseModel(MeasurementModel):
    """Measurement model of cantilever releases.

    The baseline is neo-Hookean and nearly incompressible, with one modulus per specimen (trials of a material
    that name none share one) and one relaxation time per material (stiffness-proportional damping).
    `Coordinates` lists the other coordinates.

    Parameters
    ----------
    experiment : experiment with beams with markers; other trials are ignored.
    effects : effects by name; see `calibration.diagnosis.effects.release`.
    baseline : baseline in place of the neo-Hookean one.
    workers : number of processes for FEM; None for all cores.
    fem : if True, correct the reduced beam by FEM; if False, use plain beam theory.

    Raises
    ------
    InputError
        If there is no beam with markers, or a trial is incomplete.
    """

    kind = "release"
    unit = ("mm", 1e3)
    coordinate_step = 1e-5
    # A change of frequency has a long column, of which a modulus takes nearly all; the closed forms of the
    # reduced beam leave nothing else to finite differences.
    alias_tolerance = 1e-4
    compares_specimens = False
    no_answer = "the beam has no equilibrium at this state"
    # such explanations part in the experiment by more than a verdict asks, whatever its noise
    enough = 60.0
    separates = "most"
    experiments: ClassVar[Sequence[Any]] = EXPERIMENTS

    records: Sequence[Record]
    effects: Mapping[str, ReleaseEffect]

    def __init__(
        self,
        experiment: Experiment,
        *,
        effects: Mapping[str, ReleaseEffect] | None = None,
        baseline: Baseline | None = None,
        workers: int | None = None,
        fem: bool = True,
    ) -> None:
        records = records_of(experiment)
        if not records:
            raise InputError("experiment.yaml: trials: expected a beam with markers")
        self.experiment = experiment
        self.workers, self.fem = workers, fem
        self.effects = dict(effects or {})
        self._measured_in(records)
        self.coordinates = Coordinates.of(
            records, baseline or Baseline.per_specimen(records, bulk_ratio=BULK_RATIO)
        )
        self.baseline = self.coordinates.baseline
        if viscous(self.baseline):
            self.noise = self.noise.subset(~self._dragged())
        self.reference_time = reference_time(records)
        self.forward = ForwardMap(
            records=records,
            coordinates=self.coordinates,
            corrections=[uncorrected(r, usual=fem) for r in records],
            reference_time=self.reference_time,
        )
        self.not_corrected: list[str] = []
        self._corrected_at: Array | None = None
        self._set_candidates()

    def _measured_in(self, records: Sequence[Record]) -> None:
        """Set the records, their rows and the noise."""
        self.records = records
        self.row_record = np.repeat(np.arange(len(records)), [r.points for r in records])
        self.noise = Noise.independent(np.concatenate([r.deviations() for r in records]), symmetric=True)

    @property
    def corrections(self) -> Sequence[Correction]:
        """Correction of each record by FEM."""
        return self.forward.corrections

    # -- forward map --

    def suggested_start(self) -> Array:
        u = self.start()
        for _ in range(2):  # what FEM adds, and nuisances, are taken where the first fit ends
            self.update_nuisances(State(u=u))
            u = joint_fit(self, u)
        return u

    def start(self) -> Array:
        """Start coordinates (n,) from frequencies, damping ratios and release times (`start_of`).

        ValueError if a beam has no equilibrium.
        """
        return start_of(self.forward)

    def parameters(self, k: int, state: State) -> BeamParameters:
        """Parameters of record `k`'s beam with the state's effects."""
        found = self.forward.baseline_parameters(k, state.u)
        for (name, _, variant), amplitude in self.acting(state, self.records[k]).items():
            if amplitude != 0.0:
                found = self.effects[name].alter(found, amplitude, variant)
        return self.forward.changed(found)

    def simulated(self, k: int, state: State) -> Array:
        """Simulated rows of record `k` [m], without nuisances. ValueError if its beam has no equilibrium."""
        return self.forward.rows(k, self.parameters(k, state), self.forward.own(k, state.u))

    def tip_height(self, k: int, state: State, time: Array) -> Array:
        """Mean height of record `k`'s outer markers [m], shape (t,), at times since the guessed release."""
        return self.forward.tip_height(k, self.parameters(k, state), self.forward.own(k, state.u), time)

    def _misfit(self, states: Sequence[State]) -> Array:
        return np.array(
            [np.concatenate([self._left(k, s) for k in range(len(self.records))]) for s in states]
        )

    def _depends_on(self, record: Record) -> Rows:
        return self.coordinates.depended_on(record)

    def _left(self, k: int, state: State) -> Array:
        """Simulated minus measured rows of record `k`; NaN without a solution, or if no row is used."""
        r = self.records[k]
        if not self.noise.used[self.row_record == k].any():
            return np.full(r.points, np.nan)
        try:
            return self.simulated(k, state) - r.measured()
        except (ValueError, np.linalg.LinAlgError):
            return np.full(r.points, np.nan)

    # -- noise, lack of fit, folds --

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        """Update the nuisances and, unless `rough`, the corrections by FEM at a state.

        FEM is run only if moduli or other coordinates of the law changed by more than MOVED.
        """
        every = range(len(self.records))
        beams = [self.parameters(k, state) for k in every]
        at = np.concatenate([np.log([b.shear_modulus for b in beams]), self._shape(state)])
        far = self._corrected_at is None or np.abs(at - self._corrected_at).max() > MOVED
        if self.fem and not rough and far:
            found, self.not_corrected = corrections(
                self.records,
                [self._elastic(r, b.shear_modulus, state) for r, b in zip(self.records, beams, strict=True)],
                [b.shear_modulus for b in beams],
                # a spectrum damps as a relaxation time that gives the measured damping ratio
                [b.relaxation_time or r.relaxation_time for r, b in zip(self.records, beams, strict=True)],
                workers=self.workers,
            )
            self.forward = replace(self.forward, corrections=found)
            self._corrected_at = at
        own = [self.forward.own(k, state.u) for k in every]
        columns, names = nuisance_columns(
            self.records,
            [self.parameters(k, state) for k in every],
            [o.release_time for o in own],
            self.corrections,
            lambda k, parameters: self.forward.rows(k, parameters, own[k]),
            over_time=viscous(self.baseline),
        )
        self.noise = self.noise.with_nuisances(columns, names)

    def _shape(self, state: State) -> Array:
        """Coordinates of the law other than moduli, K/G and parts, which affect the FEM correction."""
        b = self.baseline
        kept = [k for k, c in enumerate(b.law.coordinates) if c.start is not None and c.name != "bulk_ratio"]
        kept = [
            k
            for k in kept
            if b.law.coordinates[k].name not in {c.name for p in b.law.parts for c in p.coordinates}
        ]
        found = [b.law_coordinates(m, state.u)[kept] for m in b.materials]
        return np.concatenate(found)

    def _elastic(self, record: Record, shear: float, state: State) -> Material:
        """Elastic material of a record with a shear modulus [Pa]."""
        b = self.baseline
        own = b.law_coordinates(record.material, state.u)
        moduli = np.array([c.start is None for c in b.law.coordinates])
        own = np.where(moduli, own + np.log(shear / b.law.moduli(own).shear_modulus), own)
        density = record.parameters.density
        if not b.whole:
            return replace(b.law.material(b.scaled(own, shear)), density=density, viscosity=None)
        return replace(b.law.material(own, density=density), viscosity=None)

    def noise_rms(self) -> float:
        return float(np.sqrt(np.mean(self.noise.sd[self.noise.used] ** 2)))

    def _discrepancies(self) -> Mapping[str, Array]:
        return discrepancies(self.records)

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        """Fold labels by load, by trial, and by free vibration or approach to equilibrium."""
        late = self._after_vibration()
        owners = [self.records[k] for k in self.row_record]
        return {
            "leave-one-load-out": [r.load for r in owners],
            "leave-one-trial-out": [r.name for r in owners],
            "vibration-or-equilibrium-out": [
                "approach to equilibrium" if x else "free vibration" for x in late
            ],
        }

    def left_out(self) -> list[str]:
        names = [r.name for r in self.records if r.loaded and viscous(self.baseline)]
        return [
            f"{n}: the free vibration with its hung mass, which is damped by how it hangs too" for n in names
        ]

    def _dragged(self) -> Rows:
        """Mask (rows,) of free vibrations with a hung mass.

        A spectrum must not represent the friction of a string or hook (`studies/release/over_time.md`: the
        damping ratio grows as the motion decays).
        """
        loaded = np.array([self.records[k].loaded for k in self.row_record])
        time = np.concatenate([r.labels()[2] for r in self.records])
        return loaded & np.isfinite(time) & ~self._after_vibration()

    def _after_vibration(self) -> Rows:
        """Mask (rows,) of the rows after the free vibration."""
        return np.concatenate([r.labels()[2] > LAST * r.period for r in self.records])

    def unconstrained(self, fold: Rows) -> Rows:
        """As in the base class; release and start of a trial are constrained by its free vibration only."""
        time = np.concatenate([r.labels()[2] for r in self.records])
        return ~self.coordinates.constrained(
            self.records,
            self.noise.used & ~fold,
            np.isfinite(time) & ~self._after_vibration(),
            self.row_record,
        )

    def point_noise(self) -> list[PointNoise]:
        """As in the base class, but from the samples of the markers.

        A vibration is smooth from sample to sample, but not between means over a sixth of a period.
        """
        found = []
        for r in self.records:
            each = [roughness(m.displacement[:, axis]) for m in r.trial.markers for axis in (0, 2)]
            shown = [sd for sd, points in each if points >= FEWEST and sd > 0.0]
            if shown:
                # of the noisiest markers: others may hardly move, and are filtered
                sd = float(np.quantile(shown, 0.75))
                points = sum(points for _, points in each)
                found.append(PointNoise(record=r.name, stated=True, assumed=r.sd, shown=sd, points=points))
        return found

    def full_scale(self) -> Array | None:
        return np.array([float(np.nanmax(np.abs(r.measured()))) for r in self.records])

    def along(self, k: int) -> tuple[str, Array] | None:
        return "seconds after the release", self.records[k].labels()[2]

    # -- advice and reports --

    def predicted_in(self, test: RepeatedRelease, state: State) -> Self | None:
        """Model of the same specimens in a repeated release, with predicted data; None if not possible."""
        some = copy(self)
        some._measured_in([r.longer(test.duration) for r in self.records])
        some.forward = replace(self.forward, records=some.records, changed=test.changed)
        try:
            some.update_nuisances(state, rough=True)
            predicted = [some.simulated(k, state) for k in range(len(some.records))]
        except ValueError:
            return None
        some.records = [r.measuring(p) for r, p in zip(some.records, predicted, strict=True)]
        return some

    def remarks(self) -> list[str]:
        """Sentences on data left out, on assumptions, and on the use of the verdict."""
        records = self.records
        found = [
            f"of each trial the first {FIRST:g} periods after the release are left out, since a release by"
            " hand is not instantaneous; the time of the release and the shape at it are free",
            "displacements across the plane of the vibration are not compared; a twist of the tip is a"
            " nuisance",
        ]
        if self.coordinates.near:
            names = sorted(
                {
                    name
                    for r in records
                    for name, c in zip(r.names, r.near_clamp & ~r.behind_face, strict=True)
                    if c
                }
            )
            found.append(
                f"markers next to the clamp ({', '.join(names)}) may sit on it: the fraction by which they"
                " move with it is free, and only their motion is compared, not their position at rest"
            )
        silent = [
            r.name
            for r in records
            if any(np.isnan(r.held[i, 0]) for i, close in enumerate(r.near_clamp) if not close)
        ]
        if silent:
            found.append(
                f"{', '.join(silent)}: no sample before the release, so the zero of the displacements is not"
                " known"
            )
        found.append(
            "a fault of rig or cameras, where one is named, is on record in cards/rig.yaml, which no command"
            " reads: calibration.fit --rig corrects outlines of photographed beams"
        )
        return [*found, *self.not_corrected]

    def noise_sentence(self) -> str:
        return (
            f"{len(self.records)} records, {self.points} points (means of neighbouring samples, in x and z):"
            " the marker error that the lab states, white from sample to sample. Nuisances, one draw a trial:"
            " the cameras' frame (2 degrees), the zeros of markers (2 mm), a twist of the tip; one draw a"
            " marker: its position (1 mm); one draw a load: 0.3 % of the equilibrium; one draw in all: a"
            " fifth of what FEM adds to the reduced beam. Free: the modulus of each specimen, one relaxation"
            " time a material, the time of each release and the shape at it, 0.3 % of the modulus from one"
            " load to another."
        )
