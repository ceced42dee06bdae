"""Strain energies as other programs write them, by their stress at given principal stretches.

Written apart from `tisim.laws` (plain NumPy, closed forms): that a form and the law that it stands for give
the same stress is a check of every conversion. With l_i the principal stretches, J their product, lb_i =
J^(-1/3) l_i, I1b and I2b the invariants of lb_i^2:

    polynomial            sum C_ij (I1b - 3)^i (I2b - 3)^j + U(J)
    ogden                 sum mu_p/alpha_p (sum_i lb_i^alpha_p - 3) + U(J)
    arruda-boyce          mu sum_n C_n / L^(2n-2) (I1b^n - 3^n) + U(J), five terms
    neo-hookean           mu/2 (I1 - 3) - mu ln J + lam/2 (ln J)^2
    stable-neo-hookean    mu/2 (I1 - 3) - mu (J - 1) + (lam + mu)/2 (J - 1)^2
    st-venant-kirchhoff   lam/2 (tr E)^2 + mu tr(E^2)

    U(J): "log" K/2 (ln J)^2, "linear" K/2 (J - 1)^2, "square" K/2 ((J^2 - 1)/2 - ln J)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tisim import laws
from tisim.laws.arruda_boyce import C as CHAINS

Array = NDArray[np.float64]
Kind = Literal[
    "polynomial", "ogden", "arruda-boyce", "neo-hookean", "stable-neo-hookean", "st-venant-kirchhoff"
]
Volume = Literal["log", "linear", "square"]
COUPLED = ("neo-hookean", "stable-neo-hookean", "st-venant-kirchhoff")
VOLUMES: Mapping[str, str] = {
    "log": "K/2 (ln J)^2",
    "linear": "K/2 (J - 1)^2",
    "square": "K/2 ((J^2 - 1)/2 - ln J)",
}


@dataclass(frozen=True, kw_only=True)
class Form:
    """A strain energy with its constants; see the module.

    Attributes
    ----------
    kind : str
    bulk : float
        K at small strain [Pa].
    terms : mapping of (int, int) to float
        C_ij of a polynomial [Pa].
    mu, alpha : tuple of float
        Of an Ogden form [Pa], [-]; mu alone (one value) of the others but the polynomial.
    locking : float
        L of Arruda and Boyce [-].
    volume : "log", "linear" or "square"
        U(J); coupled forms have their own, and do not look at it.
    """

    kind: Kind
    bulk: float
    terms: tuple[tuple[tuple[int, int], float], ...] = ()
    mu: tuple[float, ...] = ()
    alpha: tuple[float, ...] = ()
    locking: float = 0.0
    volume: Volume = "log"

    @property
    def shear_modulus(self) -> float:
        """At small strain [Pa]."""
        if self.kind == "polynomial":
            return 2.0 * sum(c for (i, j), c in self.terms if i + j == 1)
        if self.kind == "ogden":
            return 0.5 * float(np.dot(self.mu, self.alpha))
        if self.kind == "arruda-boyce":
            chain = sum((n + 1) * c * 3.0**n / self.locking ** (2 * n) for n, c in enumerate(CHAINS))
            return 2.0 * self.mu[0] * chain
        return self.mu[0]

    @property
    def lam(self) -> float:
        """Lame's first parameter [Pa]."""
        return self.bulk - 2.0 * self.shear_modulus / 3.0

    @property
    def young(self) -> float:
        """Young's modulus at small strain [Pa]."""
        return self._moduli.young_modulus

    @property
    def poisson(self) -> float:
        """Poisson's ratio at small strain [-]."""
        return self._moduli.poisson_ratio

    @property
    def _moduli(self) -> laws.Moduli:
        return laws.Moduli(shear_modulus=self.shear_modulus, bulk_modulus=self.bulk)

    def stress(self, stretches: Array) -> Array:
        """Principal first Piola-Kirchhoff stresses [Pa] at principal stretches, both (n, 3)."""
        return _kirchhoff(self, stretches) / stretches


def _kirchhoff(form: Form, l: Array) -> Array:
    J = l.prod(axis=1, keepdims=True)
    if form.kind == "neo-hookean":
        return form.mu[0] * (l**2 - 1.0) + form.lam * np.log(J)
    if form.kind == "stable-neo-hookean":
        mu = form.mu[0]
        return mu * (l**2 - J) + (form.lam + mu) * (J - 1.0) * J
    if form.kind == "st-venant-kirchhoff":
        E = 0.5 * (l**2 - 1.0)
        return l**2 * (form.lam * E.sum(axis=1, keepdims=True) + 2.0 * form.mu[0] * E)
    b = (l / np.cbrt(J)) ** 2
    I1 = b.sum(axis=1, keepdims=True)
    I2 = 0.5 * (I1**2 - (b**2).sum(axis=1, keepdims=True))
    if form.kind == "ogden":
        t = sum(m * b ** (0.5 * a) for m, a in zip(form.mu, form.alpha, strict=True))
    else:
        if form.kind == "arruda-boyce":
            r, mu = form.locking**-2, form.mu[0]
            W1 = sum(mu * c * (n + 1) * r**n * I1**n for n, c in enumerate(CHAINS))
            W2 = 0.0 * I1
        else:
            x, y = I1 - 3.0, I2 - 3.0
            W1 = sum(c * i * x ** (i - 1) * y**j for (i, j), c in form.terms if i) + 0.0 * x
            W2 = sum(c * j * x**i * y ** (j - 1) for (i, j), c in form.terms if j) + 0.0 * x
        t = 2.0 * W1 * b + 2.0 * W2 * (I1 * b - b**2)
    pressure = {"log": np.log(J), "linear": J * (J - 1.0), "square": 0.5 * (J**2 - 1.0)}[form.volume]
    return np.asarray(t - np.mean(t, axis=1, keepdims=True) + form.bulk * pressure)


def exact(law: str, parameters: laws.Parameters) -> Form | None:
    """The form that a law of tisim is; None for a law that is none of them."""
    moduli = laws.get(law).moduli(parameters)
    bulk = moduli.bulk_modulus

    def one(name: str) -> float:
        return float(np.asarray(parameters[name], dtype=float))

    def many(name: str) -> tuple[float, ...]:
        return tuple(float(x) for x in np.atleast_1d(np.asarray(parameters[name], dtype=float)))

    if law in COUPLED:
        return Form(kind=law, bulk=bulk, mu=(one("mu"),))  # type: ignore[arg-type]
    if law == "mooney-rivlin":
        return Form(kind="polynomial", bulk=bulk, terms=(((1, 0), one("c10")), ((0, 1), one("c01"))))
    if law == "yeoh":
        c10 = 0.5 * one("mu")
        return Form(kind="polynomial", bulk=bulk, terms=(((1, 0), c10), ((2, 0), c10 * one("stiffening"))))
    if law == "ogden":
        return Form(kind="ogden", bulk=bulk, mu=many("mu"), alpha=many("alpha"))
    if law == "arruda-boyce":
        return Form(kind="arruda-boyce", bulk=bulk, mu=(one("mu"),), locking=one("locking"))
    return None


def isochoric_twin(law: str, parameters: laws.Parameters) -> Form | None:
    """The form that is the law where the volume stays, with another volumetric part; None without one."""
    moduli = laws.get(law).moduli(parameters)
    c10 = 0.5 * moduli.shear_modulus
    if law in ("neo-hookean", "stable-neo-hookean"):
        return Form(kind="polynomial", bulk=moduli.bulk_modulus, terms=(((1, 0), c10),))
    if law == "stiffening-neo-hookean":
        second = c10 * float(np.asarray(parameters["stiffening"], dtype=float))
        return Form(kind="polynomial", bulk=moduli.bulk_modulus, terms=(((1, 0), c10), ((2, 0), second)))
    return None
