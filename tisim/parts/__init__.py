"""Parts of a material in addition to its law: one file and one registration each.

`Prony` (viscosity), `OgdenRoxburgh` (softening, Mullins effect) and `HolzapfelGasserOgden` (fibres) combine
with any law and with one another:

>>> import tisim
>>> silicone = tisim.Material(
...     law="neo-hookean",
...     parameters={"mu": 20e3, "lam": 1e6},
...     viscosity=tisim.Prony(fractions=(0.2, 0.1), times=(1.0, 30.0)),
...     softening=tisim.OgdenRoxburgh(r=2.0, m=2e3),
... )

With Wbar the law's isochoric energy, W_f that of the fibres and f the softened energy, they combine as

    S = S_vol + g_inf S_iso + sum Q_i,    S_iso = 2 d f(Wbar + W_f) / dC,
    dQ_i/dt + Q_i/tau_i = g_i dS_iso/dt.

Fibres add to the law, softening acts on their sum, and viscosity relaxes the softened stress; the volumetric
part is unaffected. The largest energy in the history of softening is that of Wbar + W_f at any rate.

A user's own part is a frozen dataclass that derives from `Viscosity`, `Softening` or `Fibres`. A complete
example, in a file (relaxation by an equal fraction per decade, as in silicones):

>>> from dataclasses import dataclass
>>> import numpy as np
>>> from tisim import parts
>>>
>>> @dataclass(frozen=True, kw_only=True)
... class LogTime(parts.Viscosity):
...     '''Relaxation by `part` of the long-time modulus per decade, from time `first` to time `last` [s].'''
...
...     name = "log-time"
...     title = "Log-time relaxation"
...     part: float
...     first: float = 1e-2
...     last: float = 1e4
...
...     def check(self):
...         if not 0.0 < self.first < self.last:
...             raise ValueError(f"first: expected a time above 0 and below last, got {self.first!r}")
...
...     def spectrum(self):
...         times = 10.0 ** np.arange(np.log10(self.first), np.log10(self.last) + 0.25, 0.5)
...         return parts.Spectrum(equilibrium=1.0, strengths=np.full(len(times), self.part / 2), times=times)
>>>
>>> _ = parts.register(LogTime)

After this `tisim.Material(viscosity=LogTime(part=0.05), ...)` can be solved, and `parts.get("log-time")`
returns the class.
"""

from __future__ import annotations

import re
from dataclasses import is_dataclass
from typing import TypeVar

from tisim.parts._part import Fibres, Part, Softening, Spectrum, Viscosity
from tisim.parts._point import MaterialPoints, PointResponse, respond
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
    derived = isinstance(part, type) and issubclass(part, Viscosity | Softening | Fibres)
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


__all__ = [
    "Fibres",
    "HolzapfelGasserOgden",
    "MaterialPoints",
    "OgdenRoxburgh",
    "Part",
    "PointResponse",
    "Prony",
    "Softening",
    "Spectrum",
    "Viscosity",
    "get",
    "names",
    "register",
    "respond",
    "unregister",
]
