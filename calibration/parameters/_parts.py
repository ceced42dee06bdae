"""Search coordinates of what a material has beside its law (`tisim.parts`), and a registry of them.

A part is named in one word, with an argument after a colon where it takes one ("prony:2").
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from calibration.parameters._coordinates import Coordinate
from tisim import laws
from tisim.parts import Part

Values = dict[str, float]
Option = Literal["time", "damage", "fibres"]


@dataclass(frozen=True, kw_only=True)
class ProtocolWindow:
    """Times and peak strains of a material's tests, which limit what they show of its parts.

    Attributes
    ----------
    first, last : float
        Shortest ramp and longest hold (longest test, where none has a hold) [s]: relaxation times between
        them are seen. Both 0 where no test has a clock.
    peaks : int
        Different largest strains that were unloaded from.
    """

    first: float
    last: float
    peaks: int


@dataclass(frozen=True, kw_only=True)
class PartCoordinates:
    """A part of a material in search coordinates.

    Attributes
    ----------
    spec : str
        As it is asked for ("prony:2"); empty where it is held.
    label : str
        Name in tables and file names ("prony-2").
    field : str
        Field of `tisim.Material` ("viscosity", "softening").
    window : ProtocolWindow
        Times and peak strains of the tests that it was made for.
    coordinates : tuple of Coordinate
    assemble : callable
        Values by coordinate name -> the part; ValueError where it refuses them.
    describe : callable
        Values, and the law's small-strain moduli -> sentences for `Parametrisation.remarks`.
    take_apart : callable, optional
        The inverse of `assemble`: a part -> values; ValueError for one of another form.
    """

    spec: str
    label: str
    field: str
    window: ProtocolWindow
    coordinates: tuple[Coordinate, ...]
    assemble: Callable[[Values], Part]
    describe: Callable[[Values, laws.Moduli], list[str]]
    take_apart: Callable[[Part], Values] | None = None

    def starting_at(self, part: Part) -> PartCoordinates:
        """The same, searched from a part on; ValueError for one that these coordinates do not describe."""
        if self.take_apart is None:
            raise ValueError(f"{self.spec} does not begin at a {part.name}")
        values = self.take_apart(part)
        begun = tuple(
            replace(c, start=min(max(values[c.name], c.low), c.high), start_per_shear=None)
            for c in self.coordinates
        )
        return replace(self, coordinates=begun)

    def assembled(self, values: Values) -> Part:
        """The part at these values; ValueError where they make none."""
        found = self.assemble(values)
        found.check()
        return found

    def remarks(self, values: Values, moduli: laws.Moduli) -> list[str]:
        """Notes for the reader on the part at these values."""
        return self.describe(values, moduli)


@dataclass(frozen=True, kw_only=True)
class PartKind:
    """A part that can be fitted.

    Attributes
    ----------
    name : str
        Text before the colon.
    option : str
        Option of a fit that requests it.
    usage : str
        Values that may be given, for help and errors ("prony, prony:1, ...").
    make : callable
        Argument after the colon ("" without one) and window -> `PartCoordinates`; ValueError, in one
        sentence, for an argument that it does not take.
    needs_time : bool
        Every record must have a clock.
    alternatives : tuple of str
        Arguments among which the data choose where none is given.
    """

    name: str
    option: Option
    usage: str
    make: Callable[[str, ProtocolWindow], PartCoordinates]
    needs_time: bool = False
    alternatives: tuple[str, ...] = ()


def one_form(
    name: str,
    *,
    option: Option,
    field: str,
    coordinates: tuple[Coordinate, ...],
    assemble: Callable[[Values], Part],
    describe: Callable[[Values, ProtocolWindow], list[str]],
    take_apart: Callable[[Part], Values] | None = None,
) -> PartKind:
    """A part that takes no argument, with the same coordinates whatever the tests show.

    Parameters
    ----------
    name, option
        As in `PartKind`; the name is the spec, the label and the usage.
    field, coordinates, assemble, take_apart
        As in `PartCoordinates`.
    describe : callable
        Values, and what the tests show -> sentences for a reader.
    """

    def make(argument: str, window: ProtocolWindow) -> PartCoordinates:
        if argument:
            raise ValueError(f"expected {name}")
        return PartCoordinates(
            spec=name,
            label=name,
            field=field,
            window=window,
            coordinates=coordinates,
            assemble=assemble,
            describe=lambda values, _: describe(values, window),
            take_apart=take_apart,
        )

    return PartKind(name=name, option=option, usage=name, make=make)


_KINDS: dict[str, PartKind] = {}


def register_part(kind: PartKind) -> None:
    """Make a part known to fits; one of the same name is replaced."""
    _KINDS[kind.name] = kind


def part_kinds(option: str | None = None) -> tuple[PartKind, ...]:
    """All parts, or those of an option."""
    return tuple(k for k in _KINDS.values() if option in (None, k.option))


def part_kind(spec: str) -> PartKind:
    """The part that a spec names; ValueError, which names those there are, for an unknown one."""
    found = _KINDS.get(spec.partition(":")[0])
    if found is None:
        raise ValueError(f"expected one of {', '.join(k.usage for k in _KINDS.values())}")
    return found


def part_coordinates(spec: str, window: ProtocolWindow) -> PartCoordinates:
    """A part in search coordinates; ValueError for an unknown one, or an argument that it does not take."""
    return part_kind(spec).make(spec.partition(":")[2], window)


def part_alternatives(spec: str) -> tuple[str, ...]:
    """Specs among which the data choose; the spec alone where it says all."""
    kind = part_kind(spec)
    if spec != kind.name or not kind.alternatives:
        return (spec,)
    return tuple(f"{kind.name}:{a}" for a in kind.alternatives)
