"""Constitutive laws: one file and one registration each.

A law is a registered `Law`. A complete example of a user's own law, in a file (Neo-Hookean, isochoric):

>>> import numpy as np
>>> from tisim import laws
>>> from tisim.laws import Law, Moduli, by_invariants, first_isochoric, ti
>>>
>>> @ti.func
... def energy(I1, I2, J, prm: "ti.template()"):
...     i1, slope = first_isochoric(I1, J)
...     return by_invariants(0.5 * prm[0] * (i1 - 3.0), 0.5 * prm[0], 0.0, i1, slope, J)
>>>
>>> mine = Law(
...     name="isochoric-neo-hookean",
...     title="Neo-Hookean, isochoric",
...     parameters={"mu": ("Pa", "scalar"), "bulk": ("Pa", "scalar")},
...     family="invariant",
...     theta="log",
...     energy=energy,
...     pack=lambda p: np.array([p["mu"]]),
...     kappa=lambda p: p["bulk"],
...     moduli=lambda p: Moduli(shear_modulus=p["mu"], bulk_modulus=p["bulk"]),
...     from_moduli=lambda shear_modulus, bulk_modulus: {"mu": shear_modulus, "bulk": bulk_modulus},
... )
>>> _ = laws.register(mine)

After this `tisim.Material(law="isochoric-neo-hookean", ...)` can be solved, in other processes too.
`laws.check_law("isochoric-neo-hookean")` checks its derivatives, frame indifference, rest state and moduli.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tisim.laws._constants import Extension, extension, scaled, with_moduli
from tisim.laws._energy import by_invariants, first_isochoric, ti
from tisim.laws._law import Law, Moduli, Parameters
from tisim.laws._registry import added, all_names, get, names, register, unregister

if TYPE_CHECKING:
    from tisim.laws._check import LawReport, check_law, evaluate


def __getattr__(name: str) -> Any:
    if name in ("LawReport", "check_law", "evaluate"):  # they import NumPy, which a command's help avoids
        from tisim.laws import _check

        return getattr(_check, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "Extension",
    "Law",
    "LawReport",
    "Moduli",
    "Parameters",
    "added",
    "all_names",
    "by_invariants",
    "check_law",
    "evaluate",
    "extension",
    "first_isochoric",
    "get",
    "names",
    "register",
    "scaled",
    "ti",
    "unregister",
    "with_moduli",
]
