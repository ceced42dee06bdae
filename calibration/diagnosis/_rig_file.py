"""Format of rig.yaml: effects of rig, camera or simulator found by a diagnosis."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.experiment import Strict, say
from calibration.measurements._effect import EffectModel
from calibration.measurements.outlines._effect import OutlineEffect

FORMAT = 1
DIGITS = 1e-5  # relative rounding error of numbers with six digits, as in files

Corrects = Literal["outlines", "nothing"]
_NO_DATASET = "It belongs to no material: it must not enter a dataset, and factory.build refuses it."
USES: dict[Corrects, str] = {
    "outlines": (
        "Corrects later calibrations of photographed beams on this rig (calibration.fit --rig rig.yaml)."
        f" {_NO_DATASET}"
    ),
    "nothing": (
        "A record, which no command reads: calibration.fit --rig corrects outlines of photographed beams, and"
        f" this was found on other measurements. The cards beside it allow for it. {_NO_DATASET}"
    ),
}


def corrects(effects: Iterable[EffectModel]) -> Corrects:
    """Measurements that a rig file with these effects corrects.

    A calibration of photographed beams applies the effects to its scenes and images. Effects in cantilever
    release, homogeneous, compression and indentation tests are used by their diagnosis only.
    """
    return "outlines" if all(isinstance(e, OutlineEffect) for e in effects) else "nothing"


Text = Annotated[str, Field(min_length=1, max_length=300)]
Hash = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Amplitude(Strict):
    """A parameter in the unit that its name ends with, and its standard deviation."""

    value: float
    sd: Annotated[float, Field(ge=0)]


class RigEffect(Strict):
    """An effect found by a diagnosis.

    Attributes
    ----------
    effect : name of the effect.
    belongs_to : rig, camera or simulator.
    scope : "all", or the material, specimen or trial that it was found in.
    parameters : its amplitude by name.
    valid_range : measured ranges by the quantity's name.
    rivals : alternative sets of effects that the data cannot exclude.
    """

    effect: Text
    belongs_to: Literal["rig", "camera", "simulator"]
    scope: Text
    parameters: dict[str, Amplitude]
    valid_range: dict[str, tuple[float, float]] = Field(default_factory=dict)
    rivals: tuple[Text, ...] = ()

    @model_validator(mode="after")
    def _in_the_catalogue(self) -> Self:
        there = [n for n, e in EFFECTS.items() if e.belongs_to != "specimen" and not e.timed]
        if self.effect not in there:
            raise say(
                "effect",
                f"expected one that beams can be corrected by, {', '.join(there)}, got {self.effect}",
            )
        effect = EFFECTS[self.effect]
        if effect.belongs_to != self.belongs_to:
            raise say("belongs_to", f"expected {effect.belongs_to} of {self.effect}, got {self.belongs_to}")
        if set(self.parameters) != {effect.parameter}:
            raise say("parameters", f"expected {effect.parameter} of {self.effect}, and no other")
        low, high = (effect.in_file(b) for b in effect.bounds)
        value = self.parameters[effect.parameter].value
        if not low - DIGITS * abs(low) <= value <= high + DIGITS * abs(high):
            raise say(
                f"parameters.{effect.parameter}.value", f"expected {low:.4g} to {high:.4g}, got {value:.4g}"
            )
        return self


class Covariance(Strict):
    """Covariance of the effects' parameters, in their order and units; `names` are for readers."""

    names: tuple[Text, ...]
    matrix: tuple[tuple[float, ...], ...]


class RigFile(Strict):
    """Content of rig.yaml for photographed beams.

    Attributes
    ----------
    experiment, experiment_sha256 : name and SHA-256 of the experiment that was diagnosed.
    base_law : law of the baseline.
    corrects : measurements that it corrects; older files lack it.
    use : purpose of the file, in a sentence.
    effects : effects that were found.
    covariance : covariance of their parameters.
    gain : held-out scores; None if there are none.
    """

    format: Literal[1]
    experiment: str
    experiment_sha256: Hash
    base_law: Text
    corrects: Literal["outlines"] = "outlines"
    use: Text
    effects: Annotated[tuple[RigEffect, ...], Field(min_length=1)]
    covariance: Covariance
    gain: dict[str, float | str | None] | None = None

    @model_validator(mode="before")
    @classmethod
    def _no_record(cls, data: Any) -> Any:
        """Reject records of other measurements before their effects are validated (some names are equal)."""
        if isinstance(data, dict) and data.get("corrects") == "nothing":
            raise say(
                "corrects",
                "expected outlines, got nothing: this was not found on photographed beams, and is a"
                " record that no command reads",
            )
        return data

    @model_validator(mode="after")
    def _covariance_of_the_effects(self) -> Self:
        n = len(self.effects)
        rows = self.covariance.matrix
        if len(rows) != n or any(len(row) != n for row in rows):
            raise say("covariance.matrix", f"expected {n} rows of {n} numbers, as there are effects")
        c = np.array(rows)
        sds = np.array([a.sd for e in self.effects for a in e.parameters.values()])
        if not np.allclose(c, c.T, rtol=1e-3) or not np.allclose(np.diag(c), sds**2, rtol=1e-2):
            raise say(
                "covariance.matrix", "expected it symmetric, with the squares of the sd on its diagonal"
            )
        scale = np.where(sds > 0.0, sds, 1.0)
        if np.linalg.eigvalsh(c / np.outer(scale, scale))[0] < -1e-4:
            raise say("covariance.matrix", "expected a covariance, which has no negative eigenvalue")
        return self
