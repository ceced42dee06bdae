"""Material cards: one YAML file a mixture, with parameters for every law and what a diagnosis found.

A card holds the parameters of the paper's six laws, and of any other law that is registered in
`tisim.laws` where they are known. Under a law that a card does not hold, its material has the card's
small-strain moduli and the law's other constants at their plain default (`Card.holds`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, field_validator, model_validator

from factory._input import InputError, Strict, read_mapping, read_yaml, shipped_folder
from factory._parts import Fibres, Softening, Viscosity
from factory._parts import part_entry as part_entry
from tisim import Material, Moduli, laws, material_from_moduli

BASE = "neo-hookean"  # the law that effects extend

Modulus = Annotated[float, Field(gt=0, lt=1e12)]
Real = Annotated[float, Field(gt=-1e12, lt=1e12)]
Text = Annotated[str, Field(min_length=1, max_length=200)]


class Lame(Strict):
    """Lame parameters [Pa]: shear modulus mu, bulk modulus lam + 2 mu / 3."""

    mu: Modulus
    lam: Modulus


class MooneyRivlin(Strict):
    """c10, c01, bulk [Pa]: shear modulus 2 (c10 + c01). One of the two may be negative: calibrations on
    moderate strains find that at times."""

    c10: Real
    c01: Real
    bulk: Modulus

    @model_validator(mode="after")
    def _stiff(self) -> Self:
        if self.c10 + self.c01 <= 0:
            raise ValueError("c10 + c01: expected a positive sum")
        return self


class Ogden(Strict):
    """mu [Pa] and alpha [-], one value a term; bulk [Pa]: shear modulus sum mu alpha / 2."""

    mu: Annotated[tuple[float, ...], Field(min_length=1)]
    alpha: Annotated[tuple[float, ...], Field(min_length=1)]
    bulk: Modulus

    @model_validator(mode="after")
    def _paired(self) -> Self:
        if len(self.mu) != len(self.alpha):
            raise ValueError(f"expected as many mu as alpha, got {len(self.mu)} and {len(self.alpha)}")
        if any(m * a <= 0 for m, a in zip(self.mu, self.alpha, strict=True)):
            raise ValueError("expected mu and alpha of one sign in each term, and not 0")
        return self


class ArrudaBoyce(Strict):
    """mu [Pa], locking stretch [-], bulk [Pa]."""

    mu: Modulus
    locking: Annotated[float, Field(gt=1, lt=1e3)]
    bulk: Modulus


class Laws(Strict):
    """The parameters of one mixture, law by law: the paper's six, and others that tisim knows."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, dict[str, float | tuple[float, ...]]]

    st_venant_kirchhoff: Annotated[Lame, Field(alias="st-venant-kirchhoff")]
    neo_hookean: Annotated[Lame, Field(alias="neo-hookean")]
    stable_neo_hookean: Annotated[Lame, Field(alias="stable-neo-hookean")]
    mooney_rivlin: Annotated[MooneyRivlin, Field(alias="mooney-rivlin")]
    ogden: Ogden
    arruda_boyce: Annotated[ArrudaBoyce, Field(alias="arruda-boyce")]

    @model_validator(mode="after")
    def _known(self) -> Self:
        for name, parameters in (self.__pydantic_extra__ or {}).items():
            try:
                laws.get(name).check(parameters)
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        return self

    def of(self, law: str) -> dict[str, float | tuple[float, ...]] | None:
        """Parameters under one law; None where the card does not hold them."""
        found = self.model_dump(by_alias=True).get(law)
        return None if found is None else dict(found)


LAWS = tuple(field.alias or name for name, field in Laws.model_fields.items())  # that every card holds


class Uncertainty(Strict):
    """Relative bounds of the shear modulus (-0.3 = 30 % lower; null: not known) and where they come from."""

    shear_modulus_low: Annotated[float, Field(gt=-1, le=0)] | None
    shear_modulus_high: Annotated[float, Field(ge=0)] | None
    text: str


# effects that a dataset takes over: the parameter that is read, and what becomes of it
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

    Attributes
    ----------
    effect : str
        Name in the catalogue of effects.
    belongs_to : str
        "specimen"; what belongs to a rig, a camera or a simulator is refused.
    applies_to : {"material", "shape"}
        "material" goes with the material into any body, "shape" belongs to the form of the measured body.
    scope : str
        "all", or the material, specimen or trial that it was found in.
    base_law : str
        The law that it extends.
    parameters : dict of str to Amplitude
        By names that end with their unit.
    valid_range : dict of str to (float, float)
        Range of what was measured, by names that end with their unit.
    rivals : tuple of str
        Effects, or sums of effects, that explain the data equally well.
    correlations : dict of str to float
        Correlation of its first parameter with others of the same fit.
    gain : dict, optional
        Improvement on held-out data.
    becomes : {"viscosity", "softening", "fibres"}, optional
        Part of the card that it is: that part is taken over, not the amplitude.
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
    becomes: Literal["viscosity", "softening", "fibres"] | None = None
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
        if self.becomes is not None:
            return f"the card's {self.becomes} has it"
        return "" if self.effect in TAKEN else "no law of the static simulator has it"

    def describe(self) -> str:
        """Its amplitude and its equivalent explanations in a few words."""
        amounts = ", ".join(f"{n} {a.value:.4g} +- {a.sd:.2g}" for n, a in self.parameters.items())
        rivals = f"; not told from {' or '.join(self.rivals)}" if self.rivals else ""
        return f"{self.effect} ({amounts}{rivals})"


class CardBaseline(Strict):
    """A material without its effects, as fitted to the same measurements [Pa]; see `Card.model_error`."""

    law: Text
    shear_modulus: Modulus
    shear_modulus_sd: Annotated[float, Field(ge=0)]
    bulk_modulus: Modulus
    model_error: Annotated[float, Field(ge=0)]


class Card(Strict):
    """One mixture.

    Attributes
    ----------
    material : str
        Name of the mixture and of the card's file.
    mixture : str
        What was mixed.
    derived : bool
        The numbers were inferred, not measured.
    provenance : str
        Where the numbers come from.
    uncertainty : Uncertainty
        Relative bounds of the shear modulus.
    density : float
        Rest density [kg/m3].
    stiffness : float
        Code in the stiffness profiles, from 0 (softest) to below 1 (1 is rigid).
    laws : Laws
        Parameters law by law.
    law : str, optional
        The law that was fitted, or fitted best; others are filled in from its moduli, or fitted too.
    model_error : float, optional
        What the fit leaves beyond noise, as a relative error of the modulus.
    baseline : CardBaseline, optional
        The material without the effects.
    effects : tuple of CardEffect
        What a diagnosis found in the specimen beyond the neo-Hookean law (see `material_of`).
    viscosity, softening, fibres : parts of `tisim.parts`, optional
        What the material has beside its law, whichever that is; of a Prony series, the moduli of all laws are
        those that its `modulus` names.
    """

    material: str
    mixture: str
    derived: bool
    provenance: str
    uncertainty: Uncertainty
    density: Modulus
    stiffness: Annotated[float, Field(ge=0, lt=1)]
    laws: Laws
    law: Text | None = None
    model_error: Annotated[float, Field(ge=0)] | None = None
    baseline: CardBaseline | None = None
    effects: tuple[CardEffect, ...] = ()
    viscosity: Viscosity = None
    softening: Softening = None
    fibres: Fibres = None

    def holds(self, law: str) -> bool:
        """The card has parameters of that law; else `for_law` takes its small-strain moduli."""
        return self.laws.of(law) is not None

    def for_law(self, law: str) -> Material:
        """The material of this card under a law of `tisim.laws`, without its effects."""
        beside = {"viscosity": self.viscosity, "softening": self.softening, "fibres": self.fibres}
        return replace(self._in_law(law), **beside)  # type: ignore[arg-type]

    def _in_law(self, law: str) -> Material:
        parameters = self.laws.of(law)
        if parameters is None:
            base = self.laws.of(BASE)
            assert base is not None
            moduli = laws.get(BASE).moduli(base)
            return material_from_moduli(
                law,
                shear_modulus=moduli.shear_modulus,
                bulk_modulus=moduli.bulk_modulus,
                density=self.density,
            )
        return Material(law=law, parameters=parameters, density=self.density)


def material_of(card: Card, law: str = BASE) -> Material:
    """The material of a card with the effects that go with it into any body, for any scene of tisim.

    Strain stiffening makes it one of the law "yeoh"; a creeping one has its modulus 1 s after loading.

    Parameters
    ----------
    card : Card
    law : str
        Name of a law of `tisim.laws`.

    Raises
    ------
    InputError
        Where effects were found on another law than `law`, or make no material.
    """
    mine = [e.effect for e in card.effects if not e.left_out(card.material)]
    if mine and law != BASE:
        raise InputError(
            f"--model {law}: the card of {card.material} extends {BASE} by {', '.join(mine)}, which was found"
            f" on that law alone: give --model {BASE}, or delete key effects of the card to do without"
        )
    return extended(card.for_law(law), card.effects, card.material) if mine else card.for_law(law)


def load_card(name: str, folder: Path | None = None) -> Card:
    """The card of one mixture.

    Parameters
    ----------
    name : str
        Name of the mixture: the card is FOLDER/NAME.yaml.
    folder : Path, optional
        Where cards are looked for; default: those that come with the package.

    Raises
    ------
    InputError
        Where there is no such card, or it holds something else than a card should.
    """
    path = card_path(name, folder)
    if not path.is_file():
        raise InputError(f"{path}: no material card for material level {name}")
    card = read_yaml(path, Card)
    if card.material != name:
        raise InputError(f"{path}: key material: expected {name}, as the file is called, got {card.material}")
    try:
        material_of(card)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return card


def card_path(name: str, folder: Path | None = None) -> Path:
    """Where the card of a mixture is looked for."""
    return (folder or shipped_folder("materials")) / f"{name}.yaml"


def card_names(folder: Path) -> list[str]:
    """Names of the cards in a folder, sorted; YAML files that are no cards (a rig's) do not count."""
    names = []
    for path in sorted(folder.glob("*.yaml")):
        try:
            content: dict[Any, Any] = read_mapping(path)
        except InputError:
            continue
        if "material" in content and "laws" in content:
            names.append(path.stem)
    return names


def check_law(model: str) -> str:
    """`model` itself where tisim has a law of that name; InputError otherwise."""
    if model not in laws.all_names():
        raise InputError(f"--model {model}: expected one of {', '.join(laws.all_names())}")
    return model


def extended(material: Material, effects: Sequence[CardEffect], name: str) -> Material:
    """A neo-Hookean material with those of its effects that go with it into any body; name: the mixture's.

    InputError names the key where there is no such material.
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
    law = laws.get(material.law)
    moduli = law.moduli(material.parameters)
    if effect == "density":
        if not value > -1.0:
            raise ValueError(f"expected a value above -1, got {value:g}")
        return replace(material, density=material.density * (1.0 + value))
    if effect == "compressibility":
        # what the law has without a unit, a stiffening or a locking stretch, stays
        scaled = law.from_moduli(moduli.shear_modulus, _bulk(moduli, value))
        own = {n: material.parameters[n] for n in law.parameters if n not in ("lam", "bulk")}
        return replace(material, parameters={**scaled, **own})
    if effect == "creep":
        return material
    if material.law != BASE:
        raise ValueError(f"asks for another law than {material.law}, which another effect asks for: keep one")
    stiffer = _in_law(material, effect, value)
    return replace(material, law=stiffer.law, parameters=stiffer.parameters)


def _bulk(moduli: Moduli, drop: float) -> float:
    """Bulk modulus [Pa] with Poisson's ratio lower by `drop`."""
    g, k = moduli.shear_modulus, moduli.bulk_modulus
    nu = (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g) - drop
    if not -1.0 < nu < 0.5:
        raise ValueError(f"leaves a Poisson ratio of {nu:.3g}, expected one between -1 and 0.5")
    return 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))


def _in_law(material: Material, effect: str, value: float) -> Material:
    """A neo-Hookean material with a constant more, at the same small-strain moduli."""
    moduli = laws.get(material.law).moduli(material.parameters)
    g, k = moduli.shear_modulus, moduli.bulk_modulus
    if effect == "strain-stiffening":
        return Material(law="yeoh", parameters={"mu": g, "stiffening": value, "bulk": k})
    if effect == "second-invariant":
        constants = {"c10": 0.5 * g * (1.0 - value), "c01": 0.5 * g * value}
        return Material(law="mooney-rivlin", parameters={**constants, "bulk": k})
    if not 0.0 < value < 1.0:
        raise ValueError(f"expected a value between 0 and 1, got {value:g}")
    return Material(law="eight-chain", parameters={"mu": g, "locking": value**-0.5, "bulk": k})


def in_one_law(materials: Mapping[str, Material]) -> dict[str, Material]:
    """All in one law, since a dataset has one set of parameters: those that stayed neo-Hookean beside one
    that stiffens get its law, with no stiffening. InputError where several laws cannot be one."""
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
