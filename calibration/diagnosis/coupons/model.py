"""Coupons of all materials together, with the catalogue's effects nested in their closed-form stresses.

What is compared is the nominal stress at each point, over its standard deviation as the lab states it
(stretch noise through the measured curve's slope; where no error of the stress is stated, one from the
curve's scatter).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.advice import most_parted
from calibration.diagnosis.coupons._baseline import Baseline
from calibration.diagnosis.coupons._candidates import candidates_of, reaches
from calibration.diagnosis.coupons._compliance import yielding
from calibration.diagnosis.coupons._families import families_of
from calibration.diagnosis.coupons._patterns import patterns_of
from calibration.diagnosis.coupons._record import Record, records_of
from calibration.diagnosis.coupons._remarks import remarks_on
from calibration.diagnosis.coupons.advice import advise
from calibration.diagnosis.coupons.effects import EFFECTS, CouponEffect
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Linear, State
from calibration.diagnosis.specimens import mean_moduli, scatter_patterns
from calibration.errors import InputError
from calibration.experiment.model import CouponTrial, Experiment

Array = NDArray[np.float64]

STEP = 1e-4  # of a coordinate u, in a finite difference


class CouponModel:
    """Baseline: a law of `tisim` (Neo-Hookean by default), one shear modulus a specimen (trials that name
    none share one a material). See `calibration.diagnosis.nested.Nested` and `heldout.Foldable`.

    names: see `Baseline`. terms: of a series law (Ogden, 1 to 3). without: effects left out of the catalogue.
    InputError where there is no coupon; ValueError where the law is unknown.
    """

    most_causes = 3

    def __init__(
        self,
        experiment: Experiment,
        *,
        law: str = "neo-hookean",
        terms: int = 1,
        without: Sequence[str] = (),
    ) -> None:
        self.trials = [t for t in experiment.trials if isinstance(t, CouponTrial)]
        if not self.trials:
            raise InputError("experiment.yaml: trials: expected a coupon")
        self.experiment = experiment
        self.law = law
        self.effects: Mapping[str, CouponEffect] = {n: e for n, e in EFFECTS.items() if n not in without}
        self.records: Sequence[Record] = records_of(self.trials)
        self.baseline = Baseline(self.records, law, terms)
        self.names = self.baseline.names
        self.candidates = candidates_of(self.records, self.effects)
        self._visible = {c: self._shown(c, self.records) for c in self.candidates}

    @property
    def points(self) -> int:
        return sum(r.points for r in self.records)

    # -- what the search asks for --

    def start(self) -> Array:
        return self.baseline.start(self.records)

    def retake(self, state: State, *, rough: bool = False) -> None:
        """Nothing: no nuisance is taken at a state."""
        del state, rough

    def residuals(self, states: Sequence[State]) -> Array:
        found = np.empty((len(states), self.points + len(self.baseline.prior)))
        for row, state in zip(found, states, strict=True):
            row[:] = self._whole(state)
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        z = self._whole(state)
        if not np.isfinite(z).all():
            raise ValueError("the law has no stress at this state")
        by_u = np.zeros((z.size, len(self.names)))
        for k in range(len(self.names)):
            for step in (STEP, -STEP):
                u = state.u.copy()
                u[k] += step
                moved = self._whole(State(u=u, amplitudes=state.amplitudes))
                if np.isfinite(moved).all():
                    by_u[:, k] = (moved - z) / step
                    break
        columns = np.zeros((z.size, len(candidates)))
        for k, c in enumerate(candidates):
            if not self._visible[c]:
                continue
            now = state.amplitudes.get(c, 0.0)
            effect = self.effects[c.effect]
            step = effect.step if now + effect.step <= effect.bounds[1] else -effect.step
            moved = self._whole(State(u=state.u, amplitudes={**state.amplitudes, c: now + step}))
            # a candidate that has no stress one step on explains nothing
            columns[:, k] = np.where(np.isfinite(moved), moved - z, 0.0) / step
        return Linear(state=state, z=z, by_u=by_u, columns=columns, candidates=tuple(candidates))

    def patterns(self) -> Mapping[str, Array]:
        rows = len(self.baseline.prior)
        found = {
            name: np.vstack([columns, np.zeros((rows, columns.shape[1]))])
            for name, columns in patterns_of(self.records).items()
        }
        return {**found, **scatter_patterns(self.points + rows, self.points, self.baseline.held)}

    # -- what folds ask for --

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]:
        """Points by mode, by material, by trial, by loading and unloading, and in fifths of each record."""
        return families_of(self.records)

    def rows(self, group: object) -> NDArray[np.bool_]:
        hit = np.zeros(self.points + len(self.baseline.prior), dtype=bool)
        hit[: self.points] = self._hit(group)
        return hit

    def part(self, group: object, *, others: bool) -> CouponModel:
        kept = self._hit(group) != others
        some = copy(self)
        ends = np.cumsum([r.points for r in self.records])[:-1]
        parts = [r.only(k) for r, k in zip(self.records, np.split(kept, ends), strict=True)]
        some.records = [r for r in parts if r.points]
        return some

    def measuring(self, trials: Sequence[CouponTrial]) -> CouponModel:
        """The same specimens in other trials, which are seen beside those that there are: coordinates and
        candidates stay."""
        some = copy(self)
        some.records = records_of([*self.trials, *trials])[len(self.trials) :]
        both = [*self.records, *some.records]
        some._visible = {c: self._shown(c, both) for c in self.candidates}
        return some

    def unseen(self, group: object) -> NDArray[np.bool_]:
        left = self.part(group, others=True).records
        specimens, materials = {r.specimen for r in left}, {r.material for r in left}
        shape = (len(self.names) - len(self.baseline.specimens)) // len(self.baseline.materials)
        return np.array(
            [s not in specimens for s in self.baseline.specimens]
            + [m not in materials for m in self.baseline.materials for _ in range(shape)]
        )

    def distance_rms(self, state: State) -> float:
        """rms of measured less simulated stress [Pa]."""
        left = np.concatenate([r.stress - p for r, p in zip(self.records, self.stresses(state), strict=True)])
        return float(np.sqrt(np.mean(left**2)))

    def noise_rms(self) -> float:
        """What `distance_rms` would be of the noise alone [Pa]."""
        return float(np.sqrt(np.mean(np.concatenate([r.sd for r in self.records]) ** 2)))

    # -- what reports ask for --

    @property
    def unit(self) -> tuple[str, float]:
        return "kPa", 1e-3

    def advice(self, rivals: list[Explanation]) -> str:
        return most_parted(advise(self, rivals)[0], rivals)

    def remarks(self) -> list[str]:
        return remarks_on(self.records)

    def registered(self, state: State) -> list[Array]:
        """Simulated less measured stress of each record [Pa]. ValueError where a law has none."""
        found = self.stresses(state)
        if not all(np.isfinite(p).all() for p in found):
            raise ValueError("the law has no stress at this state")
        return [p - r.stress for r, p in zip(self.records, found, strict=True)]

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        return mean_moduli(self.baseline.owners, u[: len(self.baseline.owners)])

    def stresses(self, state: State) -> list[Array]:
        """Nominal stress of each record at its stretches [Pa], with the state's effects; NaN where there is
        none."""
        moved, yields = [], []
        for r in self.records:
            acting = self._acting(state, r)
            s = r.stretch.copy()
            for e, a in acting:
                if e.shift is not None:
                    s = s + e.shift(r.stretch, a, r)
            moved.append(s)
            yields.append(sum(e.yields * a for e, a in acting))
        return yielding(lambda own: self._stresses_at(state, own), moved, yields)

    def _stresses_at(self, state: State, stretches: Sequence[Array]) -> list[Array]:
        found = []
        base = self.baseline.stresses(self.records, stretches, state.u)
        for r, s, p in zip(self.records, stretches, base, strict=True):
            whole = p
            acting = self._acting(state, r)
            with np.errstate(all="ignore"):  # a stretch out of range has no stress, and base says so
                for e, a in acting:
                    if e.extra is not None:
                        whole = whole + self.baseline.shear(r, state.u) * e.extra(s, a, r)
                for e, a in acting:
                    if e.factor is not None:
                        whole = whole * e.factor(s, a, r)
            found.append(whole)
        return found

    def _acting(self, state: State, record: Record) -> list[tuple[CouponEffect, float]]:
        """Effects in a record, with the sum of their amplitudes there."""
        total: dict[str, float] = {}
        for c, a in state.amplitudes.items():
            if self._visible[c] and reaches(c, record, self.effects[c.effect]):
                total[c.effect] = total.get(c.effect, 0.0) + a
        return [(self.effects[name], a) for name, a in total.items()]

    def _shown(self, candidate: Candidate, records: Sequence[Record]) -> bool:
        effect = self.effects[candidate.effect]
        return effect.shows([r for r in records if reaches(candidate, r, effect)], records)

    def _whole(self, state: State) -> Array:
        left = [(p - r.stress) / r.sd for r, p in zip(self.records, self.stresses(state), strict=True)]
        return np.concatenate([*left, self.baseline.prior @ state.u - self.baseline.centre])

    def _hit(self, group: object) -> NDArray[np.bool_]:
        assert isinstance(group, frozenset)
        hit = np.zeros(self.points, dtype=bool)
        hit[list(group)] = True
        return hit
