"""Prediction of a record by a model, with intervals from five sources.

    predicted less measured = J du + change * d + choice + noise

du are errors of the fitted coordinates (and, of a specimen that was not seen, how specimens of a material
scatter), d the relative error of the model, `change` what the same change of all moduli would do. Nuisances
of the measurement (a photograph's registration, a load cell's zero) are taken out of predictions as of
measurements, at their most likely values. choice: other models explain what was fitted as well, and predict
something else; each is as likely as the one that predicts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._baseline import SCATTER
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noisy_model import Shown
from calibration.measurements._state import State

Array = NDArray[np.float64]

SOURCES = ("parameters", "specimens", "noise", "model error", "choice")


@dataclass(frozen=True, eq=False, kw_only=True)
class Calibrated:
    """A model with what is known of it before the trials that it predicts.

    Attributes
    ----------
    label : name in tables ("baseline", "rate-dependence").
    state : coordinates of the measurement model, and amplitudes of effects.
    candidates : effects, in the order of the covariance.
    parameters : covariance of coordinates and amplitudes, shape (n + c, n + c).
    specimens : the same, of what is not known of specimens that were not seen.
    model_error : relative, of all moduli.
    unseen_scatter : sd of ln G of a named specimen, where `specimens` does not say.
    """

    label: str
    state: State
    parameters: Array
    specimens: Array
    model_error: float
    candidates: tuple[Candidate, ...] = ()
    unseen_scatter: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class PredictedRecord:
    """A record by one model, point by point.

    Attributes
    ----------
    value : predicted [SI], shape (p,).
    sds : standard deviations by source [SI], shape (p,) each.
    """

    value: Array
    sds: Mapping[str, Array]

    @property
    def sd(self) -> Array:
        """Standard deviation of measured less predicted, shape (p,)."""
        return np.asarray(np.sqrt(np.sum([s**2 for s in self.sds.values()], axis=0)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """A record as it was measured, and as models predict it.

    Attributes
    ----------
    name, trial, material, specimen, kind : names of the record, and of what it belongs to.
    shown : axes and measured values; `used` : points of it that are compared, shape (p,).
    predicted : prediction by model.
    """

    name: str
    trial: str
    material: str
    specimen: str
    kind: str
    shown: Shown
    used: NDArray[np.bool_]
    predicted: Mapping[str, PredictedRecord]

    def error(self, model: str) -> Array:
        """Predicted less measured at the points that are compared [SI]."""
        return np.asarray((self.predicted[model].value - self.shown.measured)[self.used])

    def sd(self, model: str, source: str | None = None) -> Array:
        """Standard deviation of that error, all sources together or one [SI]."""
        found = self.predicted[model]
        return np.asarray((found.sd if source is None else found.sds[source])[self.used])


def predict_records(
    test: MeasurementModel,
    models: Mapping[Any, tuple[MeasurementModel, Calibrated]],
    alternatives: Mapping[Any, Sequence[tuple[MeasurementModel, Calibrated]]] | None = None,
) -> list[Record]:
    """Predict each compared record of `test` by each of the models.

    `models` maps a name to the model of the coordinates (whose noise has the rows of `test`) and its
    calibration; `alternatives` to equivalent explanations. ValueError if a prediction has no equilibrium.
    """
    some = [k for k in range(len(test.records)) if test.noise.used[test.row_record == k].any()]
    by_model = {name: _predicted(model, known, some) for name, (model, known) in models.items()}
    for name, others in (alternatives or {}).items():
        by_model[name] = _with_choice(by_model[name], [_predicted(m, known, some) for m, known in others])
    found = []
    for k in some:
        r = test.records[k]
        shown = test.shown(k)
        used = test.noise.used[test.row_record == k].astype(float)
        found.append(
            Record(
                name=r.name,
                trial=r.groups.get("trial", r.name),
                material=r.material,
                specimen=r.specimen,
                kind=test.kind,
                shown=shown,
                used=np.abs(shown.points(np.eye(used.size))) @ (1.0 - used) <= 0.0,
                predicted={
                    name: replace(p[k], value=p[k].value + shown.measured) for name, p in by_model.items()
                },
            )
        )
    return found


def _predicted(model: MeasurementModel, known: Calibrated, some: Sequence[int]) -> dict[int, PredictedRecord]:
    """Records by index, with simulated minus measured in place of the predicted value.

    ValueError if the model has no solution.
    """
    model.update_nuisances(known.state)
    misfit, slopes = model.sensitivities(known.state, known.candidates)
    used = model.noise.used
    if not np.isfinite(misfit[used]).all():
        raise ValueError(model.no_answer)
    misfit, slopes = np.where(used, misfit, 0.0), np.where(used[:, None], slopes, 0.0)
    slopes = np.where(np.isfinite(slopes), slopes, 0.0)
    change = slopes[:, : len(known.state.u)] @ all_moduli(model, known.state.u)
    left, slopes, change = (model.noise.remove(x) for x in (misfit, slopes, change))
    noise = _noise_left(model)
    unseen = np.array([_unseen(model.records[k], known) for k in range(len(model.records))])
    found = {}
    for k in some:
        rows = model.row_record == k
        shown = model.shown(k)
        by_point = shown.points(slopes[rows])
        moved = shown.points(change[rows])
        specimens = np.einsum("pi,ij,pj->p", by_point, known.specimens, by_point)
        sds = {
            "parameters": np.sqrt(
                np.maximum(np.einsum("pi,ij,pj->p", by_point, known.parameters, by_point), 0.0)
            ),
            "specimens": np.sqrt(np.maximum(specimens, 0.0) + (unseen[k] * moved) ** 2),
            "noise": np.sqrt(np.sum(shown.points(noise[rows]) ** 2, axis=1))
            if noise.ndim == 2
            else np.sqrt(shown.points(np.eye(int(rows.sum()))) ** 2 @ noise[rows] ** 2),
            "model error": np.abs(known.model_error * moved),
            "choice": np.zeros(len(moved)),
        }
        found[k] = PredictedRecord(value=shown.points(left[rows]), sds=sds)
    return found


def _with_choice(
    chosen: dict[int, PredictedRecord], others: Sequence[dict[int, PredictedRecord]]
) -> dict[int, PredictedRecord]:
    """Predicted records of the chosen model, with the spread of all equally likely models about it."""
    found = {}
    for k, own in chosen.items():
        squares = [(other[k].value - own.value) ** 2 for other in others]
        choice = np.sqrt(np.sum(squares, axis=0) / (len(others) + 1)) if others else own.sds["choice"]
        found[k] = replace(own, sds={**own.sds, "choice": choice})
    return found


def _unseen(record: object, known: Calibrated) -> float:
    """A record that names no specimen has its material's."""
    named = getattr(record, "specimen", "") not in ("", getattr(record, "material", ""))
    return known.unseen_scatter if named else 0.0


def _noise_left(model: MeasurementModel) -> Array:
    """A root of the covariance of noise, the most likely nuisances removed: (rows, m), or the standard
    deviations (rows,) of rows that are independent."""
    noise = model.noise
    used = noise.used
    if noise.covariance is None and not noise.columns.shape[1]:
        return np.where(used, noise.sd, 0.0)
    data = noise.data_covariance()
    root = np.linalg.cholesky(data + noise.columns[used] @ noise.columns[used].T)
    whole = np.zeros((len(used), root.shape[1]))
    whole[used] = root
    return np.where(used[:, None], noise.remove(whole), 0.0)


def all_moduli(model: MeasurementModel, u: Array) -> Array:
    """The change of the coordinates (n,) that raises all shear moduli by one in their logarithm."""
    found = np.zeros(len(u))
    for material in model.baseline.materials:
        weights = model.baseline.modulus_weights(material, u)
        found = found + weights / (weights @ weights)
    return found


def of_unseen(model: MeasurementModel, fold: NDArray[np.bool_], jacobian: Array) -> Array:
    """Covariance (k, k) of what a fit leaves open of coordinates that only a fold informs, all others held:
    how specimens scatter by the prior."""
    k = jacobian.shape[1]
    found = np.zeros((k, k))
    seen = np.zeros(len(model.names), dtype=bool)
    for j in np.unique(model.row_record[model.noise.used & ~fold]):
        seen |= model._depends_on(model.records[j]) & _own(model, len(seen))
    open_ = np.flatnonzero(_own(model, len(seen)) & ~seen)
    if open_.size:
        precision = jacobian[:, open_].T @ jacobian[:, open_]
        found[np.ix_(open_, open_)] = np.linalg.pinv(precision, hermitian=True)
    return found


def _own(model: MeasurementModel, size: int) -> NDArray[np.bool_]:
    """Coordinates that are moduli of specimens, shape (size,)."""
    count = 0 if model.baseline.whole else len(model.baseline.specimens)
    return np.arange(size) < count


__all__ = [
    "SCATTER",
    "SOURCES",
    "Calibrated",
    "PredictedRecord",
    "Record",
    "all_moduli",
    "of_unseen",
    "predict_records",
]
