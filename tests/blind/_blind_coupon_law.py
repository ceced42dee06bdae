"""Stresses of homogeneous tests for made coupons: an energy of the principal stretches, differentiated by a
complex step. It shares no code with `tisim` or `calibration`.

The test's path l(s) is incompressible; the nominal stress on a driven face is dW/ds over the number of driven
axes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating]
TINY = 1e-30


@dataclass(frozen=True, kw_only=True)
class Solid:
    """An incompressible solid of shear modulus G [Pa] (of an isotropic one, at rest).

    stiffening: W gets G/2 a (I1 - 3)^2. second: part of G that goes with I2. locking: 1 / N, with N the
    number of links of the eight chains (0: Gaussian chains). fibre: W gets G k / 8 (I4 - 1)^2 along axis 1.
    """

    G: float
    stiffening: float = 0.0
    second: float = 0.0
    locking: float = 0.0
    fibre: float = 0.0

    def stress(self, mode: str, s: Array) -> Array:
        """Nominal stress [Pa] at the driven stretch (simple shear: 1 + gamma)."""
        driven = 2.0 if mode == "equibiaxial" else 1.0
        return np.asarray(np.imag(self._energy(mode, s + 1j * TINY)) / TINY / driven)

    def energy(self, mode: str, s: Array) -> Array:
        return np.asarray(np.real(self._energy(mode, s + 0j)))

    def _energy(self, mode: str, s: Complex) -> Complex:
        squares = _squared_stretches(mode, s)
        i1 = squares[0] + squares[1] + squares[2]
        i2 = squares[0] * squares[1] + squares[1] * squares[2] + squares[2] * squares[0]
        w = 0.5 * (1.0 - self.second) * _chains(i1, self.locking)
        w = w + 0.5 * self.second * (i2 - 3.0) + 0.5 * self.stiffening * (i1 - 3.0) ** 2
        if self.fibre and mode != "simple-shear":  # in simple shear along it a fibre keeps its length
            w = w + self.fibre / 8.0 * (s**2 - 1.0) ** 2
        return self.G * w


def _squared_stretches(mode: str, s: Complex) -> tuple[Complex, ...]:
    if mode == "uniaxial":
        return s**2, 1.0 / s, 1.0 / s
    if mode == "equibiaxial":
        return s**2, s**2, s**-4
    if mode == "planar":
        return s**2, np.ones_like(s), s**-2
    gamma = s - 1.0
    half = 1.0 + gamma**2 / 2.0
    # the root of gamma^2 (1 + gamma^2/4) is taken analytically, so that the complex step passes through 0
    root = gamma * np.sqrt(1.0 + gamma**2 / 4.0)
    return half + root, half - root, np.ones_like(s)


def _chains(i1: Complex, inverse: float) -> Complex:
    """2 W / G of eight Langevin chains with 1/inverse links, scaled so that the modulus at rest is G; I1 - 3
    where the chains are Gaussian."""
    if inverse == 0.0:
        return i1 - 3.0
    at_rest = _chain_energy(np.array([inverse**0.5 + 0j]))[0]
    force = _chain_tension(np.array([inverse**0.5 + 0j]))[0]
    slope_at_rest = force * inverse**0.5 / 6.0  # d energy / d I1 where I1 is 3: x is (inverse I1 / 3)^(1/2)
    return (_chain_energy(np.sqrt(i1 * inverse / 3.0)) - at_rest) / slope_at_rest


def _chain_energy(x: Complex) -> Complex:
    """Of a Langevin chain, a link, over kT, at the part x of its length (Kuhn and Gruen, 1942)."""
    b = _chain_tension(x)
    # ln(b / sinh b), which does not overflow for long b
    return x * b + np.log(2.0 * b) - b - np.log(1.0 - np.exp(-2.0 * b))


def _chain_tension(x: Complex) -> Complex:
    """b with coth b - 1/b = x, by Newton's steps, which rise to it from 3 x."""
    b = 3.0 * x
    for _ in range(100):
        coth = (1.0 + np.exp(-2.0 * b)) / (1.0 - np.exp(-2.0 * b))
        step = (coth - 1.0 / b - x) / (1.0 - coth**2 + 1.0 / b**2)
        b = b - step
        if np.abs(step / b).max(initial=0.0) < 1e-12:
            return b
    raise RuntimeError("no tension of a Langevin chain")


def inverse_of(measured: Callable[[Array], Array], wanted: Array) -> Array:
    """True stretches whose recorded ones are `wanted`: fixed points of s + (wanted - measured(s))."""
    s = wanted.copy()
    for _ in range(200):
        change = wanted - measured(s)
        s = s + 0.7 * change
        if np.abs(change).max() < 1e-12:
            return s
    raise RuntimeError("no true stretch for what the rig shows")
