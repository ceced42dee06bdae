"""Reader of diagnosis.json, formats 1 and 2 (docs/explanation/diagnosis.md).

Keys of the file that contain a unit (`rms_kPa`, `rms_kPa_before`) become `rms`, `rms_before` and `unit`.
Entries that format 1 does not have are None or empty.
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


class _Section(Strict):
    """A section of the file in which null is equivalent to a missing key."""

    @model_validator(mode="before")
    @classmethod
    def _without_null(cls, data: Any) -> Any:
        return {k: v for k, v in data.items() if v is not None} if isinstance(data, dict) else data


class _Measured(_Section):
    """A section of the file whose keys rms_UNIT, rms_UNIT_before, ... contain a unit."""

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
    """Value and standard deviation of a parameter, in the unit that its name ends with."""

    value: float
    sd: Annotated[float, Field(ge=0.0)]


class Share(_Section):
    """Fraction of the explainable misfit with its 95 % interval.

    low and high are None if there is no bootstrap. By chance the values may lie outside 0 to 1.
    """

    value: float
    low: float | None = None
    high: float | None = None


class Cause(_Section):
    """A cause of the explanation.

    Attributes
    ----------
    effect : name of the effect.
    parameters : amplitude, and position if it has one, by name.
    scope : "all", or the material, specimen, trial or other group that it is in.
    confidence : probability that the explanation is ranked first under new noise.
    share : fraction of the explainable misfit that it removes.
    kind : variant of the effect in words; "" if it has one only.
    """

    effect: str
    parameters: dict[str, Amplitude]
    scope: str
    confidence: Part | None = None
    share: Share | None = None
    kind: str = ""


class FitNumbers(_Measured):
    """Summary of a fit; rms in `unit`."""

    reduced_chi2: float
    p_value: float
    rms: float
    shear_modulus_Pa: dict[str, float]


class Fold(_Measured):
    """Prediction errors of one held-out fold; rms in `unit`."""

    left_out: str
    rms_before: float
    rms_after: float
    rms_noise: float
    skill: float | None = None


class Gain(_Measured):
    """Held-out scores; rms in `unit`. Scores are None if nothing was held out."""

    held_out: str
    rms_before: float | None = None
    rms_after: float | None = None
    rms_noise: float | None = None
    log_likelihood: float | None = None
    information_kept: float
    note: str
    skill: float | None = None
    folds: tuple[Fold, ...] = ()


class Nearest(_Section):
    """Nearest explanation if none is named, and the reasons why it is not named."""

    causes: tuple[Cause, ...]
    share: Share
    gain: Gain | None = None
    not_named_because: tuple[str, ...]


class RemainderNumbers(_Measured):
    """Unexplained misfit; see `calibration.diagnosis.engine.remainder.Remainder`."""

    rms: float
    of_full_scale: float | None = None
    negligible: bool = False
    repeats: Literal["everywhere", "within a material", "within a specimen", "nowhere", "not known"]
    cosines: dict[str, float]
    records: tuple[str, ...]
    place: str


class ModelErrorNumbers(_Measured):
    """Model error; see `calibration.diagnosis.engine.model_error.ModelError`."""

    rms: float
    of_full_scale: float | None = None
    shear_modulus_relative_sd: dict[str, float]


class NoiseNumbers(_Section):
    """Knowledge of the noise.

    Attributes
    ----------
    source : "stated" by the lab or taken from the "data".
    known : True if the noise is stated or determined by repeats.
    repeats : names of the tests with repeats.
    layers : scatter of repeat, order and specimen relative to full scale, as far as repeats determine it.
    records : assumed noise and the upper bound from the scatter of each record that could be examined, in
        keys that end with the unit.
    """

    source: Literal["stated", "data"]
    known: bool
    repeats: tuple[str, ...]
    layers: dict[str, float] = Field(default_factory=dict)
    records: tuple[dict[str, str | bool | float], ...]


class Invisible(_Section):
    """An effect that the design cannot detect.

    Attributes
    ----------
    effect : name of the effect.
    parameter : name of its amplitude, which ends with the unit.
    threshold : amplitude of 5 standard deviations; None if no amplitude is detectable.
    instead : recommended measure on the bench.
    """

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


class DiagnosisFile(_Section):
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
        """Effects common to all alternatives, which the data therefore determine."""
        named = dict.fromkeys(c.effect for c in self.causes)
        return tuple(n for n in named if all(n in names for names in self.alternatives))

    @property
    def shear_moduli(self) -> Mapping[str, float]:
        """Shear modulus by material [Pa], with the named causes if there are any."""
        return (self.extended or self.baseline).shear_modulus_Pa


def read_diagnosis(path: str | Path) -> DiagnosisFile:
    """Read diagnosis.json, or the one in a folder. InputError names the file, the key and the expectation."""
    found = Path(path)
    file = found / "diagnosis.json" if found.is_dir() else found
    try:
        text = file.read_bytes()
    except OSError as error:
        raise InputError(f"{file}: expected a diagnosis.json: {error.strerror}") from None
    return parse(text, file, DiagnosisFile)
