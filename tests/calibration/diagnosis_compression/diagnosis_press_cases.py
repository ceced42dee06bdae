"""Compression tests for the tests of their diagnosis: closed forms and FElupe's table, no code of tisim."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence

import numpy as np
from made_experiment import experiment as experiment
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.blind.compression.cases import TABLE as BONDED
from calibration.diagnosis.catalogue import effects_of
from calibration.experiment import CouponTrial, Experiment
from calibration.measurements.compression.curves import Cylinder
from calibration.measurements.compression.model import CompressionModel

Array = NDArray[np.float64]
Stress = Callable[[Array], Array]  # stress over shear modulus, of the strain (positive in compression)

SHEAR = {"soft": 1.3e4, "hard": 3.7e4}
TABLE = json.loads(BONDED.read_text(encoding="utf-8"))
TOP = 0.45  # strain


def sliding(strain: Array) -> Array:
    """Stress over shear modulus of an incompressible Neo-Hookean cylinder between frictionless platens."""
    s = 1.0 - strain
    return s - s**-2


def bonded(law: str = "neo-hookean") -> Stress:
    """Interpolate FElupe's stress of a cylinder of 50 by 30 mm between bonded platens."""
    strains = np.array(TABLE["strains"])
    curve = TABLE["stress_over_shear_modulus"][law]
    spline = CubicSpline([0.0, *strains], [0.0, *curve])
    return lambda strain: np.asarray(spline(strain))


def ramps(count: int, top: float = TOP, points: int = 70) -> Array:
    """Strain of `count` ramps, alternately loading and unloading."""
    there = np.linspace(0.0, top, points)
    return np.concatenate([there if k % 2 == 0 else there[-2::-1] for k in range(count)])


def pressed(
    name: str,
    stress: Stress | Array,
    *,
    strain: Array | None = None,
    material: str = "soft",
    specimen: str | None = None,
    seed: int = 0,
    noise: float = 0.003,
) -> CouponTrial:
    """Synthetic compression test.

    `stress` is a function of the strain, or values at the strains, over the shear modulus. `noise` is the
    standard deviation over the largest stress.
    """
    rng = np.random.default_rng(seed)
    x = ramps(1) if strain is None else strain
    clean = SHEAR[material] * (stress(x) if callable(stress) else stress)
    sd = noise * float(np.abs(clean).max())
    return CouponTrial(
        id=name,
        material=material,
        mode="uniaxial",
        specimen=specimen,
        stretch=1.0 - x,
        stress=clean + sd * rng.standard_normal(x.size),
        stress_sd=sd,
        time=np.cumsum([0.0, *np.abs(np.diff(x))]) / 0.005,
    )


def both(stress: Stress, *, strain: Array | None = None, seed: int = 0, noise: float = 0.003) -> Experiment:
    """Experiment with one cylinder of each material."""
    return experiment(
        *(
            pressed(f"{m}-1", stress, strain=strain, material=m, seed=seed + k, noise=noise)
            for k, m in enumerate(SHEAR)
        )
    )


def press_model(
    made: Experiment, *, without: Sequence[str] = (), cylinder: Cylinder | None = None
) -> CompressionModel:
    """Model with the catalogue's effects of the first round."""
    known = effects_of("compression").items()
    effects = {n: e for n, e in known if n not in without and not e.further}
    return CompressionModel(made, effects=effects, cylinder=cylinder)  # type: ignore[arg-type]
