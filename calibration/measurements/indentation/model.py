"""Measurement model of indentation tests of all materials together, with effects in the simulated forces.

The force along the indenter (and across it, if the lab has vectors) is compared at the recorded depths of the
whole record: loading, holds, unloading, later cycles. Errors are those stated by the lab, that of the depth
times the slope, and the mesh error of the simulation (`_noise.py`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import partial
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import Experiment, PokeTrial
from calibration.measurements._baseline import Baseline, least_squares_moduli
from calibration.measurements._effect import Candidate, reaches
from calibration.measurements._folds import fifths, joined
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._noisy_model import Shown
from calibration.measurements._records import over_time
from calibration.measurements._state import State
from calibration.measurements.indentation._curve import Curve
from calibration.measurements.indentation._curve_cache import CurveCache
from calibration.measurements.indentation._discrepancies import discrepancies
from calibration.measurements.indentation._effect import IndentationEffect
from calibration.measurements.indentation._forward import (
    ForwardMap,
    along_course,
    at_depths,
    difference_step,
    reached,
)
from calibration.measurements.indentation._law_curves import LawCurves, nearest_modulus
from calibration.measurements.indentation._memory_force import spectrum_of
from calibration.measurements.indentation._noise import TOUCH, noise_of
from calibration.measurements.indentation._record import Record, check_pushed, part_of, records_of
from calibration.measurements.indentation._scene import BULK_RATIO, FRICTION, geometry_of
from calibration.measurements.indentation._sentences import described_noise, remarks_on
from calibration.measurements.indentation.experiments import EXPERIMENTS, IndentationTest
from tisim.parts import Spectrum

Array = NDArray[np.float64]

LEAST = 3  # points of a record that a law must reach


class IndentationModel(MeasurementModel):
    """Measurement model of indentation tests.

    The baseline is neo-Hookean and nearly incompressible, with one shear modulus per specimen; trials of a
    material that name no specimen share one. Each geometry is simulated once, and once for each change that a
    search needs. A baseline of one law uses the curves of that law (`LawCurves`), which `update_nuisances`
    simulates; with viscosity, forces are integrated along each record's course (`_memory_force`).

    Parameters
    ----------
    experiment : experiment with indentations; other trials are ignored.
    effects : effects by name; see `calibration.diagnosis.effects.indentation`.
    workers : number of processes, as in `tisim.simulate`.
    baseline : baseline in place of the neo-Hookean one.
    friction : assumed coefficient of friction between indenter and block.
    edge_radius : radius of the edge of flat indenters [m]; None for 0.4 of their radius.
    max_depth : largest depth that is compared [m]; None for any depth.
    first_loading : if True, nothing after the first hold or reversal is compared.
    refinement : factor on the refinement of all meshes.

    Attributes
    ----------
    noise : noise; before `update_nuisances`, that of the load cell only.

    Raises
    ------
    InputError
        If there is no indentation, or one that cannot be simulated.
    ValueError
        If a simulation has no equilibrium.
    """

    kind = "indentation"
    unit = ("N", 1.0)
    experiments: ClassVar[Sequence[Any]] = EXPERIMENTS

    records: Sequence[Record]
    effects: Mapping[str, IndentationEffect]

    def __init__(
        self,
        experiment: Experiment,
        *,
        effects: Mapping[str, IndentationEffect] | None = None,
        workers: int | None = None,
        baseline: Baseline | None = None,
        friction: float = FRICTION,
        edge_radius: float | None = None,
        max_depth: float | None = None,
        first_loading: bool = False,
        refinement: float = 1.0,
    ) -> None:
        trials = [t for t in experiment.trials if isinstance(t, PokeTrial)]
        if not trials:
            raise InputError("experiment.yaml: trials: expected a poke")
        self.experiment = experiment
        self.effects = dict(effects or {})
        self._remembers = baseline is not None and bool(baseline.law.parts)
        # a relaxation is read off the force against depth of a ramp, whose error takes the same part in it
        self.curves = CurveCache(workers)
        self.forward = ForwardMap(curves=self.curves, effects=self.effects)
        self._geometry = partial(
            geometry_of, friction=friction, edge_radius=edge_radius, refinement=refinement
        )
        self._part = partial(part_of, max_depth=max_depth, first_loading=first_loading)
        self._fits_law = baseline is not None and baseline.whole
        self._measured_in(trials)
        self.baseline = baseline or Baseline.per_specimen(self.records, bulk_ratio=BULK_RATIO)
        self._of_law = {
            m: LawCurves(self.baseline.law, [r for r in self.records if r.material == m], self.curves)
            for m in (self.baseline.materials if self.baseline.whole else ())
        }
        self._set_candidates()

    def _measured_in(self, trials: Sequence[PokeTrial]) -> None:
        """Set the records of these trials, their rows and the noise.

        Rows: one per point along the indenter, for all records; then two per point across it, for the records
        that have these forces.
        """
        compared, not_compared = self._part(records_of(trials, self._geometry, courses=self._remembers))
        self.records, self._left_out = compared, not_compared
        if self._fits_law:  # simulated where nuisances are taken
            check_pushed(compared)
        else:
            self.records, ended = reached(self.curves, compared)
            self._left_out += ended
        self.row_record = np.concatenate([np.repeat(k, n) for k, n in self._row_blocks()])
        own = [r.own_sd for r in self.records]
        across = [np.repeat(r.own_sd, 2) for r in self.records if r.across is not None]
        self.noise = Noise.independent(np.concatenate([*own, *across]))
        self._elastic: list[Array] = []

    def _row_blocks(self) -> list[tuple[int, int]]:
        """Index of the record and number of rows of each block of rows, in their order."""
        along = [(k, r.points) for k, r in enumerate(self.records)]
        return along + [(k, 2 * r.points) for k, r in enumerate(self.records) if r.across is not None]

    # -- forces --

    def start(self) -> Array:
        """Start coordinates (n,) from the least-squares moduli of the first loadings.

        ValueError if the modulus of a specimen would not be positive.
        """
        used = [_first_loading(r) for r in self.records]
        found = least_squares_moduli(
            (
                (r.specimen, self.forward.base(r).at(r.depth)[mine], r.force[mine])
                for r, mine in zip(self.records, used, strict=True)
            ),
            specimens=self.baseline.specimens,
            falling="its force falls with the depth",
        )
        return self.baseline.start(found)

    def forces(self, state: State) -> list[Array]:
        """Force along the indenter of each record at its points [N], with the state's effects."""
        self._prepare([state])
        return [self._along(state, r) for r in self.records]

    def acting(self, state: State, record: Any) -> dict[tuple[str, float | None, float | None], float]:
        """As in the base class; variants of an effect with `chords` are one form."""
        found: dict[tuple[str, float | None, float | None], float] = {}
        for (name, position, variant), a in super().acting(state, record).items():
            form = (name, position, None if self.effects[name].chords else variant)
            found[form] = found.get(form, 0.0) + a
        return found

    def _prepare(self, states: Sequence[State]) -> None:
        """Simulate, in one batch, the curves that these states need."""
        self.forward.prepare([(r, self.acting(s, r)) for s in states for r in self.records])

    def _along(self, state: State, record: Record) -> Array:
        shear_modulus = self.baseline.shear_modulus(record.specimen, state.u)
        curve = self._curve(record, state.u)
        acting = self.acting(state, record)
        return self.forward.along(record, curve, shear_modulus, acting, self._spectrum(record, state.u))

    def _across(self, state: State, record: Record) -> Array:
        shear_modulus = self.baseline.shear_modulus(record.specimen, state.u)
        curve = self._curve(record, state.u)
        acting = self.acting(state, record)
        return self.forward.across(record, curve, shear_modulus, acting, self._spectrum(record, state.u))

    def _spectrum(self, record: Record, u: Array) -> Spectrum | None:
        """Relaxation spectrum of a record's material; None if it is elastic.

        ValueError if the coordinates are invalid for its parts.
        """
        if not self._remembers:
            return None
        return spectrum_of(self.baseline.law, self.baseline.law_coordinates(record.material, u))

    def _curve(self, record: Record, u: Array) -> Curve:
        """Force over shear modulus of a record's geometry and material, without effects."""
        if not self.baseline.whole:
            return self.forward.base(record)
        own = self.baseline.law_coordinates(record.material, u)
        return self._of_law[record.material].curve(record, own)

    def _misfit(self, states: Sequence[State]) -> Array:
        self._prepare(states)
        found = np.full((len(states), len(self.row_record)), np.nan)
        for row, state in zip(found, states, strict=True):
            try:
                along = [self._along(state, r) - r.force for r in self.records]
                across = [
                    (self._across(state, r) - r.across).ravel() for r in self.records if r.across is not None
                ]
            except ValueError:  # outside the domain of the law's parts
                continue
            row[:] = np.concatenate([*along, *across])
        return found

    def _step(self, candidate: Candidate, state: State) -> float:
        effect = self.effects[candidate.effect]
        now = state.amplitudes.get(candidate, 0.0)
        if effect.scene is None:
            return effect.step if now + effect.step <= effect.bounds[1] else -effect.step
        first = next(r for r in self.records if reaches(candidate, r, effect))
        return difference_step(effect, candidate.variant if effect.chords else effect.chord, now, first)

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        """Update the noise and, for a baseline of one law, its curves at a state.

        With `rough`, the noise of such a baseline is evaluated at the least-squares modulus of the records in
        place of the state's.

        Raises
        ------
        ValueError
            If the law has no equilibrium there, or fewer than LEAST points of a record are simulated.
        """
        for material, curves_of_law in self._of_law.items():
            curves_of_law.take(self.baseline.law_coordinates(material, state.u))
        curves = [self._curve(r, state.u) for r in self.records]
        forces, slopes, follow, relaxing = [], [], [], []
        for r, curve in zip(self.records, curves, strict=True):
            shear_modulus = self.baseline.shear_modulus(r.specimen, state.u)
            if rough and self.baseline.whole:
                shear_modulus = nearest_modulus(r.material, self.records, curves)
            over = max(TOUCH * r.depth_sd, 1e-6)
            spectrum = self._spectrum(r, state.u)
            relaxing.append(0.0 if spectrum is None else 1.0 - spectrum.equilibrium / spectrum.instantaneous)
            if spectrum is None:
                forces.append(shear_modulus * curve.at(r.depth))
                slopes.append(shear_modulus * curve.slope(r.depth, over))
                follow.append(partial(at_depths, r, shear_modulus))
                continue
            own = partial(along_course, r, shear_modulus, spectrum)
            forces.append(own(curve.at))
            slopes.append((own(curve.at, shift=over) - own(curve.at, shift=-over)) / (2.0 * over))
            follow.append(own)
        self._elastic = forces
        noise = noise_of(self.records, curves, forces, slopes, follow, relaxing)
        simulated = self._simulated()
        for r, inside in zip(self.records, simulated, strict=True):
            if np.count_nonzero(inside) < LEAST:
                raise ValueError(f"{r.name}: the simulation reaches {np.count_nonzero(inside)} points of it")
        across = [
            np.repeat(x, 2) for r, x in zip(self.records, simulated, strict=True) if r.across is not None
        ]
        used = np.concatenate([*simulated, *across])
        self.noise = replace(noise, sd=np.where(used, noise.sd, np.inf), kept=self.noise.kept)

    def _simulated(self) -> list[NDArray[np.bool_]]:
        """Mask of the points of each record within the simulated depth of its law."""
        if not self.baseline.whole:
            return [np.ones(r.points, dtype=bool) for r in self.records]
        return [r.depth <= self._of_law[r.material].of(r).reached * (1.0 + 1e-9) for r in self.records]

    def shortcomings(self) -> list[str]:
        """A sentence for each record with points beyond the simulated depth of its law."""
        found: list[str] = []
        if not all(curves.taken for curves in self._of_law.values()):
            return found
        for r, inside in zip(self.records, self._simulated(), strict=True):
            if not inside.all():
                law = self._of_law[r.material].of(r)
                found.append(
                    f"indentation {r.name}{law.short} at {1e3 * law.reached:.2f} of {1e3 * r.deepest:.2f} mm;"
                    f" {np.count_nonzero(~inside)} measured points beyond it are not used"
                )
        return found

    # -- experiments --

    def predicted_in(self, test: IndentationTest, state: State) -> Self | None:
        """Model of the same specimens in a new test; None if it cannot be set up or has no equilibrium."""
        trials = test.of_each(self.records)
        if not trials:
            return None
        try:
            new = self.measuring(trials)
            predicted = new.forces(state)
        except (InputError, ValueError):
            return None
        new.records = [replace(r, force=p) for r, p in zip(new.records, predicted, strict=True)]
        new.update_nuisances(State(u=state.u))
        return new

    def measuring(self, trials: Sequence[PokeTrial]) -> Self:
        """Copy of the model for other trials of the same specimens.

        Coordinates and candidates stay; `visible` is for both sets of trials together.
        """
        some = copy(self)
        some._measured_in(trials)
        some.visible = self._visible([*self.records, *some.records])
        return some

    # -- lack of fit, folds, scores --

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        """Fold labels by trial, material, phase label, and fifth of each record."""
        found = []
        for k, size in self._row_blocks():
            r = self.records[k]
            of_points = {
                "leave-one-trial-out": [r.name] * r.points,
                "leave-one-material-out": [r.material] * r.points,
                "leave-one-phase-out": [r.labels[int(p)] for p in r.phase],
                "leave-one-fifth-out": fifths(r.points),
            }
            each = size // r.points
            found.append({name: np.repeat(labels, each).tolist() for name, labels in of_points.items()})
        return joined(found)

    def _discrepancies(self) -> Mapping[str, Array]:
        across = len(self.row_record) - sum(r.points for r in self.records)
        along = discrepancies(self.records, self._elastic)
        return {name: np.vstack([raw, np.zeros((across, raw.shape[1]))]) for name, raw in along.items()}

    def registered(self, state: State) -> list[Array]:
        """As in the base class, along the indenter only."""
        return self._along_rows(super().registered(state))

    def point_sds(self) -> list[Array]:
        """Independent standard deviations of the points of each record along the indenter [N]."""
        return self._along_rows([self.noise.sd[self.row_record == k] for k in range(len(self.records))])

    def _along_rows(self, rows: Sequence[Array]) -> list[Array]:
        return [own[: r.points] for r, own in zip(self.records, rows, strict=True)]

    # -- for reports --

    def left_out(self) -> list[str]:
        return list(self._left_out)

    def remarks(self) -> list[str]:
        return remarks_on(self.records, self.left_out())

    def noise_sentence(self) -> str:
        return described_noise(self.records, self.points)

    def shown(self, k: int) -> Shown:
        """Force along the indenter of record `k`; rows across it, which follow, are not displayed."""
        r = self.records[k]
        rows = int(np.count_nonzero(self.row_record == k))
        return Shown(
            **over_time(r.time, "depth [mm]", 1e3 * r.depth),
            quantity="force",
            unit=self.unit,
            measured=r.force,
            of_rows=None if rows == r.points else np.eye(r.points, rows),
        )


def _first_loading(record: Record) -> NDArray[np.bool_]:
    """Mask of the points of the first loading; of all points if the record has none."""
    first = (record.cycle == 1) & (record.direction > 0)
    return first if first.any() else np.ones(record.points, dtype=bool)
