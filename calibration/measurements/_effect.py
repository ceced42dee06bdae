"""Effects that a simulation can lack, their models in a kind of measurement, and candidates for diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Literal, Protocol, TypeVar, get_type_hints

from tisim.parts import Part

S = TypeVar("S")

Owner = Literal["specimen", "rig", "camera", "simulator"]


class Grouped(Protocol):
    """A record with the labels that scope candidates.

    groups : label of the record at each level (material, specimen, trial, ...) of `EffectModel.scopes`.
    """

    @property
    def groups(self) -> Mapping[str, str]: ...


@dataclass(frozen=True, kw_only=True)
class Effect:
    """A physical cause of misfit, as the catalogue describes it for all kinds of measurement.

    Attributes
    ----------
    name : name in verdicts, files and reports.
    parameter : name of the amplitude in files; it ends with its unit.
    per_unit : number of file units per SI unit.
    belongs_to : specimen, rig, camera or simulator. Only effects of a specimen may enter a dataset.
    sentence : description of the cause.
    remedy : action in the lab that removes it.
    with_material : True if it is a property of the material, for any body; other effects of a specimen belong
        to its shape.
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
    """An effect found in a material, argument of `EffectModel.hands_on`.

    Attributes
    ----------
    amplitude : fitted amplitude [SI].
    variant : variant of the effect; None if it has one only.
    shear_modulus : shear modulus of the material, fitted together with the effect [Pa].
    records : records in which it was found.
    """

    amplitude: float
    variant: float | None
    shear_modulus: float
    records: Sequence[Any]


@dataclass(frozen=True, kw_only=True)
class HandedOn:
    """An effect as a constitutive part of a material (`tisim.parts`), or as another law.

    Attributes
    ----------
    field : field of `tisim.Material` (viscosity, softening, fibres, law).
    part : the part; None if the effect defines none (`remarks` state why).
    law : function from the small-strain shear and bulk moduli [Pa] to the name of a law and its parameters.
    modulus_ratio : modulus that belongs to the part, relative to the modulus fitted with the effect.
    states : name of that modulus, for reports.
    remarks : sentences on the limits of the measurement and on differences from the effect.
    shared : True if the part of another effect includes it.
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
        """True if it defines a part or a law."""
        return self.part is not None or self.law is not None


def everywhere(record: Any) -> bool:
    """`applies_to` of an effect that every record can have."""
    del record
    return True


def always(reached: Sequence[Any], everything: Sequence[Any]) -> bool:
    """`identifiable` of an effect that every protocol identifies."""
    del reached, everything
    return True


def one_variant(records: Sequence[Any]) -> tuple[float | None, ...]:
    del records
    return (None,)


def added_to(described: type[S], path: str) -> Callable[[S, float, Any], S]:
    """Change by an effect that adds its amplitude to one number; the number's name is checked at once.

    Parameters
    ----------
    described : dataclass of what the effect changes (a scene, the parameters of a beam).
    path : name of its field; "imperfections.taper" for a field of a field.

    Returns
    -------
    callable
        Function of (instance, amplitude, anything) to the changed instance.

    Raises
    ------
    ValueError
        If there is no such field, or it is no number.
    """
    names = path.split(".")
    kind: Any = described
    for name in names:
        if not is_dataclass(kind) or name not in {f.name for f in fields(kind)}:
            raise ValueError(f"{described.__name__}: no field {path}")
        kind = get_type_hints(kind)[name]
    if kind is not float:
        raise ValueError(f"{described.__name__}: expected a number in {path}")
    return lambda x, amplitude, _: _added(x, names, amplitude)


def _added(x: Any, names: Sequence[str], amplitude: float) -> Any:
    first, *rest = names
    own = getattr(x, first)
    return replace(x, **{first: _added(own, rest, amplitude) if rest else own + amplitude})


@dataclass(frozen=True, kw_only=True)
class EffectModel:
    """Model of an effect in one kind of measurement, with one amplitude; amplitude 0 means absent.

    Each kind has a subclass with the functions by which the amplitude enters its forward map.

    Attributes
    ----------
    effect : entry in the catalogue.
    step : finite-difference step [SI].
    bounds : admissible interval of the amplitude [SI].
    prior_scale : amplitude that a careful lab may still overlook [SI]. The data cannot detect the effect if
        its detection needs a larger amplitude.
    physical_limits : bounds that are limits of the physics (a surface that slides freely) [SI]; an estimate
        may lie on them.
    start_fraction : largest start value of a fit, as a fraction of the bounds.
    scopes : levels of `Grouped.groups` to which it may be restricted, the widest first.
    in_all : True if all records may share it.
    positions : candidate positions along the specimen, as fractions of its length.
    applies_to : function that is True for a record that can have the effect.
    identifiable : function of (records of a candidate, all records) that is True if they constrain the
        amplitude at all; a candidate for which it is False has no column.
    variants : function from the records that it applies to, to the variants (a time constant, a direction).
    variant_label : text of a variant.
    conclusive : function of (records of a candidate, all records) that is True if they separate the effect
        from other smooth misfit; otherwise it is named only as part of an explanation.
    switch : True for an effect that is present or absent: its amplitude is then the upper bound.
    further : True for an effect that is searched for only if no other cause explains the data, since it is
        rarer, or so flexible that it would replace them.
    action : remedy with this kind of measurement; "" for the catalogue's remedy.
    hands_on : function to the material part of the effect, for extended cards; None if it has none.
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
        """True if a record can have the effect."""
        return self.applies_to(record)

    def labels(self, record: Grouped) -> tuple[str, ...]:
        """Labels of a record at the levels of `scopes`."""
        return tuple(record.groups[level] for level in self.scopes)


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """An effect in all records, or in those of one material, specimen, trial or other group.

    Attributes
    ----------
    effect : name of the effect.
    at : "all", or the label of a group of records.
    position : position in the specimen, as a fraction of its length; None for an effect without a position.
    alternatives : number of combinations of scope (at this level), position and variant that it is one of.
    variant, variant_name : variant of the effect as a number and as text; None and "" if it has one only.
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
        """Effect, position and variant: equal for all scopes."""
        return self.effect, self.position, self.variant


def candidates_of(records: Sequence[Grouped], effects: Mapping[str, EffectModel]) -> tuple[Candidate, ...]:
    """Candidates of each effect, for each position, scope and variant.

    The scopes are all records that the effect applies to and each group of its levels; a group with the same
    records as an earlier one is left out.
    """
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
    """Labels of the groups that an effect may be restricted to, and the number of groups at their level."""
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
    """True if a candidate applies to a record."""
    return model.acts_on(record) and (candidate.at == "all" or candidate.at in model.labels(record))
