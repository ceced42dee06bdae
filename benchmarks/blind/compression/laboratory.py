"""Compression for the controls: cylinders of two materials, from closed forms and FElupe's table.

Causes act on the nominal stress over the shear modulus as a function of the strain (positive in compression).
They are scaled relative to noise of 0.2 to 0.6 % of the largest stress, with one modulus per material
projected out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.compression.cases import SHEAR_MODULI, bonded, free, measured, ramps, write
from benchmarks.blind.coupons.model import Solid, inverse_of
from benchmarks.blind.laboratory import Laboratory, left, smooth_error_of_records
from benchmarks.blind.records import apart, reaching
from benchmarks.blind.under_test import diagnose_compression

Array = NDArray[np.float64]

# largest amplitudes in a lab: fractions of bonding and of the stress, strains, strains at a stress of the
# soft cylinder's shear modulus (one machine compresses both: the hard one deflects it more)
INSIDE = {
    "platen-bonding": 1.0,
    "strain-offset": 0.03,
    "machine-compliance": 0.02,
    "second-invariant": 0.6,
    "strain-stiffening": 0.5,
    "hysteresis": 0.4,
}
OUTSIDE = {"kink": 0.1, "cell-saturates": 0.5, "wavy-gauge": 0.05}
NEAR = (0.8, 1.25)  # size of a cause relative to the requested one


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A cause in all tests; shape: a parameter besides the amplitude (strain of a kink, a period)."""

    name: str
    amplitude: float
    shape: float = 0.0
    sigma: float = 0.0
    where: str = "all"


@dataclass(frozen=True, kw_only=True)
class Case:
    """One cylinder of each material, loaded over `count` ramps (every other one unloading)."""

    seed: int
    count: int
    noise: float
    hidden: tuple[Hidden, ...] = ()

    @property
    def strain(self) -> Array:
        return ramps(self.count)


def stress(case: Case, hidden: Sequence[Hidden], material: str = "soft") -> Array:
    """Nominal stress of one cylinder over its shear modulus, negative in compression."""
    a = {h.name: h.amplitude for h in hidden}
    shape = {h.name: h.shape for h in hidden}
    strain = case.strain
    solid = Solid(G=1.0, second=a.get("second-invariant", 0.0), stiffening=a.get("strain-stiffening", 0.0))
    back = np.r_[False, np.diff(strain) < 0.0]

    def at(true: Array) -> Array:
        found = solid.stress("uniaxial", 1.0 - true)
        found = found + a.get("platen-bonding", 0.0) * (bonded()(true) - free(true))
        energy = solid.energy("uniaxial", 1.0 - true)
        lost = a.get("hysteresis", 0.0) * np.clip(1.0 - energy / energy.max(), 0.0, 1.0)
        return np.asarray(found * np.where(back, 1.0 - lost, 1.0))

    waves = a.get("wavy-gauge", 0.0) * strain.max()
    true = strain + waves * np.sin(2.0 * np.pi * shape.get("wavy-gauge", 0.0) * strain / strain.max())
    true = true + a.get("strain-offset", 0.0)
    if yields := a.get("machine-compliance", 0.0) * SHEAR_MODULI[material] / SHEAR_MODULI["soft"]:
        true = inverse_of(lambda s: s - yields * at(s), true)
    found = at(true)
    found = found * (1.0 - a.get("kink", 0.0) * (strain > shape.get("kink", 1.0)))
    if "cell-saturates" in a:
        limit = (1.0 - a["cell-saturates"]) * float(np.abs(found).max())
        found = np.sign(found) * limit * np.tanh((np.abs(found) / limit) ** 3) ** (1.0 / 3.0)
    return np.asarray(found)


def whitened(case: Case, hidden: Sequence[Hidden]) -> Array:
    """Stresses of both cylinders over their noise."""
    return np.concatenate(
        [
            stress(case, hidden, m) / (case.noise * float(np.abs(stress(case, case.hidden, m)).max()))
            for m in SHEAR_MODULI
        ]
    )


def free_of(case: Case) -> Array:
    """Columns of one modulus per material, whitened."""
    count, base = len(SHEAR_MODULI), whitened(case, ())
    return np.asarray(np.repeat(np.eye(count), len(case.strain), axis=0) * base[:, None])


def sigmas(case: Case, hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size of a cause in standard deviations, with one modulus per material projected out."""
    z = whitened(case, (*others, hidden)) - whitened(case, others)
    return float(np.sqrt(left(free_of(case), z)))


def hide(case: Case, name: str, size: float) -> Hidden:
    """Cause of the requested size, or at the largest amplitude in a lab."""
    rng = np.random.default_rng([case.seed, 2])
    shape = {"kink": rng.uniform(0.08, 0.35), "wavy-gauge": rng.uniform(1.5, 3.0)}.get(name, 0.0)
    whole = Hidden(name=name, amplitude=1.0, shape=float(shape))

    def scaled(amplitude: float) -> Hidden:
        return replace(whole, amplitude=amplitude)

    largest = {**INSIDE, **OUTSIDE}[name]
    found = scaled(reaching(lambda x: sigmas(case, scaled(x)), size, largest=largest, steps=40))
    return replace(found, sigma=sigmas(case, found))


def clean(seed: int) -> Case:
    rng = np.random.default_rng([seed, 0])
    return Case(seed=seed, count=int(rng.integers(1, 4)), noise=float(rng.uniform(0.002, 0.006)))


def _with(seed: int, size: float, names: Callable[[np.random.Generator], Sequence[str]]) -> Case:
    """A case with these causes, each of about the requested size and detectable beside the others.

    RuntimeError if there is none in 100 draws.
    """
    for number in range(100):
        rng = np.random.default_rng([seed, 1, number])
        wanted = [str(n) for n in names(rng)]
        case = clean(seed)
        if "hysteresis" in wanted:
            case = replace(case, count=max(case.count, 2))
        hidden = tuple(hide(case, n, size) for n in wanted)
        if all(NEAR[0] * size < h.sigma < NEAR[1] * size for h in hidden) and apart(sigmas, case, hidden):
            return replace(case, hidden=hidden)
    raise RuntimeError(f"seed {seed}: no causes of {size} sigmas")


def files(case: Case, folder: Path) -> None:
    """Write the experiment's folder."""
    records = [
        measured(
            f"{m}-1", stress(case, case.hidden, m), strain=case.strain, material=m, seed=case.seed + k,
            noise=case.noise,
        )
        for k, m in enumerate(SHEAR_MODULI)
    ]  # fmt: skip
    write(tuple(records), folder)


LABORATORY = Laboratory(
    clean=clean,
    one=lambda seed, size: _with(seed, size, lambda rng: [rng.choice(list(INSIDE))]),
    half=lambda seed, size: _with(
        seed, size, lambda rng: [rng.choice(list(INSIDE)), rng.choice(list(OUTSIDE))]
    ),
    two=lambda seed, size: _with(seed, size, lambda rng: rng.choice(list(INSIDE), 2, replace=False)),
    write=files,
    hidden=lambda case: case.hidden,
    whitened=whitened,
    free=free_of,
    diagnose=diagnose_compression,
    smooth_error=smooth_error_of_records(measured=1, stated="stress_sd_kPa"),
)
