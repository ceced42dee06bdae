"""One family of fibres that stiffen exponentially (Holzapfel, Gasser and Ogden, J. Elasticity 61, 2000).

    W = k1/(2 k2) [exp(k2 (I4bar - 1)^2) - 1]  if I4bar > 1, else 0;    I4bar = J^(-2/3) a.Ca

Fibres carry no compression. W adds to the law's isochoric energy: softening acts on their sum, and viscous
terms relax both.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy`)

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from tisim._checks import FieldError, check_not_negative, check_vector
from tisim.laws import ti
from tisim.parts._part import Array, Fibres


@ti.func
def energy(I4, prm):
    e = ti.max(I4 - 1.0, 0.0)
    grown = ti.exp(prm[1] * e * e)
    # (grown - 1) / (2 k2), by its series where the difference would lose digits
    x = prm[1] * e * e
    over = 0.5 * e * e * (1.0 + 0.5 * x * (1.0 + x / 3.0))
    if x > 1e-5:
        over = 0.5 * (grown - 1.0) / prm[1]
    second = 0.0
    if I4 > 1.0:
        second = prm[0] * grown * (1.0 + 2.0 * prm[1] * e * e)
    return ti.Vector([prm[0] * over, prm[0] * e * grown, second])


@dataclass(frozen=True, kw_only=True)
class HolzapfelGasserOgden(Fibres):
    """One family of fibres.

    Attributes
    ----------
    direction : (float, float, float)
        Direction of the fibres in the rest shape, of any length above 0.
    k1 : float
        Stiffness [Pa], 0 or more; fibres add 4 k1 to the small-strain stiffness in tension along them.
    k2 : float
        Exponent of the stiffening [-], 0 or more.
    """

    name: ClassVar[str] = "holzapfel-gasser-ogden"
    title: ClassVar[str] = "Holzapfel-Gasser-Ogden fibres"
    units: ClassVar[Mapping[str, str]] = {"k1": "Pa"}
    energy: ClassVar[Any] = energy

    k1: float
    k2: float = 0.0

    def check(self) -> None:
        check_vector("direction", self.direction)
        if not np.linalg.norm(self.direction) > 0.0:
            raise FieldError("direction", "a direction other than (0, 0, 0)", self.direction)
        check_not_negative("k1", self.k1, "a stiffness of 0 Pa or more")
        check_not_negative("k2", self.k2)

    def pack(self) -> Array:
        return np.array([self.k1, self.k2], dtype=float)
