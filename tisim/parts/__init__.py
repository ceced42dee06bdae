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
returns the class. `encode` and `decode` convert a part to and from plain values, as material cards have them:

>>> parts.encode(silicone.softening)
{'kind': 'ogden-roxburgh', 'r': 2.0, 'm_J_per_m3': 2000.0, 'beta': 0.0}
>>> parts.decode("viscosity", {"kind": "log-time", "part": 0.05})
LogTime(part=0.05, first=0.01, last=10000.0)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tisim.parts._entry import EntryError, EntryProblem, decode, encode
from tisim.parts._part import FIELDS, Fibres, Part, Softening, Spectrum, Viscosity, of, ramp_weight
from tisim.parts._registry import get, names, register, unregister
from tisim.parts.holzapfel_gasser_ogden import HolzapfelGasserOgden
from tisim.parts.ogden_roxburgh import OgdenRoxburgh
from tisim.parts.prony import Prony

if TYPE_CHECKING:
    from tisim.material_points import MaterialPoints, PointResponse, respond


def __getattr__(name: str) -> Any:
    if name in ("MaterialPoints", "PointResponse", "respond"):  # of whole materials, which are made of parts
        from tisim import material_points

        return getattr(material_points, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "FIELDS",
    "EntryError",
    "EntryProblem",
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
    "decode",
    "encode",
    "get",
    "names",
    "of",
    "ramp_weight",
    "register",
    "respond",
    "unregister",
]
