"""Registry of the parts that can be fitted beside a material's law (`tisim.parts`).

A part is named in one word, with an argument after a colon where it takes one ("prony:2").
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from calibration.parameters._coordinates import Coordinate, PartCoordinates, ProtocolWindow, Values
from tisim.parts import Part

Option = Literal["time", "damage", "fibres"]


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
