"""Effects that a diagnosis found, as a material card carries them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, field_validator

from factory._yaml import Strict

Text = Annotated[str, Field(min_length=1, max_length=200)]

# what `factory._extended` knows how to make of a law: the parameter it reads, and what becomes of it
TAKEN = {
    "compressibility": ("poisson_drop", "as the bulk modulus"),
    "creep": ("per_decade", "as the modulus at 1 s, which is the card's"),
    "density": ("excess", "as the density"),
    "strain-stiffening": ("c2_over_c1", "as the law yeoh"),
    "second-invariant": ("c01_share", "as the law mooney-rivlin"),
    "limited-extensibility": ("one_over_locking_stretch_squared", "as the law eight-chain"),
}


class Amplitude(Strict):
    """An effect's parameter, in the unit that its name ends with, and its standard deviation."""

    value: float
    sd: Annotated[float, Field(ge=0)]


class CardEffect(Strict):
    """One effect of the specimen, as `calibration.diagnose` writes it.

    applies_to: "material" goes with the material into any body, "shape" belongs to the form of the body that
    was measured. scope: "all", or the material, specimen or trial that it was found in.
    base_law: the law that it extends. valid_range: of what was measured, by a name that ends with its unit.
    rivals: effects, or sums of some, that the data could not tell it from. correlations: of its first
    parameter with others of the same fit. gain: on data that the fit had not seen.
    """

    effect: Text
    belongs_to: str
    applies_to: Literal["material", "shape"]
    scope: Text
    base_law: Text
    parameters: Annotated[dict[str, Amplitude], Field(min_length=1)]
    valid_range: dict[str, tuple[float, float]] = Field(default_factory=dict)
    rivals: tuple[Text, ...] = ()
    correlations: dict[str, float] = Field(default_factory=dict)
    gain: dict[str, float | str | None] | None = None
    experiment_sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]

    @field_validator("belongs_to")
    @classmethod
    def _of_the_specimen(cls, value: str) -> str:
        if value != "specimen":
            raise ValueError(
                "expected specimen, since what belongs to a rig, a camera or a simulator corrects a"
                " calibration (calibration.fit --rig) and must not enter a dataset"
            )
        return value

    def left_out(self, material: str) -> str:
        """Why a dataset of this material does not take it over, "" where it does."""
        if self.applies_to == "shape":
            return "belongs to the beam's form"
        if self.scope not in ("all", material):
            return f"found in {self.scope} alone, not in all of the material"
        return "" if self.effect in TAKEN else "no law of the static simulator has it"

    def says(self) -> str:
        """Its amplitude and its rivals in a few words."""
        amounts = ", ".join(f"{n} {a.value:.4g} +- {a.sd:.2g}" for n, a in self.parameters.items())
        rivals = f"; not told from {' or '.join(self.rivals)}" if self.rivals else ""
        return f"{self.effect} ({amounts}{rivals})"
