"""What can be wrong with a simulation: effects, how each acts in a kind of measurement, candidates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from tisim.parts import Part

Owner = Literal["specimen", "rig", "camera", "simulator"]


class Grouped(Protocol):
    """A record as candidates see it. groups: the label of the record at each level (material, specimen,
    trial, ...), as `EffectModel.scopes` names them."""

    @property
    def groups(self) -> Mapping[str, str]: ...


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A physical cause, as the catalogue describes it for all kinds of measurement.

    Attributes
    ----------
    name : as verdicts, files and reports write it.
    parameter : name of the amplitude in files; it ends with its unit.
    per_unit : file units in one SI unit.
    belongs_to : specimen, rig, camera or simulator. Only what belongs to a specimen may enter a dataset.
    sentence : the cause, for people.
    remedy : what to do about it on the bench.
    with_material : it goes with the material into any body (other effects of a specimen belong to its form).
    """

    name: str
    parameter: str
    per_unit: float
    belongs_to: Owner
    sentence: str
    remedy: str
    with_material: bool = False

    def in_file(self, amplitude: float) -> float:
        """The amplitude in the file's unit."""
        return amplitude * self.per_unit


@dataclass(frozen=True, eq=False, kw_only=True)
class Occurrence:
    """An effect as it was found in a material, for `EffectModel.hands_on`.

    Attributes
    ----------
    amplitude : [SI].
    variant : which of its forms.
    shear_modulus : of the material, as fitted beside it [Pa].
    records : that it was found in.
    """

    amplitude: float
    variant: float | None
    shear_modulus: float
    records: Sequence[Any]


@dataclass(frozen=True, kw_only=True)
class HandedOn:
    """What an effect is of a material: one of its parts (`tisim.parts`), or another law.

    Attributes
    ----------
    field : of `tisim.Material` (viscosity, softening, fibres, law).
    part : None where the effect makes none; `remarks` say why.
    law : small-strain shear and bulk moduli [Pa] to the name of a law and its parameters.
    modulus_ratio : the modulus that goes with the part over the modulus that was fitted beside the effect.
    states : which modulus that is, for people.
    remarks : what the measurement did not see, and what differs from the effect, a sentence each.
    shared : it is in the part of another effect.
    """

    field: Literal["viscosity", "softening", "fibres", "law"]
    part: Part | None = None
    law: Callable[[float, float], tuple[str, Mapping[str, float]]] | None = None
    modulus_ratio: float = 1.0
    states: str = ""
    remarks: tuple[str, ...] = ()
    shared: bool = False

    @property
    def made(self) -> bool:
        """True if the material has it."""
        return self.part is not None or self.law is not None


def everywhere(record: Any) -> bool:
    """`applies_to` of an effect that any record can have."""
    del record
    return True


def always(reached: Sequence[Any], everything: Sequence[Any]) -> bool:
    """`identifiable` of an effect that any protocol shows."""
    del reached, everything
    return True


def one_variant(records: Sequence[Any]) -> tuple[float | None, ...]:
    del records
    return (None,)


@dataclass(frozen=True, kw_only=True)
class EffectModel:
    """An effect in one kind of measurement, nested by one amplitude; zero means that it is absent.

    Each kind has a subclass with the hooks by which an amplitude enters its forward map.

    Attributes
    ----------
    effect : its entry in the catalogue.
    step : of a finite difference [SI].
    bounds : where the amplitude makes sense [SI].
    prior_scale : what a careful lab may still have overlooked [SI]. Where the data would need more than that
        to show the effect, they cannot see it.
    physical_limits : bounds where the physics itself ends (a surface that slides freely) [SI]: an amplitude
        may stop there.
    start_fraction : fraction of the way to its bounds that a fit may start at.
    scopes : levels of `Grouped.groups` in which it may sit besides all records, the wider first.
    in_all : whether all records may share it.
    positions : fractions of the specimen's length where it may sit.
    applies_to : whether a record can have it.
    identifiable : whether the records that a candidate reaches, among all, let its amplitude be seen at all;
        a candidate that no protocol shows has no column.
    variants : forms of the effect (a time constant, a direction), from the records that it applies to.
    variant_label : a variant in words.
    conclusive : whether the records that a candidate reaches, among all, can tell it from anything else that
        is smooth along them; where they cannot, it is named as part of an explanation only.
    switch : it is there or not: where it is named its amplitude is the upper bound.
    further : it is looked for only where no other cause explains the data: it is rarer than they are, or so
        free in its form that it would stand in for them.
    action : what to do about it with this kind of measurement, where that is not the catalogue's remedy.
    hands_on : the part of the material that it is, for extended cards; None for an effect that is none.
    """

    effect: Effect
    step: float
    bounds: tuple[float, float]
    prior_scale: float
    physical_limits: tuple[float, ...] = ()
    start_fraction: float = 0.6
    scopes: tuple[str, ...] = ("material", "specimen")
    in_all: bool = True
    positions: tuple[float | None, ...] = (None,)
    applies_to: Callable[[Any], bool] = everywhere
    identifiable: Callable[[Sequence[Any], Sequence[Any]], bool] = always
    variants: Callable[[Sequence[Any]], tuple[float | None, ...]] = one_variant
    variant_label: Callable[[float], str] = lambda variant: f"{variant:g}"
    conclusive: Callable[[Sequence[Any], Sequence[Any]], bool] = always
    switch: bool = False
    further: bool = False
    action: str = ""
    hands_on: Callable[[Occurrence], HandedOn] | None = None

    @property
    def name(self) -> str:
        return self.effect.name

    @property
    def parameter(self) -> str:
        return self.effect.parameter

    @property
    def per_unit(self) -> float:
        return self.effect.per_unit

    @property
    def belongs_to(self) -> Owner:
        return self.effect.belongs_to

    @property
    def sentence(self) -> str:
        return self.effect.sentence

    @property
    def remedy(self) -> str:
        return self.action or self.effect.remedy

    @property
    def simulated(self) -> bool:
        """True if its fit costs simulations."""
        return True

    def in_file(self, amplitude: float) -> float:
        """The amplitude in the file's unit."""
        return self.effect.in_file(amplitude)

    def acts_on(self, record: Any) -> bool:
        """True if a record can have it."""
        return self.applies_to(record)

    def labels(self, record: Grouped) -> tuple[str, ...]:
        """Scopes of a record in which it may be named."""
        return tuple(record.groups[level] for level in self.scopes)


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """An effect in all records, or in those of one material, specimen, trial or other group.

    Attributes
    ----------
    effect : its name.
    at : "all", or the label of a group of records.
    position : where in the specimen, as a fraction of its length; None for an effect without a position.
    alternatives : among how many of its sort this scope, position and variant was one choice.
    variant, variant_name : which form of the effect, as a number and in words; None and "" where it has one.
    """

    effect: str
    at: str = "all"
    position: float | None = None
    alternatives: int = 1
    variant: float | None = None
    variant_name: str = ""

    @property
    def label(self) -> str:
        where = "" if self.at == "all" else f" of {self.at}"
        which = f" ({self.variant_name})" if self.variant_name else ""
        return self.effect + where + which + ("" if self.position is None else f" at {self.position:.0%}")

    @property
    def form(self) -> tuple[str, float | None, float | None]:
        """What all scopes of it share: effect, position, variant."""
        return self.effect, self.position, self.variant


def candidates_of(records: Sequence[Grouped], effects: Mapping[str, EffectModel]) -> tuple[Candidate, ...]:
    """Each effect, at each position and in each variant, in all records that it applies to and in each group
    of its scopes, where these differ."""
    found: list[Candidate] = []
    for model in effects.values():
        touched = [r for r in records if model.acts_on(r)]
        if not touched:
            continue
        variants = model.variants(touched)
        scopes = _scopes(touched, model)
        for position in model.positions:
            for at, count in scopes:
                for variant in variants:
                    found.append(
                        Candidate(
                            effect=model.name,
                            at=at,
                            position=position,
                            alternatives=count * len(variants) * len(model.positions),
                            variant=variant,
                            variant_name="" if variant is None else model.variant_label(variant),
                        )
                    )
    return tuple(found)


def _scopes(touched: Sequence[Grouped], model: EffectModel) -> list[tuple[str, int]]:
    """Labels of the groups that it may sit in, and how many there are at their level. A group of the same
    records as one before adds nothing."""
    found: list[tuple[str, int]] = []
    known: list[tuple[int, ...]] = []
    if model.in_all:
        found.append(("all", 1))
        known.append(tuple(range(len(touched))))
    for level in model.scopes:
        labels = [r.groups[level] for r in touched]
        distinct = list(dict.fromkeys(labels))
        for label in distinct:
            members = tuple(k for k, own in enumerate(labels) if own == label)
            if members not in known:
                known.append(members)
                found.append((label, len(distinct)))
    return found


def reaches(candidate: Candidate, record: Any, model: EffectModel) -> bool:
    """True if a candidate is in a record."""
    return model.acts_on(record) and (candidate.at == "all" or candidate.at in model.labels(record))
