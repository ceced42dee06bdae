"""Mullins effect: softening by the largest energy so far (Ogden and Roxburgh, Proc. R. Soc. A 455, 1999).

    S_iso = eta 2 dW/dC,    eta = 1 - erf((W_m - W)/(m + beta W_m)) / r

with W the isochoric energy (fibres included) and W_m its largest value so far at the point. First loading
(W = W_m) follows the law without softening. The stress derives from the energy

    f(W) = W + d/r [g(z) - g(z_0)],    g(z) = z erf z + exp(-z^2)/sqrt(pi),
    z = (W_m - W)/d,    z_0 = W_m/d,    d = m + beta W_m,

which is 0 at rest: what the material gives back. The energy dissipated per rest volume is
d/r [g(z_0) - g(0)]. Permanent set, recovery at rest, and the further loss in the second and later cycles to
the same stretch are not modelled.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy`)

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from tisim._checks import check_not_negative, check_number
from tisim.laws import ti
from tisim.parts._part import Array, Softening

_SQRT_PI = float(np.sqrt(np.pi))


@ti.func
def error_function(z):
    """erf z for z >= 0 to rounding, by 2 z/sqrt(pi) exp(-z^2) sum (2 z^2)^n / (2n + 1)!!, all terms >= 0."""
    found = 1.0
    if z < 6.0:
        term = 2.0 / _SQRT_PI * z * ti.exp(-z * z)
        found = term
        for n in range(1, 200):
            term *= 2.0 * z * z / (2.0 * n + 1.0)
            found += term
            if term < 1e-17 * found:
                break
    return found


@ti.func
def energy(W, largest, prm):
    d = prm[1] + prm[2] * largest
    z = ti.max(largest - W, 0.0) / d
    lost = error_function(z)
    bell = ti.exp(-z * z) / _SQRT_PI
    second = 0.0
    if largest > W:
        second = 2.0 * bell / (prm[0] * d)
    # less its value at rest, so that it is what the material gives back
    rest = largest / d
    at_rest = rest * error_function(rest) + ti.exp(-rest * rest) / _SQRT_PI
    return ti.Vector([W + d / prm[0] * (z * lost + bell - at_rest), 1.0 - lost / prm[0], second])


@dataclass(frozen=True, kw_only=True)
class OgdenRoxburgh(Softening):
    """Softening below the largest energy so far.

    Attributes
    ----------
    r : float
        1 or more; the smallest factor of the stress is 1 - 1/r.
    m : float
        Scale of the energy difference W_m - W at which softening sets in [J/m3], above 0.
    beta : float
        Fraction of the largest energy that is added to m [-], 0 or more.
    """

    name: ClassVar[str] = "ogden-roxburgh"
    title: ClassVar[str] = "Ogden-Roxburgh"
    units: ClassVar[Mapping[str, str]] = {"m": "J_per_m3"}
    energy: ClassVar[Any] = energy

    r: float
    m: float
    beta: float = 0.0

    def check(self) -> None:
        check_number("r", self.r, "a number of 1 or more", lambda v: v >= 1.0)
        check_number("m", self.m, "an energy above 0 J/m3", lambda v: v > 0.0)
        check_not_negative("beta", self.beta)

    def pack(self) -> Array:
        return np.array([self.r, self.m, self.beta], dtype=float)

    def dissipated(self, largest: Array) -> Array:
        from scipy.special import erf

        d = self.m + self.beta * largest
        z = largest / d
        return np.asarray(d / self.r * (z * erf(z) + np.expm1(-z * z) / _SQRT_PI))
