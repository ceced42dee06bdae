"""Constitutive laws of the laboratory's time-dependent materials; all moduli are long-time ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Prony:
    """Relaxation function 1 + sum g_i exp(-t/tau_i) of the isochoric stress, over its long-time value.

    Attributes
    ----------
    fractions : tuple of float
        g_i [-].
    times : tuple of float
        tau_i [s].
    """

    fractions: tuple[float, ...] = ()
    times: tuple[float, ...] = ()

    @property
    def g(self) -> Array:
        """Fractions, shape (n,)."""
        return np.array(self.fractions)

    @property
    def tau(self) -> Array:
        """Relaxation times [s], shape (n,)."""
        return np.array(self.times)

    @property
    def instantaneous(self) -> float:
        """Instantaneous over long-time modulus."""
        return 1.0 + float(self.g.sum())

    def modulus(self, time: Array) -> Array:
        """Relaxation function at times after a step [s]."""
        return np.asarray(1.0 + np.exp(-np.asarray(time)[..., None] / self.tau) @ self.g)

    def compliance(self, time: Array) -> Array:
        """Creep function after a step of stress, times the long-time modulus.

        The creep function of a Prony series is one as well: with G(s) = 1 + sum g_i s tau_i/(1 + s tau_i),
        the Laplace transform of the creep rate is 1/(s G(s)), whose poles are the zeros of G.
        """
        # zeros s_k < 0 of prod (1 + s tau_i) G(s), one below each -1/tau_i
        whole = np.poly1d([1.0])
        for tau in self.tau:
            whole = whole * np.poly1d([tau, 1.0])
        total = whole
        for g, tau in zip(self.g, self.tau, strict=True):
            rest = np.poly1d([1.0])
            for other in self.tau:
                if other != tau:
                    rest = rest * np.poly1d([other, 1.0])
            total = total + np.poly1d([g * tau, 0.0]) * rest
        poles = np.real(total.roots)
        weights = whole(poles) / (poles * total.deriv()(poles))
        return np.asarray(1.0 + np.exp(np.asarray(time)[..., None] * poles) @ weights)


@dataclass(frozen=True, kw_only=True)
class Softening:
    """Ogden and Roxburgh: eta = 1 - erf((W_m - W)/(m + beta W_m))/r; m [J/m3]."""

    r: float
    m: float
    beta: float = 0.0

    def eta(self, energy: Array, largest: Array) -> Array:
        """Factor of the stress at an energy, given the largest one so far [J/m3]."""
        return np.asarray(1.0 - erf((largest - energy) / (self.m + self.beta * largest)) / self.r)


@dataclass(frozen=True, kw_only=True)
class Fibres:
    """One family of fibres in the plane of axes 1 and 2, turned by `angle` [rad] from axis 1 to axis 2.

    W = k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) in tension (I4 > 1), else 0; k1 [Pa].
    """

    k1: float
    k2: float
    angle: float

    @property
    def squares(self) -> Array:
        """Squared direction cosines, shape (3,)."""
        return np.array([np.cos(self.angle) ** 2, np.sin(self.angle) ** 2, 0.0])


@dataclass(frozen=True, kw_only=True)
class Solid:
    """An incompressible material with an Ogden law for the long-time stress, optionally fibres and softening.

    W = sum_p mu_p/alpha_p (lambda_1^alpha_p + lambda_2^alpha_p + lambda_3^alpha_p - 3) + W_fibres

    Attributes
    ----------
    mu, alpha : tuple of float
        Ogden's constants [Pa], [-]; small-strain shear modulus 1/2 sum mu_p alpha_p.
    prony : Prony
        Relaxation.
    softening : Softening or None
    fibres : Fibres or None
    """

    mu: tuple[float, ...]
    alpha: tuple[float, ...]
    prony: Prony = Prony()
    softening: Softening | None = None
    fibres: Fibres | None = None

    @property
    def shear_modulus(self) -> float:
        """Long-time shear modulus of the law at small strain, without fibres [Pa]."""
        return 0.5 * float(np.dot(self.mu, self.alpha))

    def energy(self, stretches: Array) -> Array:
        """W [J/m3] at principal stretches (..., 3) along fixed axes, whose product is 1."""
        stretches = np.asarray(stretches)
        total = np.zeros(stretches.shape[:-1])
        for mu, alpha in zip(self.mu, self.alpha, strict=True):
            total = total + mu / alpha * ((stretches**alpha).sum(axis=-1) - 3.0)
        if self.fibres is not None:
            over = np.maximum(stretches**2 @ self.fibres.squares - 1.0, 0.0)
            k1, k2 = self.fibres.k1, self.fibres.k2
            total = total + (k1 / (2.0 * k2) * np.expm1(k2 * over**2) if k2 else 0.5 * k1 * over**2)
        return np.asarray(total)

    def deviator(self, stretches: Array) -> Array:
        """Normal components of S_iso = 2 dW/dC without softening (..., 3) [Pa].

        S_iso : C = 0. Fibres off the axes add a shear component, which does not affect these components if
        the axes do not rotate.
        """
        stretches = np.asarray(stretches)
        kirchhoff = np.zeros_like(stretches)
        for mu, alpha in zip(self.mu, self.alpha, strict=True):
            kirchhoff = kirchhoff + mu * stretches**alpha
        if self.fibres is not None:
            squares = stretches**2 * self.fibres.squares
            over = np.maximum(squares.sum(axis=-1) - 1.0, 0.0)
            slope = self.fibres.k1 * over * np.exp(self.fibres.k2 * over**2)
            kirchhoff = kirchhoff + 2.0 * slope[..., None] * squares
        kirchhoff = kirchhoff - kirchhoff.mean(axis=-1, keepdims=True)
        return np.asarray(kirchhoff / stretches**2)

    def sheared(self, plane: Array) -> tuple[float, Array]:
        """W, and the components 11, 22, 33, 12 of S_iso without softening, under shear of axes 1 and 2.

        `plane` (2, 2) is C in the plane of axes 1 and 2; the deformation is isochoric.
        """
        squares, axes = np.linalg.eigh(plane)
        third = 1.0 / float(squares[0] * squares[1])
        stretches = np.sqrt(np.array([squares[0], squares[1], third]))
        law = Solid(mu=self.mu, alpha=self.alpha)
        energy, principal = float(law.energy(stretches)), law.deviator(stretches)
        tensor = (axes * principal[:2]) @ axes.T
        found = np.array([tensor[0, 0], tensor[1, 1], principal[2], tensor[0, 1]])
        if self.fibres is not None:
            f = self.fibres
            a = np.array([np.cos(f.angle), np.sin(f.angle)])
            over = float(a @ plane @ a) - 1.0
            if over > 0.0:
                energy += (
                    float(f.k1 / (2.0 * f.k2) * np.expm1(f.k2 * over**2)) if f.k2 else 0.5 * f.k1 * over**2
                )
                slope = 2.0 * f.k1 * over * np.exp(f.k2 * over**2)
                inverse = np.linalg.inv(plane)
                volume = np.array([inverse[0, 0], inverse[1, 1], 1.0 / third, inverse[0, 1]])
                direction = np.array([a[0] ** 2, a[1] ** 2, 0.0, a[0] * a[1]])
                found = found + slope * (direction - (over + 1.0) / 3.0 * volume)
        return energy, found

    def truth(self) -> dict[str, Any]:
        """Parameters for truth.yaml, SI units in the keys."""
        found: dict[str, Any] = {
            "law": "ogden",
            "mu_Pa": [float(v) for v in self.mu],
            "alpha": [float(v) for v in self.alpha],
            "shear_modulus_Pa": self.shear_modulus,
        }
        if self.prony.fractions:
            found["prony"] = {
                "modulus": "long-time",
                "fractions": [float(v) for v in self.prony.fractions],
                "times_s": [float(v) for v in self.prony.times],
            }
        if self.softening is not None:
            s = self.softening
            found["mullins"] = {"r": float(s.r), "m_J_m3": float(s.m), "beta": float(s.beta)}
        if self.fibres is not None:
            f = self.fibres
            angle = float(np.degrees(f.angle))
            found["fibres"] = {"k1_Pa": float(f.k1), "k2": float(f.k2), "angle_deg": angle}
        return found
