"""Material cards as models: a law and its parts, with the uncertainty that the card states.

`factory.materials` reads cards for datasets, in full; a prediction needs the law, the parts and how well they
are known.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import yaml
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from calibration.errors import InputError
from calibration.experiment._fields import KnownKeys
from calibration.experiment._yaml import sentence
from calibration.inference import WIDTH
from calibration.parameters import (
    Parametrisation,
    PartCoordinates,
    ProtocolWindow,
    held_part,
    parametrisation,
    part_coordinates,
    part_entry,
)
from calibration.parameters._coordinates import Coordinate, Parameters, shear_modulus
from tisim import laws
from tisim.parts import FIELDS, HolzapfelGasserOgden, OgdenRoxburgh, Part, Prony, decode

Array = NDArray[np.float64]

LOWEST = 0.99  # lowest end of a relative interval of a modulus, which is above 0
ROUNDED = 1e-4  # relative: cards have six digits
BASE = "neo-hookean"  # the law of cards that name none
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
# what a relative change of an effect's amplitude changes of its part, and whether it grows with it
SCALED: dict[type[Part], tuple[str, int]] = {
    Prony: ("fractions", 1),
    OgdenRoxburgh: ("r", -1),
    HolzapfelGasserOgden: ("k1", 1),
}


class _Lenient(BaseModel):
    model_config = ConfigDict(extra="ignore", allow_inf_nan=False)


class _Amplitude(_Lenient):
    value: float
    sd: NotNegative


class _Effect(_Lenient):
    effect: str
    parameters: Annotated[dict[str, _Amplitude], Field(min_length=1)]
    applies_to: Literal["material", "shape"] = "material"
    scope: str = "all"
    becomes: Literal["viscosity", "softening", "fibres", "law"] | None = None
    valid_range: dict[str, tuple[float, float]] = Field(default_factory=dict)


class FitFile(BaseModel):
    """A fit's point in its search coordinates, and their covariance (docs/reference/dataset-format.md)."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)

    terms: Annotated[int, Field(ge=1)] = 1
    parts: tuple[str, ...] = ()
    protocol: tuple[NotNegative, NotNegative, Annotated[int, Field(ge=0)]] = (0.0, 0.0, 0)
    coordinates: tuple[str, ...]
    values: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]


class _Uncertainty(_Lenient):
    shear_modulus_low: Annotated[float, Field(gt=-1, le=0)] | None = None
    shear_modulus_high: NotNegative | None = None
    fit: FitFile | None = None


# in the provenance of a card of before `fitted_to`
_FITTED_TO = re.compile(
    r"experiment (?P<quote>['\"])(?P<name>.*?)(?P=quote) \(sha256 (?P<digest>[0-9a-f]{16})\)"
)


class FittedTo(_Lenient):
    """Experiment that a card was fitted to, and kinds of measurement; all of it where none are stated.

    status, why : status and message of a fit that is no calibration (lack of fit, not converged).
    """

    experiment: str
    sha256: str
    kinds: tuple[str, ...] = ()
    status: str = ""
    why: str = ""


class _Baseline(_Lenient):
    law: str
    shear_modulus: Positive
    shear_modulus_sd: NotNegative
    bulk_modulus: Positive
    model_error: NotNegative = 0.0


class CardFile(KnownKeys):
    """A material card; keys that a prediction does not need are known, and not looked at."""

    material: str
    mixture: Any = None
    derived: Any = None
    provenance: Any = None
    fitted_to: FittedTo | None = None
    stiffness: Any = None
    uncertainty: _Uncertainty = Field(default_factory=_Uncertainty)
    density: Positive = 1000.0
    law: str | None = None
    laws: dict[str, dict[str, float | tuple[float, ...]]]
    model_error: NotNegative | None = None
    baseline: _Baseline | None = None
    effects: tuple[_Effect, ...] = ()
    viscosity: dict[str, Any] | None = None
    softening: dict[str, Any] | None = None
    fibres: dict[str, Any] | None = None

    @property
    def origin(self) -> FittedTo | None:
        """Experiment that the card was fitted to; for an earlier card from its provenance, None without."""
        found = _FITTED_TO.search(str(self.provenance or ""))
        if self.fitted_to is not None or found is None:
            return self.fitted_to
        return FittedTo(experiment=found["name"], sha256=found["digest"])

    def parts(self) -> dict[str, Part]:
        """Parts beside the law, by field. ValueError for one that is none."""
        return {
            field: decode(field, entry) for field in FIELDS if (entry := getattr(self, field)) is not None
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class CardModel:
    """A material as a card has it.

    Attributes
    ----------
    law : law in the search coordinates of the fit that the card states; else its shear modulus, and the
        relative size of each part whose sd is known.
    u : the card's point.
    covariance : covariance of u.
    model_error : relative, of the modulus.
    notes : sentences on what the card does not state.
    ranges : between what its effects were measured, by the quantity's name in files.
    """

    label: str
    law: Parametrisation
    u: Array
    covariance: Array
    model_error: float
    notes: tuple[str, ...] = ()
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)


def read_cards(path: Path) -> dict[str, CardFile]:
    """Cards of a folder (or one file) by material; YAML files that are no cards do not count.

    InputError, in one sentence, for a card that cannot be used, or where there is none.
    """
    if not path.exists():
        raise InputError(f"{path}: expected a folder of material cards, or a card")
    files = [path] if path.is_file() else sorted(path.glob("*.yaml"))
    found: dict[str, CardFile] = {}
    names: dict[str, str] = {}
    for file in files:
        try:
            content = yaml.safe_load(file.read_text(encoding="utf-8"))
        except (yaml.YAMLError, UnicodeDecodeError) as error:
            raise InputError(f"{file}: expected YAML: {' '.join(str(error).split())}") from None
        if not (isinstance(content, dict) and {"material", "laws"} <= set(content)):
            continue
        try:
            card = CardFile.model_validate(content)
        except ValidationError as error:
            raise InputError(f"{file}: {sentence(error, content)}") from None
        if card.material in found:
            raise InputError(
                f"{path}: expected one card of {card.material}, got {names[card.material]} and {file.name}"
            )
        found[card.material], names[card.material] = card, file.name
        try:
            extended_model(card)
        except ValueError as error:
            raise InputError(f"{file}: {' '.join(str(error).split())}") from None
    if not found:
        raise InputError(f"{path}: expected a material card (keys material and laws)")
    return found


def extended_model(card: CardFile) -> CardModel:
    """The card's material with its parts. ValueError for a law or a part that is none."""
    name = card.law or BASE
    if name not in card.laws:
        raise ValueError(f"key law: expected one of {', '.join(card.laws)}, got {name}")
    parameters: Parameters = dict(card.laws[name])
    laws.get(name).check(parameters)
    notes = []
    if card.fitted_to is not None and card.fitted_to.status:
        why = f" ({card.fitted_to.why})" if card.fitted_to.why else ""
        notes.append(
            f"the card of {card.material} is of a fit that is no calibration, {card.fitted_to.status}{why}:"
            " what its law lacks is in no interval"
        )
    high = card.uncertainty.shear_modulus_high
    if high is None:
        notes.append(f"the card of {card.material} does not state how well its modulus is known")
    if card.model_error is None:
        notes.append(f"the card of {card.material} states no model error")
    left_out = [e.effect for e in card.effects if not e.becomes]
    if left_out:
        notes.append(
            f"not predicted with, since the card of {card.material} has no part for it: {', '.join(left_out)}"
        )
    parts = card.parts()
    if card.uncertainty.fit is not None:
        law, u, covariance = _as_fitted(name, parameters, parts, card.uncertainty.fit)
    else:
        # of the logarithm, for an interval of the logarithm and for one of the modulus
        low = card.uncertainty.shear_modulus_low if high is not None else 0.0
        low = -(high or 0.0) if low is None else low
        sds = [(np.log1p(high or 0.0) - np.log1p(max(low, -LOWEST))) / (2.0 * WIDTH)]
        law = scaled_law(name, parameters)
        own = []
        for field_, part in parts.items():
            known = _relative_sd(card, field_)
            own.append(scaled_part(field_, part, free=known is not None))
            sds += [] if known is None else [known]
            if known is None:
                notes.append(f"the card of {card.material} does not state how well its {field_} is known")
        law = law.with_parts(own) if own else law
        u = np.array([np.log(laws.get(name).moduli(parameters).shear_modulus), *np.zeros(len(sds) - 1)])
        covariance = np.diag(np.square(sds))
    labels = [e.effect for e in card.effects if e.becomes]
    ranges: dict[str, tuple[float, float]] = {}
    for e in card.effects:
        for quantity, (low, high) in e.valid_range.items() if e.becomes else ():
            known_low, known_high = ranges.get(quantity, (low, high))
            ranges[quantity] = min(low, known_low), max(high, known_high)
    return CardModel(
        label=" + ".join(labels) or law.label.replace("+", " + "),
        law=law,
        u=u,
        covariance=covariance,
        model_error=card.model_error or 0.0,
        notes=tuple(notes),
        ranges=ranges,
    )


def _as_fitted(
    name: str, parameters: Parameters, parts: Mapping[str, Part], fit: FitFile
) -> tuple[Parametrisation, Array, Array]:
    """Law with parts in the coordinates of the fit, its point and their covariance.

    ValueError where these do not describe the constants that the card states.
    """
    first, last, peaks = fit.protocol
    window = ProtocolWindow(first=first, last=last, peaks=peaks)
    searched = [part_coordinates(spec, window) for spec in fit.parts]
    held = [
        held_part(f, part, window) for f, part in parts.items() if f not in {own.field for own in searched}
    ]
    law = parametrisation(name, terms=fit.terms)
    law = law.with_parts([*searched, *held]) if searched or held else law
    if fit.coordinates != law.names or len(fit.values) != len(law.names):
        raise ValueError(f"key uncertainty.fit.coordinates: expected {', '.join(law.names)}")
    u, covariance = np.array(fit.values), np.array(fit.covariance)
    n = len(u)
    if covariance.shape != (n, n) or np.linalg.eigvalsh(covariance).min() < -ROUNDED * covariance.max():
        raise ValueError(f"key uncertainty.fit.covariance: expected a covariance of shape ({n}, {n})")
    found = law.material(u)
    stated: list[tuple[Mapping[str, Any], Mapping[str, Any]]] = [(found.parameters, parameters)]
    for part in law.parts:
        own = parts.get(part.field)
        stated.append((part_entry(getattr(found, part.field)), {} if own is None else part_entry(own)))
    if not all(_alike(fitted[key], known.get(key)) for fitted, known in stated for key in fitted):
        raise ValueError(
            f"key uncertainty.fit: expected the constants of {name} and its parts as the card states them:"
            " leave the key out where they were changed"
        )
    return law, u, covariance


def _alike(a: Any, b: Any) -> bool:
    return a == b if isinstance(a, str) or b is None else bool(np.allclose(a, b, rtol=ROUNDED, atol=0.0))


def baseline_model(card: CardFile) -> CardModel | None:
    """The material without what a diagnosis found; None for a card that does not state it."""
    b = card.baseline
    if b is None:
        return None
    return CardModel(
        label="baseline",
        law=scaled_law(b.law, laws.get(b.law).from_moduli(b.shear_modulus, b.bulk_modulus)),
        u=np.array([np.log(b.shear_modulus)]),
        covariance=np.array([[(b.shear_modulus_sd / b.shear_modulus) ** 2]]),
        model_error=b.model_error,
    )


def scaled_law(name: str, parameters: Parameters) -> Parametrisation:
    """A law whose moduli are one multiple of those given; what has no unit (an exponent) stays."""
    reference = laws.get(name).moduli(parameters).shear_modulus

    def assemble(v: dict[str, float]) -> Parameters:
        return laws.scaled(name, parameters, v["shear_modulus"] / reference)

    return Parametrisation(law=name, label=name, coordinates=(shear_modulus(),), assemble=assemble)


def scaled_part(field: str, part: Part, *, free: bool) -> PartCoordinates:
    """A part as it is; free : with its relative size as a coordinate."""
    name = f"{field}_scale"
    scaled = SCALED.get(type(part)) if free else None
    coordinate = Coordinate(name=name, unit="-", log=True, low=0.05, high=20.0, spread=0.1, start=1.0)

    def assemble(values: dict[str, float]) -> Part:
        if scaled is None:
            return part
        key, power = scaled
        known, factor = getattr(part, key), values[name] ** power
        value: Any = tuple(x * factor for x in known) if isinstance(known, tuple) else known * factor
        if key == "r":
            value = max(float(value), 1.0)
        return replace(part, **{key: value})

    return PartCoordinates(
        spec=part.name,
        label=part.name,
        field=field,
        window=ProtocolWindow(first=0.0, last=0.0, peaks=0),
        coordinates=(coordinate,) if free else (),
        assemble=assemble,
        describe=lambda *_: [],
    )


def _relative_sd(card: CardFile, field: str) -> float | None:
    """Relative standard deviation of a part's size, from the effect that it represents."""
    for e in card.effects:
        if e.becomes == field:
            amplitude = next(iter(e.parameters.values()))
            return abs(amplitude.sd / amplitude.value) if amplitude.value else None
    return None
