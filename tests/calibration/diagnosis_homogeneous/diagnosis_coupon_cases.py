"""Homogeneous tests for the tests of their diagnosis: closed forms that share no code with calibration."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from made_experiment import experiment as experiment
from numpy.typing import NDArray

from calibration.diagnosis.catalogue import effects_of
from calibration.experiment import CouponMode, CouponTrial, Experiment
from calibration.measurements.homogeneous.model import HomogeneousModel

Array = NDArray[np.float64]
G = 5e4


def neo_hookean(mode: str, s: Array) -> Array:
    power = {"uniaxial": -2, "equibiaxial": -5, "planar": -3}
    return G * ((s - 1.0) if mode == "simple-shear" else s - s ** power[mode])


def trial(
    name: str,
    mode: CouponMode,
    stretch: Array,
    stress: Callable[[str, Array], Array] | Array = neo_hookean,
    *,
    sd: float | None = 200.0,
    rate: float | None = 0.01,
    material: str = "A",
    specimen: str | None = None,
    stretch_sd: float = 0.0,
    seed: int = 0,
) -> CouponTrial:
    """Synthetic trial with noise of `sd` [Pa] on the stress; None: no noise, and no stated error."""
    rng = np.random.default_rng(seed)
    clean = stress(mode, stretch) if callable(stress) else stress
    time = None if rate is None else np.cumsum([0.0, *np.abs(np.diff(stretch))]) / rate
    return CouponTrial(
        id=name,
        material=material,
        mode=mode,
        specimen=specimen,
        stretch=stretch + stretch_sd * rng.standard_normal(stretch.size),
        stress=clean + (sd or 0.0) * rng.standard_normal(stretch.size),
        stress_sd=sd,
        stretch_sd=stretch_sd,
        time=time,
    )


def ramps(top: float, count: int, points: int = 40) -> Array:
    """Stretch of `count` ramps, alternately loading and unloading."""
    there = np.linspace(1.0, top, points)
    return np.concatenate([there if k % 2 == 0 else there[-2::-1] for k in range(count)])


def coupon_model(
    made: Experiment,
    *,
    without: Sequence[str] = (),
    law: str = "neo-hookean",
    further: bool = False,
    richer: tuple[str, int] | None = None,
) -> HomogeneousModel:
    """Model with the catalogue's effects; those of the second round only if `further`."""
    known = effects_of("homogeneous").items()
    effects = {n: e for n, e in known if n not in without and (further or not e.further)}
    return HomogeneousModel(made, effects=effects, law=law, richer=richer)  # type: ignore[arg-type]
