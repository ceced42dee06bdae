"""Material cards: one YAML file a mixture, with parameters for all six laws and what a diagnosis found."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from factory._extended import BASE, extended
from factory._yaml import Strict, read_yaml
from factory.errors import InputError
from factory.extension import CardEffect
from factory.recipe import ROOT
from tisim.scene import Material

LAWS = (
    "st-venant-kirchhoff",
    "neo-hookean",
    "stable-neo-hookean",
    "mooney-rivlin",
    "ogden",
    "arruda-boyce",
)
STORED_LAWS = (*LAWS, "yeoh", "eight-chain")  # that a dataset may be of: neo-Hookean is extended by the last

Modulus = Annotated[float, Field(gt=0, lt=1e12)]
Real = Annotated[float, Field(gt=-1e12, lt=1e12)]


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
    """The parameters of one mixture, law by law."""

    st_venant_kirchhoff: Annotated[Lame, Field(alias="st-venant-kirchhoff")]
    neo_hookean: Annotated[Lame, Field(alias="neo-hookean")]
    stable_neo_hookean: Annotated[Lame, Field(alias="stable-neo-hookean")]
    mooney_rivlin: Annotated[MooneyRivlin, Field(alias="mooney-rivlin")]
    ogden: Ogden
    arruda_boyce: Annotated[ArrudaBoyce, Field(alias="arruda-boyce")]


class Uncertainty(Strict):
    """Relative bounds of the shear modulus (-0.3 = 30 % lower; null: not known) and where they come from."""

    shear_modulus_low: Annotated[float, Field(gt=-1, le=0)] | None
    shear_modulus_high: Annotated[float, Field(ge=0)] | None
    text: str


class Card(Strict):
    """One mixture.

    mixture: what was mixed. derived: the numbers were inferred, not measured. density [kg/m3].
    stiffness: code in the stiffness profiles, from 0 (softest) to below 1 (1 = rigid).
    effects: what a diagnosis found in the specimen beside neo-Hookean (see `material_of`).
    """

    material: str
    mixture: str
    derived: bool
    provenance: str
    uncertainty: Uncertainty
    density: Modulus
    stiffness: Annotated[float, Field(ge=0, lt=1)]
    laws: Laws
    effects: tuple[CardEffect, ...] = ()

    def for_law(self, law: str) -> Material:
        """The material of this card under one of `LAWS`, without its effects."""
        parameters = getattr(self.laws, law.replace("-", "_")).model_dump()
        return Material(law=law, parameters=parameters, density=self.density)


def material_of(card: Card, law: str = BASE) -> Material:
    """The material of a card with the effects that go with it into any body, for any scene of tisim.

    Strain stiffening makes it one of the law "yeoh"; of a creeping one the modulus is that 1 s after loading.
    InputError where effects were found on another law than `law`, or make no material.
    """
    mine = [e.effect for e in card.effects if not e.left_out(card.material)]
    if mine and law != BASE:
        raise InputError(
            f"--model {law}: the card of {card.material} extends {BASE} by {', '.join(mine)}, which was found"
            f" on that law alone: give --model {BASE}, or delete key effects of the card to do without"
        )
    return extended(card.for_law(law), card.effects, card.material) if mine else card.for_law(law)


def load_card(name: str, folder: Path | None = None) -> Card:
    """The card of one mixture: FOLDER/NAME.yaml, by default from datasets/materials/."""
    path = card_path(name, folder)
    if not path.is_file():
        raise InputError(f"{path}: no material card for softness {name}")
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
    return (folder or ROOT / "materials") / f"{name}.yaml"


def check_law(model: str) -> str:
    """`model` itself where it names a law."""
    if model not in LAWS:
        raise InputError(f"--model {model}: expected one of {', '.join(LAWS)}")
    return model
