"""prediction.json: its schema (pydantic), and how a prediction is written in it.

Numbers are in the unit that `unit` names. Format 1.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from calibration._numerics import rms_of
from calibration.inference import LEVEL, WIDTH
from calibration.prediction._interval import SOURCES, Record
from calibration.prediction.run import EXTENDED, Prediction

Array = NDArray[np.float64]
FORMAT = 1

NotNegative = Annotated[float, Field(ge=0)]
Name = Literal["baseline", "extended"]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Curve(_Strict):
    """A model's prediction of a record, point by point, with the ends of its 95 % interval for a measurement
    there."""

    predicted: list[float]
    low: list[float]
    high: list[float]


class Score(_Strict):
    """Scores of a model's prediction of some points.

    Attributes
    ----------
    rms : root mean square of predicted minus measured.
    coverage : fraction of the points that lie within their intervals.
    sd : root mean square of the interval's standard deviation, by source: parameters, specimens, noise, model
        error, choice.
    """

    rms: NotNegative
    coverage: Annotated[float, Field(ge=0, le=1)]
    sd: dict[str, NotNegative]


class Entry(_Strict):
    """Records that are scored together.

    Attributes
    ----------
    points : measured points that are compared.
    unit : unit of rms and sd.
    rms_noise : expected rms of noise alone.
    models : scores of the models by name.
    skill : (rms_base^2 - rms_ext^2) / (rms_base^2 - rms_noise^2); null without both models, or where the
        baseline predicts as well as noise allows.
    """

    points: int
    unit: str
    rms_noise: NotNegative
    models: dict[Name, Score]
    skill: float | None


class RecordEntry(Entry):
    """A record: a trial, or one photograph of it.

    Attributes
    ----------
    axis : label of x, with its unit. quantity : compared quantity.
    measured : 0 where what is compared is a distance between simulated and measured.
    curves : predictions by model.
    """

    record: str
    trial: str
    kind: str
    material: str
    specimen: str
    axis: str
    x: list[float]
    quantity: str
    measured: list[float]
    curves: dict[Name, Curve]


class ModelEntry(_Strict):
    """A model that predicts.

    Attributes
    ----------
    label : its causes, or parts.
    shear_modulus_Pa : that its material states, by material. model_error : relative, of the modulus.
    """

    label: str
    shear_modulus_Pa: dict[str, float]
    model_error: dict[str, NotNegative]


class PredictionFile(_Strict):
    """Content of prediction.json.

    Attributes
    ----------
    source : description of the source of the models.
    experiment, experiment_sha256 : experiment of the trials that are predicted.
    level : level of the intervals.
    models : labels by name. kinds : scores by kind of measurement. records : the records.
    notes : sentences for the reader.
    """

    format: Literal[1] = 1
    sentence: str
    source: str
    experiment: str
    experiment_sha256: str
    level: float = LEVEL
    models: dict[Name, ModelEntry]
    kinds: dict[str, Entry]
    records: list[RecordEntry]
    notes: list[str]
    seconds: NotNegative


def file_of(found: Prediction) -> PredictionFile:
    """A prediction as its file holds it."""
    return PredictionFile(
        sentence=found.sentence(),
        source=found.source,
        experiment=found.experiment.name,
        experiment_sha256=found.experiment.digest,
        models={
            name: ModelEntry(
                label=label,
                shear_modulus_Pa={m: float(g) for m, g in found.shear_moduli[name].items()},
                model_error={m: float(e) for m, e in found.model_errors[name].items()},
            )
            for name, label in found.labels.items()
        },
        kinds={kind: Entry(**_scores(found, mine)) for kind, mine in found.of_kind().items()},
        records=[_record(found, r) for r in found.records],
        notes=list(found.notes),
        seconds=round(found.seconds, 1),
    )


def _scores(found: Prediction, records: list[Record]) -> dict[str, Any]:
    unit, per_si = records[0].shown.unit
    return {
        "points": sum(int(r.used.sum()) for r in records),
        "unit": unit,
        "rms_noise": per_si * found.noise(records),
        "models": {
            m: Score(
                rms=per_si * found.rms(records, m),
                coverage=found.coverage(records, m),
                sd={s: per_si * rms_of(r.sd(m, s) for r in records) for s in SOURCES},
            )
            for m in found.models
        },
        "skill": found.skill(records),
    }


def _record(found: Prediction, r: Record) -> RecordEntry:
    shown, (_, per_si) = r.shown, r.shown.unit
    curves: dict[Name, Curve] = {}
    for m in found.models:
        value, wide = r.predicted[m].value, WIDTH * r.predicted[m].sd
        curves[m] = Curve(
            predicted=_plain(per_si * value, r),
            low=_plain(per_si * (value - wide), r),
            high=_plain(per_si * (value + wide), r),
        )
    return RecordEntry(
        record=r.name,
        trial=r.trial,
        kind=r.kind,
        material=r.material,
        specimen=r.specimen,
        axis=shown.axis,
        x=_plain(shown.x, r),
        quantity=shown.quantity,
        measured=_plain(per_si * shown.measured, r),
        curves=curves,
        **_scores(found, [r]),
    )


def _plain(values: Array, r: Record) -> list[float]:
    """Values of the points that are compared, to six digits."""
    return [float(f"{v:.6g}") for v in values[r.used]]


__all__ = ["EXTENDED", "FORMAT", "PredictionFile", "file_of"]
