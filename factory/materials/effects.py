"""Effects that a diagnosis found in a specimen: their entries in a material card, and their material."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field, field_validator

from factory.errors import InputError
from factory.strict_yaml import Strict
from tisim import Material, laws, material_from_moduli

BASE = "neo-hookean"  # the law that effects extend
# effects that extend the base law by one constant, and the law that has it
EXTENSIONS: dict[str, laws.Extension] = {
    "strain-stiffening": "yeoh",
    "second-invariant": "mooney-rivlin",
    "limited-extensibility": "eight-chain",
}
Text = Annotated[str, Field(min_length=1, max_length=200)]

# effects that a dataset applies: the parameter that is read, and the property that it changes
TAKEN = {
    "compressibility": ("poisson_drop", "as the bulk modulus"),
    "creep": ("per_decade", "as the modulus at 1 s, which is the card's"),
    "density": ("excess", "as the density"),
    "strain-stiffening": ("c2_over_c1", "as the law yeoh"),
    "second-invariant": ("c01_share", "as the law mooney-rivlin"),
    "limited-extensibility": ("one_over_locking_stretch_squared", "as the law eight-chain"),
}


class Amplitude(Strict):
    """Value and standard deviation of an effect's parameter, in the unit that ends the parameter's name."""

    value: float
    sd: Annotated[float, Field(ge=0)]


class CardEffect(Strict):
    """One effect of the specimen, as `calibration.diagnose` writes it.

    Attributes
    ----------
    effect : str
        Name in the catalogue of effects.
    belongs_to : str
        "specimen"; effects of a rig, a camera or a simulator are refused.
    applies_to : {"material", "shape"}
        "material": property of the material in any body; "shape": property of the measured body's geometry.
    scope : str
        "all", or the material, specimen or trial that it was found in.
    base_law : str
        The law that it extends.
    parameters : dict of str to Amplitude
        Parameters by name; each name ends with the unit.
    valid_range : dict of str to (float, float)
        Range of each measured quantity by name; each name ends with the unit.
    rivals : tuple of str
        Effects, or sums of effects, that explain the data equally well.
    correlations : dict of str to float
        Correlation of its first parameter with others of the same fit.
    gain : dict, optional
        Improvement on held-out data.
    becomes : {"viscosity", "softening", "fibres", "law"}, optional
        Entry of the card that represents the effect. A part (all but "law") replaces the amplitude.
    experiment_sha256 : str
        Digest of the experiment that it was found in.
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
    becomes: Literal["viscosity", "softening", "fibres", "law"] | None = None
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

    @property
    def is_law(self) -> bool:
        """True if the card's law has the effect, rather than an extension of the base law by a constant."""
        return self.becomes == "law" and self.effect not in TAKEN

    def left_out(self, material: str) -> str:
        """Reason why a dataset of this material ignores the effect; empty if it applies it."""
        if self.applies_to == "shape":
            return "belongs to the beam's form"
        if self.scope not in ("all", material):
            return f"found in {self.scope} alone, not in all of the material"
        if self.becomes not in (None, "law") or self.is_law:
            return f"the card's {self.becomes} has it"
        return "" if self.effect in TAKEN else "no law of the static simulator has it"

    def describe(self) -> str:
        """Short text of the effect: parameters and equivalent explanations."""
        amounts = ", ".join(f"{n} {a.value:.4g} +- {a.sd:.2g}" for n, a in self.parameters.items())
        rivals = f"; equivalent to {' or '.join(self.rivals)}" if self.rivals else ""
        return f"{self.effect} ({amounts}{rivals})"


def extended(material: Material, effects: Sequence[CardEffect], name: str) -> Material:
    """Apply to a neo-Hookean material the effects that hold in any body; `name` is that of the mixture.

    InputError, with the card's key, if an effect cannot be applied.
    """
    for number, effect in enumerate(effects):
        if effect.left_out(name):
            continue
        key, parameter = f"key effects.{number}", TAKEN[effect.effect][0]
        if effect.base_law != BASE:
            raise InputError(f"{key}.base_law: expected {BASE}, got {effect.base_law}")
        if set(effect.parameters) != {parameter}:
            raise InputError(f"{key}.parameters: expected {parameter} of {effect.effect}, and no other")
        try:
            material = _with(material, effect.effect, effect.parameters[parameter].value)
            laws.get(material.law).check(material.parameters)
        except ValueError as error:
            raise InputError(f"{key}.parameters.{parameter}.value: {effect.effect}: {error}") from None
    return material


def _with(material: Material, effect: str, value: float) -> Material:
    moduli = laws.get(material.law).moduli(material.parameters)
    if effect == "density":
        if not value > -1.0:
            raise ValueError(f"expected a value above -1, got {value:g}")
        return replace(material, density=material.density * (1.0 + value))
    if effect == "compressibility":
        found = moduli.with_poisson_ratio(moduli.poisson_ratio - value)
        # the other parameters, e.g. a stiffening or a locking stretch, are kept
        return replace(
            material, parameters=laws.with_moduli(material.law, material.parameters, **vars(found))
        )
    if effect == "creep":
        return material
    if material.law != BASE:
        raise ValueError(f"asks for another law than {material.law}, which another effect asks for: keep one")
    law = EXTENSIONS[effect]
    return replace(material, law=law, parameters=laws.extension(law, value, **vars(moduli)))


def in_one_law(materials: Mapping[str, Material]) -> dict[str, Material]:
    """Express all materials in one law, since a dataset has one set of parameters.

    Neo-Hookean materials beside a Yeoh material become Yeoh without stiffening. InputError for other pairs.
    """
    asked = {m.law: name for name, m in materials.items()}
    if len(asked) == 1:
        return dict(materials)
    if set(asked) != {BASE, "yeoh"}:
        (law, name), (other, second), *_ = asked.items()
        raise InputError(
            f"material level {name} asks for the law {law} and {second} for {other}, which one dataset cannot"
            " hold: build them apart, or delete key effects of a card to leave its extension out"
        )
    found = {}
    for name, m in materials.items():
        moduli = laws.get(m.law).moduli(m.parameters)
        plain = material_from_moduli(
            "yeoh", shear_modulus=moduli.shear_modulus, bulk_modulus=moduli.bulk_modulus
        )
        found[name] = replace(m, law=plain.law, parameters=plain.parameters) if m.law == BASE else m
    return found
