"""The model of a kind of measurement: what all kinds do alike, once.

A kind brings its records, its forward map (`_misfit`), the nuisances of its noise, what a lack of fit might
look like, and the experiments that a lab can do next. Jacobians, whitening, candidates, folds and held-out
scores come from here. `calibration.diagnosis.engine` searches these models for causes,
`calibration.study` fits them.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from calibration.errors import OptionError
from calibration.measurements._baseline import scatter_basis
from calibration.measurements._effect import Candidate, HandedOn, Occurrence
from calibration.measurements._folds import folds_of
from calibration.measurements._forward_model import ForwardModel
from calibration.measurements._layers import Curve, Layers, deviations, layers_of
from calibration.measurements._noise_known import FEWEST, NoiseKnown, PointNoise, roughness
from calibration.measurements._state import State
from calibration.parameters import Parameters

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]


class Record(Protocol):
    """One trial, or one photograph of it. groups : its label at each level that effects may be scoped by.
    ranges : between what it was measured, by a name with its unit in files."""

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


@dataclass(frozen=True, eq=False, kw_only=True)
class Shown:
    """A record as people look at it, point by point.

    Attributes
    ----------
    axis : what x is, with its unit. x : shape (p,), in that unit.
    quantity : what is compared. unit : of it in files, and how many of them are one SI unit.
    measured : shape (p,) [SI]; 0 where what is compared is a distance between simulated and measured.
    of_rows : points by the record's rows, shape (p, rows); None where they are the same.
    """

    axis: str
    x: Array
    quantity: str
    unit: tuple[str, float]
    measured: Array
    of_rows: Array | None = None

    def points(self, rows: Array) -> Array:
        """Values of the record's rows, shape (rows,) or (rows, k), at the points."""
        return rows if self.of_rows is None else np.asarray(self.of_rows @ rows)


class MeasurementModel(ForwardModel):
    """Measurements of one kind, for fit and diagnosis; its attributes are beside those of `ForwardModel`.

    Attributes
    ----------
    kind : name of the kind of measurement.
    unit : of `distance_rms` in files, and how many of them are one SI unit.
    max_causes : that may be named together; more could stand in for a cause that is not in the catalogue.
    compares_specimens : whether moduli that differ between specimens of a material count as a lack of fit.
    experiments : what a lab can do next, the cheapest first.
    enough : improvement of chi-square from which on two explanations are separated by an experiment.
    separates : whether advice asks for an experiment that separates "all" explanations, or "most" of them.
    laws : that may be its baseline's, the simplest first, with terms of a series law; none where the kind
        knows one only.
    noise_scale : the noise from point to point over what `noise` has (`NoiseKnown.scale`).
    """

    kind: ClassVar[str]
    unit: ClassVar[tuple[str, float]]
    max_causes: ClassVar[int] = 3
    compares_specimens: ClassVar[bool] = True
    experiments: ClassVar[Sequence[Any]] = ()
    enough: ClassVar[float] = 25.0
    separates: ClassVar[Literal["all", "most"]] = "all"
    laws: ClassVar[Sequence[tuple[str, int]]] = ()
    noise_scale: float = 1.0

    # -- what a kind brings --

    @abstractmethod
    def start(self) -> Array:
        """Coordinates (n,) to begin the baseline's fit from. ValueError where there are none."""

    @abstractmethod
    def _discrepancies(self) -> Mapping[str, Array]:
        """Sets of columns (rows, k) [SI] by name: what a lack of fit might look like."""

    @abstractmethod
    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        """Labels of all rows, for each set of folds, in order of preference."""

    def suggested_start(self) -> Array | None:
        """Coordinates (n,) near which a fit has to begin, where a scan over moduli would not find it; None
        where one does. ValueError where there are none."""
        return None

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        """Take nuisances and discretisation errors at a state; linearisations from before are void. rough :
        what is dear may be left out."""
        del state, rough

    def begun(self, state: State, candidates: Sequence[Candidate]) -> State:
        """Where a fit begins that takes these causes in beside those of a state: elsewhere where one changes
        what the coordinates stand for."""
        del candidates
        return state

    def predicted_in(self, test: Any, state: State) -> Self | None:
        """The same specimens in one of `experiments`, as a state predicts it; None where it cannot be."""
        del test, state
        return None

    def with_law(self, law: str, terms: int) -> Sequence[Self]:
        """The same measurements with one of `laws` as baseline and no effects, in parts that share no
        coordinate. ValueError where the law has no answer; OptionError of a kind that has one law only."""
        raise OptionError("law", f"{law}:{terms}", f"{self.kind} has one law only, expected auto")

    def law_in(self, material: str, state: State) -> tuple[str, Parameters] | None:
        """The law, with its parameters, that an effect has put in the place of the baseline's; None where
        none has."""
        del material, state
        return None

    def brings(self, candidate: Candidate) -> int:
        """Coordinates that matter only beside a candidate: they count as parameters of its own."""
        del candidate
        return 0

    def remarks(self) -> list[str]:
        """What a reader of the verdict should know of the model, a sentence each."""
        return []

    def shortcomings(self) -> list[str]:
        """How the simulation falls short of what it should be where nuisances were taken last, a sentence
        each, for readers of a fit."""
        return []

    def noise_sentence(self) -> str:
        """What the noise model consists of, for people."""
        return ""

    def point_noise(self) -> list[PointNoise]:
        """What each record shows of its noise from point to point: the scatter of the misfit about a smooth
        curve, in the order of its rows. Nothing where errors are correlated from row to row, or the baseline
        has no answer to begin from."""
        if self.noise.covariance is not None:
            return []
        misfit = self._misfit([State(u=self.start())])[0]
        found = []
        for k, r in enumerate(self.records):
            rows = (self.row_record == k) & self.noise.used & np.isfinite(misfit)
            sd = self.noise.sd[rows]
            factor, points = roughness(misfit[rows] / sd)
            if points >= FEWEST and factor > 0.0:
                assumed = float(np.median(sd))
                found.append(
                    PointNoise(
                        record=str(r.name),
                        stated=self.states_noise(k),
                        assumed=assumed,
                        shown=factor * assumed,
                        points=points,
                    )
                )
        return found

    def states_noise(self, k: int) -> bool:
        """True if the lab states the noise of a record, by its index."""
        return not getattr(self.records[k], "estimated", False)

    def repeated(self) -> tuple[str, ...]:
        """Names of the tests whose repeats show how one differs from the next; () where none do."""
        return ()

    def repeat_of(self, k: int) -> Hashable | None:
        """What a record, by its index, has in common with its repeats, beside material and specimen (mode,
        range, rate, ...); None where no record of this kind counts as a repeat of another."""
        del k
        return None

    def noise_known(self) -> NoiseKnown:
        """What is known of the noise, as it is used: what repeats show counts from here on."""
        stated = all(self.states_noise(k) for k in range(len(self.records)))
        repeats, layers = self.repeated(), Layers()
        points = tuple(self.point_noise())
        if not repeats and not self.noise.columns.shape[1] and self.noise.covariance is None:
            curves = self._curves()
            layers = layers_of(curves)
            if layers.repeat is not None:
                repeats = layers.repeats
                rows = [self.row_record == k for k in range(len(self.records))]
                columns = []
                for own, bends in zip(rows, deviations(curves, layers.repeat), strict=True):
                    for bend in bends:
                        columns.append(np.zeros(len(own)))
                        columns[-1][own] = bend
                self.noise = replace(self.noise, symmetric=True).with_nuisances(columns)
        return NoiseKnown(
            known=stated or bool(repeats), points=points, repeats=repeats, layers=layers, unit=self.unit
        )

    def _curves(self) -> list[Curve]:
        """The misfit where a fit begins, of each record that is driven; none where it is not known."""
        scale = self.full_scale()
        along = [self.along(k) for k in range(len(self.records))]
        if scale is None or any(a is None for a in along):
            return []
        misfit = self._misfit([State(u=self.start())])[0]
        return [
            Curve(
                name=str(r.name),
                material=r.material,
                specimen=r.specimen,
                test=self.repeat_of(k),
                x=a[1],
                misfit=misfit[self.row_record == k],
                scale=float(scale[k]),
            )
            for k, (r, a) in enumerate(zip(self.records, along, strict=True))
            if a is not None
        ]

    def with_noise_of_data(self) -> NoiseKnown:
        """Take the noise of each record as the data show it, where that is not what the lab states; what is
        known of it then."""
        known = self.noise_known()
        factors = {p.record: p.factor for p in known.points if p.contradicts}
        by_record = np.array([factors.get(str(r.name), 1.0) for r in self.records])
        self.noise = replace(self.noise, sd=self.noise.sd * by_record[self.row_record])
        # a median of third differences tells a third of what as many independent points would
        dof = float(np.median([p.points for p in known.points])) / 3.0 if factors else known.dof
        return replace(known, source="data", dof=dof)

    def full_scale(self) -> Array | None:
        """Largest measured value of each record [SI], shape (records,); None where what is compared has no
        scale (distances between simulated and measured)."""
        found = np.array([float(np.abs(self.shown(k).measured).max()) for k in range(len(self.records))])
        return found if (found > 0.0).all() else None

    def along(self, k: int) -> tuple[str, Array] | None:
        """What drives a record, by its index: its name for people, and its value at each of the record's
        rows; None where rows are no points along anything."""
        del k
        return None

    def shown(self, k: int) -> Shown:
        """A record, by index, as people look at it."""
        rows = int(np.count_nonzero(self.row_record == k))
        return Shown(
            axis="row of the record",
            x=np.arange(float(rows)),
            quantity="simulated less measured",
            unit=self.unit,
            measured=np.zeros(rows),
        )

    # -- lack of fit, folds, scores --

    def discrepancy_basis(self) -> Mapping[str, Array]:
        """Sets of whitened columns (m, k) by name: what a lack of fit might look like."""
        prior = len(self.baseline.prior)
        found = {
            name: np.vstack([self.noise.whiten(raw), np.zeros((prior, raw.shape[1]))])
            for name, raw in self._discrepancies().items()
        }
        if self.compares_specimens:
            found.update(scatter_basis(self.points + prior, self.points, self.baseline.held))
        return found

    def folds(self) -> Mapping[str, Sequence[tuple[str, Rows]]]:
        """Sets of folds by name, in order of preference: rows (rows,) that are left out together."""
        return folds_of(self._fold_labels())

    def rows(self, fold: Rows) -> Rows:
        """Where a fold's measurements stand among the residuals, shape (m,)."""
        prior = np.zeros(len(self.baseline.prior), dtype=bool)
        return np.concatenate([fold[self.noise.used], prior])

    def subset(self, fold: Rows, *, others: bool) -> Self:
        """The measurements of a fold, or all others; nuisances stay as they were taken."""
        some = copy(self)
        some.noise = self.noise.subset(~fold if others else fold)
        return some

    def unconstrained(self, fold: Rows) -> Rows:
        """Coordinates u that nothing outside of a fold constrains, shape (n,)."""
        left = self.noise.used & ~fold
        found = np.zeros(len(self.names), dtype=bool)
        for k in np.unique(self.row_record[left]):
            found |= self._constrains(self.records[k])
        return np.asarray(~found)

    def _constrains(self, record: Any) -> Rows:
        """Coordinates u that a record constrains, shape (n,): its material's, those of all its specimens."""
        return self.baseline.informed_by(record, whole_material=True)

    def distance_rms(self, state: State) -> float:
        """Root mean square of simulated less measured, the most likely nuisances removed [SI]. ValueError
        where the state has no answer."""
        misfit = self._misfit([state])[0]
        if not np.isfinite(misfit[self.noise.used]).all():
            raise ValueError(self.no_answer)
        left = self.noise.remove(misfit)[self.noise.used]
        return float(np.sqrt(left @ left / self._measured_points()))

    def noise_rms(self) -> float:
        """What `distance_rms` would be of the noise alone [SI]."""
        return self.noise_scale * float(np.sqrt(self.noise.removed_variance() / self._measured_points()))

    def _measured_points(self) -> int:
        """Measured points behind the rows that are used."""
        return self.points

    def registered(self, state: State) -> list[Array]:
        """Simulated less measured, the most likely nuisances removed, of each record [SI]; NaN where nothing
        is compared. ValueError where the state has no answer."""
        misfit = self._misfit([state])[0]
        if not np.isfinite(misfit[self.noise.used]).all():
            raise ValueError(self.no_answer)
        left = np.where(self.noise.used, self.noise.remove(misfit), np.nan)
        return [left[self.row_record == k] for k in range(len(self.records))]

    def nuisance_values(self, state: State) -> dict[str, float]:
        """Most likely value of each nuisance that has a name [its sd]. ValueError where the state has no
        answer."""
        misfit = self._misfit([state])[0]
        if not np.isfinite(misfit[self.noise.used]).all():
            raise ValueError(self.no_answer)
        values = self.noise.estimate(misfit)
        return {name: float(b) for name, b in zip(self.noise.names, values, strict=False) if name}

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        return self.baseline.shear_moduli(u)

    def hands_on(self, candidate: Candidate, state: State) -> Mapping[str, HandedOn]:
        """The part of the material that an effect is at a state, by material; none for other effects, and for
        one that was found in a specimen or a trial alone."""
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
        """Between what an effect was measured, by the quantity's name in files."""
        found: dict[str, tuple[float, float]] = {}
        for r, hit in zip(self.records, self.reached(candidate), strict=True):
            for name, (low, high) in r.ranges.items() if hit else ():
                old = found.get(name, (low, high))
                found[name] = (min(low, old[0]), max(high, old[1]))
        return found
