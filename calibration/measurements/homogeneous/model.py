"""Measurement model of homogeneous tests: coupons of all materials together, with effects, without a mesh.

It compares the nominal stress at each point, over its standard deviation as stated by the lab (including the
stretch error times the slope of the measured curve), or estimated from the curve's scatter if none is stated.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import CouponMode, CouponTrial, Experiment
from calibration.measurements._baseline import Baseline, least_squares_moduli
from calibration.measurements._effect import Candidate
from calibration.measurements._folds import fifths, joined
from calibration.measurements._memory import Memory
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._noise_known import POINTS_PER_FREEDOM
from calibration.measurements._noisy_model import Shown
from calibration.measurements._records import over_time
from calibration.measurements._state import State
from calibration.measurements.homogeneous._discrepancies import discrepancies
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._forward import (
    Acting,
    BaseStress,
    Loading,
    blended,
    with_effects,
    yielding,
)
from calibration.measurements.homogeneous._point_sd import ASSUMED
from calibration.measurements.homogeneous._record import Record, everything, protocol, records_of
from calibration.measurements.homogeneous._richer import RicherLaw, start_of
from calibration.measurements.homogeneous._sentences import assumed_errors, described_noise, remarks_on
from calibration.measurements.homogeneous.experiments import EXPERIMENTS, CouponTest
from calibration.measurements.homogeneous.kinematics import stress_of
from calibration.parameters import Parameters, parametrisation

Array = NDArray[np.float64]

# K/G of solid rubbers is above 1000 (K some GPa, G below 1 MPa). At 3000 a stress is the incompressible one
# to 0.1 % up to a stretch of 2, and to 0.5 to 5 % at 8, the more the law stiffens. It is not fitted, since a
# law that misfits would use it to repair its curve. A fit of a law that
# holds K/G (`Parametrisation.holding`) has these curves too, whatever its prior says.
BULK_RATIO = 3000.0
REMEMBERED = 8192  # stresses of a record
# The simplest first, by the number of their constants; terms of a series law. St Venant-Kirchhoff and the
# stable neo-Hookean law are no rubber's, and the latter has the neo-Hookean curve at this K/G.
LAWS = (
    ("neo-hookean", 1),
    ("mooney-rivlin", 1),
    ("arruda-boyce", 1),
    ("ogden", 1),
    ("ogden", 2),
    ("ogden", 3),
)
ALIKE = 0.15  # of range and rate: of two repeats of one test


class HomogeneousModel(MeasurementModel):
    """Measurement model of homogeneous tests.

    The baseline is a law of `tisim` (neo-Hookean by default) with one shear modulus per specimen; trials of a
    material that name no specimen share one.

    Parameters
    ----------
    experiment : experiment with coupons; other trials are ignored.
    effects : effects by name; see `calibration.diagnosis.effects.homogeneous`.
    law, terms : law of the baseline, and number of terms of a series law (Ogden, 1 to 3).
    baseline : baseline in place of `law` and `terms`.
    richer : (law, terms) that an effect mixes with the baseline's law.

    Raises
    ------
    InputError
        If there is no coupon.
    ValueError
        If the law is unknown, or the richer law has no stress at some stretches.
    """

    kind = "homogeneous"
    unit = ("kPa", 1e-3)
    # such explanations part in the test by more than a verdict asks, whatever its noise
    enough = 60.0
    separates = "most"
    experiments: ClassVar[Sequence[Any]] = EXPERIMENTS
    laws: ClassVar[Sequence[tuple[str, int]]] = LAWS

    records: Sequence[Record]
    effects: Mapping[str, HomogeneousEffect]

    def __init__(
        self,
        experiment: Experiment,
        *,
        effects: Mapping[str, HomogeneousEffect] | None = None,
        law: str = "neo-hookean",
        terms: int = 1,
        baseline: Baseline | None = None,
        richer: tuple[str, int] | None = None,
    ) -> None:
        self.trials = [t for t in experiment.trials if isinstance(t, CouponTrial)]
        if not self.trials:
            raise InputError("experiment.yaml: trials: expected a coupon")
        self.experiment = experiment
        self.effects = dict(effects or {})
        courses = baseline is not None and bool(baseline.law.parts)
        self._measured_in(records_of(self.trials, courses=courses, selects=self._selects))
        self.baseline = baseline or Baseline.per_specimen(
            self.records, law=law, terms=terms, bulk_ratio=BULK_RATIO
        )
        self._base = BaseStress(self.baseline, bulk_ratio=BULK_RATIO)
        self.richer: RicherLaw | None = None
        self._rich: BaseStress | None = None
        if richer is not None:
            self._take_richer(*richer)
        self.effects = {n: self._own(e) for n, e in self.effects.items() if self.richer or not e.richer}
        self._set_candidates()

    def _take_richer(self, law: str, terms: int) -> None:
        """Add the constants of a richer law as extras; their centres are from a fit of each material."""
        form = parametrisation(law, terms=terms)
        self.richer = RicherLaw.fitted(form, self.records, self.baseline.materials, bulk_ratio=BULK_RATIO)
        self.baseline = self._base.baseline = self.baseline.with_extras(self.richer.extras())
        self._rich = BaseStress(replace(self.baseline, law=form, extras=()), bulk_ratio=BULK_RATIO)

    def _own(self, effect: HomogeneousEffect) -> HomogeneousEffect:
        """Effect with the bounds, sentence and variant label for these records and the richer law."""
        touched = [r for r in self.records if effect.acts_on(r)]
        if effect.bounds_in is not None and touched:
            (low, high), (least, most) = effect.bounds, effect.bounds_in(touched)
            effect = replace(effect, bounds=(max(low, least), min(high, most)))
        if self.richer is None or not effect.richer:
            return effect
        label, plain = self.richer.law.label, self.baseline.law.label
        sentence = f"{effect.effect.sentence}: {plain} does not describe its stress, {label} does"
        said = replace(effect.effect, sentence=sentence)
        return replace(effect, effect=said, variants=lambda _: (1.0,), variant_label=lambda _: label)

    def with_law(self, law: str, terms: int) -> list[Self]:
        """The same measurements with another law as baseline and no effects, to compare laws.

        One model per material: they share no coordinate, and a joint fit would be as slow as the slowest.
        ValueError if the law is unknown.
        """
        each: dict[str, list[CouponTrial]] = {m: [] for m in self.baseline.materials}
        for t in self.trials:
            each[t.material].append(t)
        some = [replace(self.experiment, trials=tuple(trials)) for trials in each.values()]
        return [type(self)(e, law=law, terms=terms) for e in some]

    def begun(self, state: State, candidates: Sequence[Candidate]) -> State:
        """Start of a fit with these candidates: with the richer law, at the moduli of that law's own fit.

        For a stress that grows a hundredfold, the small-strain moduli of the two laws differ too much for
        local steps from the baseline's.
        """
        u = state.u.copy()
        moduli = {} if self.richer is None else self.richer.shear_moduli
        for c in candidates:
            if moduli and self.effects[c.effect].richer:
                for r, hit in zip(self.records, self.reached(c), strict=True):
                    if hit:
                        u[self.baseline.specimens.index(r.specimen)] = np.log(moduli[r.specimen])
        return replace(state, u=u)

    def law_in(self, material: str, state: State) -> tuple[str, Parameters] | None:
        mine = [k for k, r in enumerate(self.records) if r.material == material]
        acting = self._effects_in(state, mine[0]) if mine else []
        own = self._richer_constants(self.records[mine[0]], state, acting) if mine else np.zeros(0)
        if self.richer is None or not own.size:
            return None
        of_law = replace(self.baseline, law=self.richer.law, extras=())
        shear = self.baseline.shear_moduli(state.u)[material]
        return self.richer.law.law, self.richer.law.parameters(of_law.scaled(own, shear))

    def brings(self, candidate: Candidate) -> int:
        if self.richer is None or not self.effects[candidate.effect].richer:
            return 0
        hit = self.reached(candidate)
        return len(self.richer.free) * len({r.material for r, h in zip(self.records, hit, strict=True) if h})

    def _selects(self, mode: CouponMode, stretch: Array) -> NDArray[np.bool_]:
        """Mask of a record's points that are compared."""
        return everything(mode, stretch)

    def _measured_in(self, records: Sequence[Record]) -> None:
        """Set the records, with one row per point, and their noise; clear the caches."""
        self.records = records
        self.row_record = np.repeat(np.arange(len(records)), [r.points for r in records])
        self.noise = Noise.independent(np.concatenate([r.sd for r in records]))
        self._reached: dict[Candidate, NDArray[np.bool_]] = {}
        self._memory: Memory[Hashable, Array] = Memory(REMEMBERED)

    def start(self) -> Array:
        """Start coordinates (n,): moduli of the best-fit incompressible neo-Hookean curves of the specimens.

        A law with further constants is fitted from several starts (`start_of`). ValueError if the modulus of
        a specimen would not be positive, or if that law has no solution.
        """
        if self.baseline.free and not self.baseline.whole:
            return start_of(self.baseline, self.records, bulk_ratio=BULK_RATIO)
        found = least_squares_moduli(
            ((r.specimen, stress_of(r.mode, r.stretch, 0.5) / r.sd, r.stress / r.sd) for r in self.records),
            specimens=self.baseline.specimens,
            falling="its stress falls with its stretch",
        )
        return self.baseline.start(found)

    def stresses(self, state: State) -> list[Array]:
        """Nominal stress of each record at its stretches [Pa], with the state's effects; NaN without one."""
        return self._stresses_of(range(len(self.records)), state)

    def _stresses_of(self, some: Sequence[int], state: State) -> list[Array]:
        """Nominal stress of some records, by index [Pa]."""
        loadings = [self._loading(self.records[k], state, self._effects_in(state, k)) for k in some]
        return [x.shear_modulus * p for x, p in zip(loadings, self._over_modulus(loadings), strict=True)]

    def _loading(self, record: Record, state: State, acting: Acting) -> Loading:
        return Loading(
            record=record,
            shear_modulus=self.baseline.shear_modulus(record.specimen, state.u),
            law=self.baseline.law_coordinates(record.material, state.u),
            acting=acting,
            further=self._richer_constants(record, state, acting),
        )

    def _richer_constants(self, record: Record, state: State, acting: Acting) -> Array:
        """All coordinates of the material's richer law if an acting effect uses it; else empty."""
        if self.richer is None or not any(e.richer for e, _ in acting):
            return np.zeros(0)
        return self.richer.of(record.material, state.u[self.baseline.first_extra :])

    def _depends_on(self, record: Record) -> NDArray[np.bool_]:
        found = self.baseline.informed_by(record, whole_material=False)
        if self.richer is not None:
            first = self.baseline.first_extra + self.richer.first(record.material)
            found[first : first + len(self.richer.free)] = True
        return found

    def _over_modulus(self, loadings: Sequence[Loading]) -> list[Array]:
        """Stress over the shear modulus at the records' stretches.

        It is cached, since a coordinate or an effect changes few records.
        """
        return self._memory.fetch(
            [x.key for x in loadings], lambda some: self._solved([loadings[k] for k in some])
        )

    def _solved(self, loadings: Sequence[Loading]) -> list[Array]:
        return yielding(
            lambda some, own: self._at_own_stretches([loadings[k] for k in some], own),
            [x.shifted for x in loadings],
            [x.compliance for x in loadings],
        )

    def _at_own_stretches(self, loadings: Sequence[Loading], stretches: Sequence[Array]) -> list[Array]:
        """Stress over the shear modulus at the specimens' own stretches, shape of each."""
        base = blended(loadings, stretches, self._base, self._rich)
        return [with_effects(x, s, p) for x, s, p in zip(loadings, stretches, base, strict=True)]

    def _effects_in(self, state: State, k: int) -> Acting:
        """Effects in record `k`, with the sums of their amplitudes there."""
        found: dict[tuple[str, float | None], float] = {}
        for c, a in state.amplitudes.items():
            if self.visible.get(c, True) and self.reached(c)[k]:
                found[c.effect, c.variant] = found.get((c.effect, c.variant), 0.0) + a
        return [(self.effects[name].formed(variant), a) for (name, variant), a in found.items()]

    def reached(self, candidate: Candidate) -> NDArray[np.bool_]:
        if candidate not in self._reached:
            self._reached[candidate] = super().reached(candidate)
        return self._reached[candidate]

    def _misfit(self, states: Sequence[State]) -> Array:
        used = np.unique(self.row_record[self.noise.used]).tolist()
        some = np.isin(self.row_record, used)
        measured = np.concatenate([self.records[k].stress for k in used])
        found = np.full((len(states), len(self.row_record)), np.nan)
        for row, state in zip(found, states, strict=True):
            row[some] = np.concatenate(self._stresses_of(used, state)) - measured
        return found

    def _constrains(self, record: Record) -> NDArray[np.bool_]:
        return self._depends_on(record)

    def predicted_in(self, test: CouponTest, state: State) -> Self | None:
        """Model of the same specimens in a new test, with predicted stresses; None if there are none."""
        trials = test.of_each(self.records)
        if not trials:
            return None
        new = self.measuring(trials)
        predicted = new.stresses(state)
        if not all(np.isfinite(p).all() for p in predicted):
            return None
        new.records = [replace(r, stress=p) for r, p in zip(new.records, predicted, strict=True)]
        return new

    def measuring(self, trials: Sequence[CouponTrial]) -> Self:
        """Copy of the model for other trials of the same specimens, done after the present ones.

        Coordinates and candidates stay; `visible` is for both sets of trials together.
        """
        some = copy(self)
        courses = bool(self.baseline.law.parts)
        whole = records_of([*self.trials, *trials], courses=courses, selects=self._selects)
        some._measured_in(whole[len(self.trials) :])
        some.visible = self._visible([*self.records, *some.records])
        return some

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        """Fold labels by mode, material, trial, branch, and fifth of each record."""
        return joined(
            {
                "leave-one-mode-out": [str(r.mode)] * r.points,
                "leave-one-material-out": [r.material] * r.points,
                "leave-one-trial-out": [r.name] * r.points,
                "leave-one-branch-out": [f"{r.name} branch {b + 1:.0f}" for b in r.branch],
                "leave-one-fifth-out": fifths(r.points),
            }
            for r in self.records
        )

    def _discrepancies(self) -> Mapping[str, Array]:
        return discrepancies(self.records, self.noise.sd)

    def remarks(self) -> list[str]:
        return remarks_on(self.records)

    def repeat_of(self, k: int) -> Hashable | None:
        """Index of the first record of equal mode and number of strokes, with range and rate within ALIKE."""
        own = protocol(self.records[k])
        for j, other in enumerate(self.records):
            there = protocol(other)
            if there[:2] == own[:2] and np.allclose(there[2:], own[2:], rtol=ALIKE):
                return j
        raise AssertionError("a record is a repeat of itself")

    def along(self, k: int) -> tuple[str, Array] | None:
        r = self.records[k]
        return "strain", np.abs(r.stretch - 1.0)

    def branch(self, k: int) -> NDArray[np.int64]:
        return np.asarray(self.records[k].branch, dtype=np.int64)

    def noise_freedom(self) -> float:
        doubt = sum(r.points**2 / r.scatter_points for r in self.records if r.scatter_points)
        whole = sum(r.points for r in self.records) ** 2
        return float(whole / doubt) / POINTS_PER_FREEDOM if doubt else np.inf

    def _scatter_points(self) -> list[tuple[Hashable, float] | None]:
        """Each stroke has an estimate of its own; one that is assumed for few points is taken as it is."""
        found = list(super()._scatter_points())
        for k, r in enumerate(self.records):
            if r.name in self.from_data or not r.scatter_points:
                continue
            used = self.noise.used[self.row_record == k]
            share = r.scatter_points / max(1, int(np.count_nonzero(used)))
            branch = self.branch(k)
            each = {b: share * np.count_nonzero(used & (branch == b)) for b in np.unique(branch)}
            for row, b in zip(np.flatnonzero(self.row_record == k), branch, strict=True):
                found[row] = (
                    None if r.scatter_points == ASSUMED or not each[b] else ((r.name, int(b)), each[b])
                )
        return found

    def shortcomings(self) -> list[str]:
        return assumed_errors(self.records)

    def noise_sentence(self) -> str:
        return described_noise(self.records, self.points)

    def shown(self, k: int) -> Shown:
        r = self.records[k]
        return Shown(
            **over_time(r.time, "stretch", r.stretch),
            quantity="nominal stress",
            unit=self.unit,
            measured=r.stress,
        )
