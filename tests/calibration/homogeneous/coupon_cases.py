"""Synthetic homogeneous tests: closed-form stresses of incompressible laws, without code of calibration."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from made_experiment import experiment as experiment
from numpy.typing import NDArray

from calibration.experiment.model import CouponMode, CouponTrial

Array = NDArray[np.float64]
MODES: tuple[CouponMode, ...] = ("uniaxial", "equibiaxial", "planar", "simple-shear")
AB = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


def mooney(c10: float, c01: float, mode: str, s: Array) -> Array:
    """Nominal stress in the stretch s of each driven axis; in simple shear s - 1 is the amount of shear."""
    if mode == "uniaxial":
        return 2 * (s - s**-2) * (c10 + c01 / s)
    if mode == "equibiaxial":
        return 2 * (s - s**-5) * (c10 + c01 * s**2)
    if mode == "planar":
        return 2 * (s - s**-3) * (c10 + c01)
    return 2 * (s - 1) * (c10 + c01)


def first_invariant(mode: str, s: Array) -> Array:
    return {
        "uniaxial": s**2 + 2 / s,
        "equibiaxial": 2 * s**2 + s**-4,
        "planar": s**2 + 1 + s**-2,
        "simple-shear": 3 + (s - 1) ** 2,
    }[mode]


def arruda_boyce(mu: float, locking: float, mode: str, s: Array) -> Array:
    i1 = first_invariant(mode, s)
    slope = mu * sum((k + 1) * c * i1**k / locking ** (2 * k) for k, c in enumerate(AB))
    return mooney(1.0, 0.0, mode, s) * slope


def ogden(mu: tuple[float, ...], alpha: tuple[float, ...], mode: str, s: Array) -> Array:
    total = np.zeros_like(s)
    for m, a in zip(mu, alpha, strict=True):
        if mode == "simple-shear":
            # principal stretches q and 1/q with q - 1/q = gamma
            q = (s - 1) / 2 + np.sqrt(1 + (s - 1) ** 2 / 4)
            total += m * (q**a - q**-a) / (q + 1 / q)
        else:
            power = {"uniaxial": -a / 2, "equibiaxial": -2 * a, "planar": -a}[mode]
            total += m * (s**a - s**power) / s
    return total


def coupon(
    mode: CouponMode,
    stretch: Array,
    law: Callable[[str, Array], Array],
    *,
    stress_sd: float | None = None,
    stretch_sd: float = 0.0,
    relative: float = 0.0,
    seed: int = 0,
) -> CouponTrial:
    """Synthetic homogeneous test with normal errors.

    The stress has errors of `stress_sd` [Pa] and, relative to it, of `relative`; the recorded stretch has
    errors of `stretch_sd`.
    """
    rng = np.random.default_rng(seed)
    stress = law(mode, stretch) * (1.0 + relative * rng.normal(size=stretch.size))
    stress = stress + (stress_sd or 0.0) * rng.normal(size=stretch.size)
    return CouponTrial(
        id=mode,
        material="made",
        mode=mode,
        stretch=stretch + stretch_sd * rng.normal(size=stretch.size),
        stress=stress,
        stress_sd=stress_sd,
        stretch_sd=stretch_sd,
    )
