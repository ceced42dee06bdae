"""Invariants of incompressible homogeneous tests, and the nominal stress of an energy W(I1, I2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponMode

Array = NDArray[np.float64]

# Functions of the driven stretch s, by mode; in simple shear s = 1 + gamma.


def first_excess(mode: CouponMode, s: Array) -> Array:
    """I1 - 3, shape of s."""
    if mode == "uniaxial":
        return np.asarray(s**2 + 2.0 / s - 3.0)
    if mode == "equibiaxial":
        return np.asarray(2.0 * s**2 + s**-4 - 3.0)
    if mode == "planar":
        return np.asarray(s**2 + s**-2 - 2.0)
    return np.asarray((s - 1.0) ** 2)


def slopes(mode: CouponMode, s: Array) -> tuple[Array, Array]:
    """dI1/ds and dI2/ds, each divided by the number of driven axes.

    The nominal stress of an energy W(I1, I2) is dW/dI1 and dW/dI2 times these.
    """
    if mode == "uniaxial":
        return 2.0 * (s - s**-2), 2.0 * (1.0 - s**-3)
    if mode == "equibiaxial":
        return 2.0 * (s - s**-5), 2.0 * (s**3 - s**-3)
    both = 2.0 * (s - s**-3) if mode == "planar" else 2.0 * (s - 1.0)
    return both, both


def stress_of(mode: CouponMode, s: Array, by_first: Array | float, by_second: Array | float = 0.0) -> Array:
    """Nominal stress of an energy with derivatives dW/dI1 and dW/dI2, in their unit."""
    one, two = slopes(mode, s)
    return np.asarray(one * by_first + two * by_second)


COMPRESSED = 0.97  # stretch below which a test counts as compression, and as much above 1 as tension


def goes_into_compression(mode: CouponMode, s: Array) -> bool:
    """True for a uniaxial test that goes below COMPRESSED."""
    return mode == "uniaxial" and bool(s.min() < COMPRESSED)


def goes_into_tension(mode: CouponMode, s: Array) -> bool:
    """True for a uniaxial test that goes above 2 - COMPRESSED."""
    return mode == "uniaxial" and bool(s.max() > 2.0 - COMPRESSED)


def slab_factor(x: Array) -> Array:
    """Ratio of the mean pressure under a platen with friction to that without, shape of x (slab method).

    x = friction coefficient * diameter / height. The pressure increases exponentially inwards.
    """
    small = np.abs(x) < 1e-2
    large = np.where(small, 1.0, x)
    exact = 2.0 * (np.expm1(large) - large) / large**2
    return np.asarray(np.where(small, 1.0 + x / 3.0 + x**2 / 12.0, exact))
