"""Base class of the models of all kinds of measurement.

A kind defines its records, its forward map (`_misfit`), the nuisances of its noise, its discrepancy basis and
the experiments that a lab can do next. Jacobians, whitening, candidates, folds and held-out scores are
inherited. `calibration.diagnosis.engine` searches these models for causes, `calibration.study` fits them.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from typing import Any, ClassVar, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from calibration.errors import OptionError
from calibration.measurements._baseline import scatter_basis
from calibration.measurements._effect import Candidate, HandedOn, Occurrence
from calibration.measurements._folds import folds_of
from calibration.measurements._noise_known import POINTS_PER_FREEDOM, Estimated
from calibration.measurements._noisy_model import NoisyModel
from calibration.measurements._state import State
from calibration.parameters import Parameters

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]


class Record(Protocol):
    """One trial, or one photograph of it.

    Attributes
    ----------
    name, material, specimen : names of the trial, its material and its specimen.
    groups : label at each level to which effects may be restricted.
    ranges : measured range of each quantity (low, high), by its name in files, which includes the unit.
    """

    @property
    def name(self) -> str: ...

    @property
    def material(self) -> str: ...

    @property
    def specimen(self) -> str: ...

    @property
    def groups(self) -> Mapping[str, str]: ...

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]: ...


class MeasurementModel(NoisyModel):
    """Measurements of one kind, for fit and diagnosis; attributes in addition to those of `NoisyModel`.

    Attributes
    ----------
    kind : name of the kind of measurement.
    max_causes : largest number of causes named together; more could replace a cause that the catalogue lacks.
    compares_specimens : True if different moduli of specimens of one material count as a lack of fit.
    experiments : experiments that a lab can do next, the cheapest first.
    enough : smallest difference of chi-square for which an experiment separates two explanations.
    separates : "all" or "most": the explanations that a recommended experiment must separate.
    laws : (law, terms) that can be the baseline, the simplest first; empty if the kind has one law only.
    noise_scale : ratio of the noise from point to point to that in `noise` (`NoiseKnown.scale`).
    """

    kind: ClassVar[str]
    max_causes: ClassVar[int] = 3
    compares_specimens: ClassVar[bool] = True
    experiments: ClassVar[Sequence[Any]] = ()
    enough: ClassVar[float] = 25.0
    separates: ClassVar[Literal["all", "most"]] = "all"
    laws: ClassVar[Sequence[tuple[str, int]]] = ()
    noise_scale: float = 1.0

    # -- what a kind brings --

    @abstractmethod
    def _discrepancies(self) -> Mapping[str, Array]:
        """Discrepancy basis before whitening: sets of columns (rows, k) [SI] by name."""

    @abstractmethod
    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        """Fold labels of all rows by set of folds, in order of preference."""

    def suggested_start(self) -> Array | None:
        """Coordinates (n,) near which a fit must start if a scan over moduli would miss it; None otherwise.

        ValueError if there are none.
        """
        return None

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        """Update nuisances and discretisation errors at a state; earlier linearisations become invalid.

        rough : True permits leaving out expensive parts.
        """
        del state, rough

    def begun(self, state: State, candidates: Sequence[Candidate]) -> State:
        """Start of a fit that adds these candidates to a state.

        It differs from the state if a candidate changes the meaning of the coordinates.
        """
        del candidates
        return state

    def predicted_in(self, test: Any, state: State) -> Self | None:
        """Model of the same specimens in one of `experiments`, with the data that a state predicts.

        None if the experiment cannot be done or predicted.
        """
        del test, state
        return None

    def with_law(self, law: str, terms: int) -> Sequence[Self]:
        """The same measurements with one of `laws` as baseline and no effects.

        The models that are returned share no coordinate. ValueError for an unknown law; OptionError for a
        kind that has one law only.
        """
        raise OptionError("law", f"{law}:{terms}", f"{self.kind} has one law only, expected auto")

    def law_in(self, material: str, state: State) -> tuple[str, Parameters] | None:
        """Name and parameters of the law by which an effect replaces the baseline's; None if none does."""
        del material, state
        return None

    def brings(self, candidate: Candidate) -> int:
        """Number of coordinates that matter only with this candidate; they count as its parameters."""
        del candidate
        return 0

    def remarks(self) -> list[str]:
        """Sentences on assumptions and limits of the model, for the verdict."""
        return []

    def left_out(self) -> list[str]:
        """A sentence for each part of a record that is not compared, for a fit's report."""
        return []

    def shortcomings(self) -> list[str]:
        """Sentences on deficiencies of the simulation at the last update of nuisances, for a fit's report."""
        return []

    def noise_sentence(self) -> str:
        """Description of the noise model, for reports."""
        return ""

    def noise_freedom(self) -> float:
        """Degrees of freedom of the noise's sd: few if estimated from few points, infinite if stated."""
        found = self.estimated_noise()
        rows = np.bincount(found.group[found.group >= 0], minlength=len(found.freedom))
        doubt = float(np.sum(rows**2 / found.freedom))
        return self.points**2 / doubt if doubt else np.inf

    def estimated_noise(self) -> Estimated:
        """Residuals whose sd was estimated from their own scatter: tests of residuals allow for its error."""
        estimates = self._scatter_points()
        there = list(dict.fromkeys(e for e in estimates if e is not None))
        number = {e: n for n, e in enumerate(there)}
        of_row = np.array([-1 if e is None else number[e] for e in estimates], dtype=np.intp)
        prior = np.full(len(self.baseline.prior), -1, dtype=np.intp)
        return Estimated(
            group=np.concatenate([of_row[self.noise.used], prior]),
            freedom=np.array([points for _, points in there]) / POINTS_PER_FREEDOM,
        )

    def _scatter_points(self) -> Sequence[tuple[Hashable, float] | None]:
        """For each row the estimate that its sd is of, and the number of points from which it was made.

        None for a row whose sd is stated, or assumed. A record has one estimate.
        """
        each: list[tuple[Hashable, float] | None] = []
        for r in self.records:
            points = self.from_data.get(str(r.name), getattr(r, "scatter_points", 0))
            each.append((str(r.name), float(points)) if points else None)
        return [each[k] for k in self.row_record]

    # -- lack of fit, folds, scores --

    def discrepancy_basis(self) -> Mapping[str, Array]:
        """Discrepancy basis: sets of whitened columns (m, k) by name."""
        prior = len(self.baseline.prior)
        found = {
            name: np.vstack([self.noise.whiten(raw), np.zeros((prior, raw.shape[1]))])
            for name, raw in self._discrepancies().items()
        }
        if self.compares_specimens:
            found.update(scatter_basis(self.points + prior, self.points, self.baseline.held))
        return found

    def folds(self) -> Mapping[str, Sequence[tuple[str, Rows]]]:
        """Sets of folds by name, in order of preference; a fold is a label with its mask of rows (rows,)."""
        return folds_of(self._fold_labels())

    def rows(self, fold: Rows) -> Rows:
        """Mask of a fold's measurements in the residuals, shape (m,)."""
        prior = np.zeros(len(self.baseline.prior), dtype=bool)
        return np.concatenate([fold[self.noise.used], prior])

    def subset(self, fold: Rows, *, others: bool) -> Self:
        """Model of the measurements of a fold, or of all others; nuisances stay as they are."""
        some = copy(self)
        some.noise = self.noise.subset(~fold if others else fold)
        return some

    def unconstrained(self, fold: Rows) -> Rows:
        """Mask (n,) of the coordinates u that no measurement outside of a fold constrains."""
        left = self.noise.used & ~fold
        found = np.zeros(len(self.names), dtype=bool)
        for k in np.unique(self.row_record[left]):
            found |= self._constrains(self.records[k])
        return np.asarray(~found)

    def _constrains(self, record: Any) -> Rows:
        """Mask (n,) of the coordinates u that a record constrains: all of its material's, without extras."""
        return self.baseline.informed_by(record, whole_material=True)

    def _solved_misfit(self, state: State) -> Array:
        """Simulated minus measured at a state [SI], shape (rows,). ValueError if it has no solution."""
        misfit = self._misfit([state])[0]
        if not np.isfinite(misfit[self.noise.used]).all():
            raise ValueError(self.no_answer)
        return misfit

    def distance_rms(self, state: State) -> float:
        """Root mean square of simulated minus measured [SI], after removal of the most likely nuisances.

        ValueError if the state has no solution.
        """
        misfit = self._solved_misfit(state)
        left = self.noise.remove(misfit)[self.noise.used]
        return float(np.sqrt(left @ left / self._measured_points()))

    def noise_rms(self) -> float:
        """Expected `distance_rms` of the noise alone [SI]."""
        return self.noise_scale * float(np.sqrt(self.noise.removed_variance() / self._measured_points()))

    def _measured_points(self) -> int:
        """Number of measured points of the rows that are used."""
        return self.points

    def registered(self, state: State) -> list[Array]:
        """Simulated minus measured of each record [SI], after removal of the most likely nuisances.

        NaN in rows that are not compared. ValueError if the state has no solution.
        """
        misfit = self._solved_misfit(state)
        left = np.where(self.noise.used, self.noise.remove(misfit), np.nan)
        return [left[self.row_record == k] for k in range(len(self.records))]

    def nuisance_values(self, state: State) -> dict[str, float]:
        """Most likely value of each named nuisance, in its standard deviations.

        ValueError if the state has no solution.
        """
        misfit = self._solved_misfit(state)
        values = self.noise.estimate(misfit)
        return {name: float(b) for name, b in zip(self.noise.names, values, strict=False) if name}

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Shear modulus of each material [Pa]: the geometric mean over its specimens."""
        return self.baseline.shear_moduli(u)

    def hands_on(self, candidate: Candidate, state: State) -> Mapping[str, HandedOn]:
        """Constitutive part that an effect represents at a state, by material.

        Empty for effects that represent none, and for a candidate of a single specimen or trial.
        """
        effect = self.effects[candidate.effect]
        if effect.hands_on is None or candidate not in state.amplitudes:
            return {}
        hit = self.reached(candidate)
        moduli = self.shear_moduli(state.u)
        found = {}
        for material, shear_modulus in moduli.items():
            mine = [r for r, h in zip(self.records, hit, strict=True) if h and r.material == material]
            if mine and candidate.at in ("all", material):
                occurrence = Occurrence(
                    amplitude=state.amplitudes[candidate],
                    variant=candidate.variant,
                    shear_modulus=shear_modulus,
                    records=mine,
                )
                found[material] = effect.hands_on(occurrence)
        return found

    def valid_range(self, candidate: Candidate) -> dict[str, tuple[float, float]]:
        """Measured ranges of a candidate's records (low, high), by the quantity's name in files."""
        found: dict[str, tuple[float, float]] = {}
        for r, hit in zip(self.records, self.reached(candidate), strict=True):
            for name, (low, high) in r.ranges.items() if hit else ():
                old = found.get(name, (low, high))
                found[name] = (min(low, old[0]), max(high, old[1]))
        return found
