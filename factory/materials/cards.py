"""Material cards: one YAML file per mixture, with parameters of the laws and effects found by a diagnosis.

A card holds the parameters of the neo-Hookean law, and of any other law of `tisim.laws` for which they are
known. Under a law that a card does not hold, its material has the card's small-strain moduli and the law's
other constants at their plain default (`Card.holds`).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from factory.bundled import shipped_folder
from factory.errors import InputError
from factory.materials.effects import BASE, CardEffect, Text, extended
from factory.materials.laws import LAWS as LAWS
from factory.materials.laws import Laws, Modulus
from factory.materials.parts import Fibres, Softening, Viscosity
from factory.strict_yaml import Strict, read_mapping, read_yaml
from tisim import Material, laws, material_from_moduli, parts


class Uncertainty(Strict):
    """Relative bounds of the shear modulus (-0.3 = 30 % lower; null: not known) and their source.

    `fit`, the covariance of all constants, is for `calibration.predict` alone.
    """

    shear_modulus_low: Annotated[float, Field(gt=-1, le=0)] | None
    shear_modulus_high: Annotated[float, Field(ge=0)] | None
    text: str
    fit: dict[str, Any] | None = None


class CardBaseline(Strict):
    """Material fitted to the same measurements without effects; moduli [Pa], error as `Card.model_error`."""

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
        Composition.
    derived : bool
        True if the numbers were inferred, not measured.
    provenance : str
        Source of the numbers.
    uncertainty : Uncertainty
        Relative bounds of the shear modulus.
    density : float
        Rest density [kg/m3].
    stiffness : float
        Code in the stiffness profiles, from 0 (softest) to below 1 (1 is rigid).
    laws : Laws
        Parameters law by law.
    fitted_to : dict, optional
        Experiment and kinds of measurement that it was fitted to, for `calibration.predict`.
    law : str, optional
        The law that was fitted, or fitted best; parameters of others follow from its moduli or from fits.
    model_error : float, optional
        Misfit beyond noise, as a relative error of the modulus.
    baseline : CardBaseline, optional
        The material without the effects.
    effects : tuple of CardEffect
        Effects in the specimen beyond the neo-Hookean law, found by a diagnosis (see `material_of`).
    viscosity, softening, fibres : parts of `tisim.parts`, optional
        Parts beside the law, the same for every law; with a Prony series, the moduli of all laws are those
        that its `modulus` names.
    """

    material: str
    mixture: str
    derived: bool
    provenance: str
    uncertainty: Uncertainty
    density: Annotated[float, Field(ge=10, le=30_000)]
    stiffness: Annotated[float, Field(ge=0, lt=1)]
    laws: Laws
    fitted_to: dict[str, Any] | None = None
    law: Text | None = None
    model_error: Annotated[float, Field(ge=0)] | None = None
    baseline: CardBaseline | None = None
    effects: tuple[CardEffect, ...] = ()
    viscosity: Viscosity = None
    softening: Softening = None
    fibres: Fibres = None

    def holds(self, law: str) -> bool:
        """True if the card has parameters of the law; if not, `for_law` uses its small-strain moduli."""
        return self.laws.of(law) is not None

    def for_law(self, law: str) -> Material:
        """The material of this card under a law of `tisim.laws`, without its effects."""
        return replace(self._in_law(law), **parts.of(self))  # type: ignore[arg-type]

    def _in_law(self, law: str) -> Material:
        parameters = self.laws.of(law)
        if parameters is None:
            base = self.laws.of(BASE)
            assert base is not None
            moduli = laws.get(BASE).moduli(base)
            try:
                return material_from_moduli(
                    law,
                    shear_modulus=moduli.shear_modulus,
                    bulk_modulus=moduli.bulk_modulus,
                    density=self.density,
                )
            except ValueError as error:  # limits of a user's own law
                raise InputError(f"law {law} does not take the moduli of {self.material}: {error}") from None
        return Material(law=law, parameters=parameters, density=self.density)


def material_of(card: Card, law: str | None = None) -> Material:
    """Material of a card with the effects that hold in any body, for any scene of tisim.

    Strain stiffening changes the law to "yeoh"; a creeping material has its modulus 1 s after loading.

    Parameters
    ----------
    card : Card
    law : str, optional
        Name of a law of `tisim.laws`; by default neo-Hookean, or the card's law if that is an effect
        (`CardEffect.is_law`).

    Raises
    ------
    InputError
        If the effects extend another law than `law`, or cannot be applied.
    """
    mine = [e.effect for e in card.effects if not e.left_out(card.material)]
    if law is None:
        law = card.law if card.law is not None and any(e.is_law for e in card.effects) else BASE
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
        Folder of the cards; default: those that come with the package.

    Raises
    ------
    InputError
        If there is no such card, or it is not valid.
    """
    path = card_path(name, folder)
    if folder is not None and not folder.is_dir():
        raise InputError(f"{folder}: expected a folder of material cards")
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
    """Path of a mixture's card."""
    return (folder or shipped_folder("materials")) / f"{name}.yaml"


def card_names(folder: Path) -> list[str]:
    """Names of the cards in a folder, sorted; YAML files without keys of a card (a rig's) are skipped.

    InputError if a file cannot be read: it may be a card.
    """
    return [
        path.stem
        for path in sorted(folder.glob("*.yaml"))
        if not {"material", "laws"}.isdisjoint(read_mapping(path))
    ]


def check_law(model: str) -> str:
    """Return `model` if tisim has a law of that name; InputError otherwise."""
    if model not in laws.all_names():
        raise InputError(f"--model {model}: expected one of {', '.join(laws.all_names())}")
    return model
