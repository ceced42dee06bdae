"""diagnosis.json read back, format 2 (docs/explanation/diagnosis.md) and format 1.

Names of the file that hold a unit (`rms_kPa`, `rms_kPa_before`) become `rms` and `unit` here. What format 1
did not write is None, or empty.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from calibration.errors import InputError
from calibration.experiment import Strict, parse, say

Verdict = Literal["none", "found", "ambiguous", "partly explained", "unexplained"]
Part = Annotated[float, Field(ge=0.0, le=1.0)]
_RMS = "rms_"


class _Told(Strict):
    """A part of the file in which null says that there is no such value."""

    @model_validator(mode="before")
    @classmethod
    def _without_null(cls, data: Any) -> Any:
        return {k: v for k, v in data.items() if v is not None} if isinstance(data, dict) else data


class _Measured(_Told):
    """A part of the file whose keys rms_UNIT, rms_UNIT_before, ... hold a unit."""

    unit: str = ""

    @model_validator(mode="before")
    @classmethod
    def _unit(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "unit" in data:
            return data
        found: dict[Any, Any] = {}
        for key, value in data.items():
            if isinstance(key, str) and key.startswith(_RMS):
                found["unit"], _, which = key.removeprefix(_RMS).partition("_")
                found[f"rms_{which}" if which else "rms"] = value
            else:
                found[key] = value
        return found


class Amplitude(Strict):
    """In the unit that its name ends with."""

    value: float
    sd: Annotated[float, Field(ge=0.0)]


class Share(_Told):
    """Of the explainable misfit, with its 95 % interval; low and high are None where nothing could be
    resampled. By chance a share may lie beyond 0 and 1."""

    value: float
    low: float | None = None
    high: float | None = None


class Cause(_Told):
    """scope: "all", or the material, specimen or trial that it is in. kind: its form, where it has
    several."""

    effect: str
    parameters: dict[str, Amplitude]
    scope: str
    confidence: Part | None = None
    share: Share | None = None
    kind: str = ""


class FitNumbers(_Measured):
    """A fit in numbers; rms in `unit`."""

    reduced_chi2: float
    p_value: float
    rms: float
    shear_modulus_Pa: dict[str, float]


class Fold(_Measured):
    """A part that was left out, and predicted from the rest."""

    left_out: str
    rms_before: float
    rms_after: float
    rms_noise: float
    skill: float | None = None


class Gain(_Measured):
    """On held-out data; None where nothing was held out."""

    held_out: str
    rms_before: float | None = None
    rms_after: float | None = None
    rms_noise: float | None = None
    log_likelihood: float | None = None
    information_kept: float
    note: str
    skill: float | None = None
    folds: tuple[Fold, ...] = ()


class Nearest(_Told):
    """What comes nearest where nothing is named, and why it is not."""

    causes: tuple[Cause, ...]
    share: Share
    gain: Gain | None = None
    not_named_because: tuple[str, ...]


class RemainderNumbers(_Measured):
    """What is left beside noise; see `calibration.diagnosis.engine.remainder.Remainder`."""

    rms: float
    of_full_scale: float | None = None
    negligible: bool = False
    repeats: Literal["everywhere", "within a material", "within a specimen", "nowhere", "not known"]
    cosines: dict[str, float]
    records: tuple[str, ...]
    place: str


class ModelErrorNumbers(_Measured):
    """The remainder as an error of the model; see `calibration.diagnosis.engine.model_error.ModelError`."""

    rms: float
    of_full_scale: float | None = None
    shear_modulus_relative_sd: dict[str, float]


class NoiseNumbers(_Told):
    """What is known of the noise. layers: repeat, order and specimen as parts of full scale, where repeats
    show them. records: of each that could be looked at, what was assumed and what its scatter shows at
    most, in names that end with the unit."""

    source: Literal["stated", "data"]
    known: bool
    repeats: tuple[str, ...]
    layers: dict[str, float] = Field(default_factory=dict)
    records: tuple[dict[str, str | bool | float], ...]


class Invisible(_Told):
    """threshold: amplitude, in `parameter`, that would show at 5 standard deviations; None where none
    does."""

    effect: str
    parameter: str
    threshold: float | None = None
    instead: str

    @model_validator(mode="before")
    @classmethod
    def _parameter(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "parameter" in data:
            return data
        own = [k for k in data if k not in ("effect", "instead")]
        if len(own) != 1:
            return data
        return {
            **{k: v for k, v in data.items() if k != own[0]},
            "parameter": own[0],
            "threshold": data[own[0]],
        }


class DiagnosisFile(_Told):
    """Content of diagnosis.json."""

    format: Literal[1, 2]
    kind: str = ""
    verdict: Verdict
    sentence: str = ""
    causes: tuple[Cause, ...]
    alternatives: tuple[tuple[str, ...], ...]
    share: Share | None = None
    resampled_over: str = ""
    baseline: FitNumbers
    extended: FitNumbers | None = None
    gain: Gain | None = None
    nearest: Nearest | None = None
    remainder: RemainderNumbers | None = None
    model_error: ModelErrorNumbers | None = None
    noise: NoiseNumbers | None = None
    next_experiment: str
    not_visible: tuple[Invisible, ...] = ()
    notes: tuple[str, ...] = ()
    seconds: float

    @model_validator(mode="after")
    def _of_its_format(self) -> Self:
        if self.format == 1 and (self.verdict == "partly explained" or self.noise is not None):
            raise say("format", "expected 2 of a file with degrees of explanation")
        if self.format == 2 and self.noise is None:
            raise say("noise", "expected it in format 2")
        if bool(self.causes) != (self.verdict in ("found", "ambiguous", "partly explained")):
            raise say("causes", f"expected {'some' if not self.causes else 'none'} of {self.verdict}")
        return self

    @property
    def certain(self) -> tuple[str, ...]:
        """Effects that every alternative has: what the data do tell, where they cannot tell all of it."""
        named = dict.fromkeys(c.effect for c in self.causes)
        return tuple(n for n in named if all(n in names for names in self.alternatives))

    @property
    def shear_moduli(self) -> Mapping[str, float]:
        """By material [Pa], beside the named causes."""
        return (self.extended or self.baseline).shear_modulus_Pa


def read_diagnosis(path: str | Path) -> DiagnosisFile:
    """Read diagnosis.json, or that of a diagnosis' folder. InputError names file, key and expectation."""
    found = Path(path)
    file = found / "diagnosis.json" if found.is_dir() else found
    try:
        text = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: expected a diagnosis.json: {error.strerror}") from None
    return parse(text, file, DiagnosisFile)
