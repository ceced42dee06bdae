"""Registry of the parts by name."""

from __future__ import annotations

import re
from dataclasses import is_dataclass
from typing import TypeVar

from tisim.parts._part import FIELDS, Part
from tisim.parts.holzapfel_gasser_ogden import HolzapfelGasserOgden
from tisim.parts.ogden_roxburgh import OgdenRoxburgh
from tisim.parts.prony import Prony

_BUILT_IN: dict[str, type[Part]] = {part.name: part for part in (Prony, OgdenRoxburgh, HolzapfelGasserOgden)}
_ADDED: dict[str, type[Part]] = {}
_NAME = re.compile(r"[a-z0-9][a-z0-9-]*")

P = TypeVar("P", bound=type[Part])


def register(part: P) -> P:
    """Add a class of parts; an added class of the same name is replaced.

    Parameters
    ----------
    part : type
        A dataclass that derives from `Viscosity`, `Softening` or `Fibres`.

    Returns
    -------
    type
        The argument.

    Raises
    ------
    TypeError
        If it is not such a dataclass.
    ValueError
        If its name is that of a built-in part or has other characters than lower-case letters, digits and
        hyphens.
    """
    derived = isinstance(part, type) and issubclass(part, tuple(FIELDS.values()))
    if not derived or not is_dataclass(part):
        wanted = "a dataclass that derives from Viscosity, Softening or Fibres"
        raise TypeError(f"part: expected {wanted}, got {part!r}")
    name = getattr(part, "name", "")
    if not _NAME.fullmatch(name):
        raise ValueError(f"part: expected a name of lower-case letters, digits and hyphens, got {name!r}")
    if name in _BUILT_IN:
        raise ValueError(f"part: {name!r} is a part of tisim's own; choose another name")
    _ADDED[name] = part
    return part


def unregister(name: str) -> None:
    """Remove an added part; other names are ignored."""
    _ADDED.pop(name, None)


def names() -> tuple[str, ...]:
    """Names of all parts, the built-in ones first."""
    return tuple(_BUILT_IN) + tuple(_ADDED)


def get(name: str) -> type[Part]:
    """The part of that name; ValueError, which lists the known parts, for an unknown one."""
    part = _BUILT_IN.get(name) or _ADDED.get(name)
    if part is None:
        raise ValueError(f"part: expected one of {', '.join(names())}, got {name!r}")
    return part
