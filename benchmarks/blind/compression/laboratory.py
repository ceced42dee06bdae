"""Compression, as the controls ask for it: cylinders of two materials, closed forms and FElupe's table.

Causes act on the nominal stress over the shear modulus, of the strain (positive in compression). They are
sized against noise of 0.2 to 0.6 % of the largest stress, a modulus a material projected out.
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

# the largest that a lab meets: parts of what platens hold, of the stress, strains, strains at a stress of the
# soft cylinder's shear modulus (one machine presses both: the hard one makes it yield more)
INSIDE = {
    "platen-bonding": 1.0,
    "strain-offset": 0.03,
    "machine-compliance": 0.02,
    "second-invariant": 0.6,
    "strain-stiffening": 0.5,
    "hysteresis": 0.4,
}
OUTSIDE = {"kink": 0.1, "cell-saturates": 0.5, "wavy-gauge": 0.05}
NEAR = (0.8, 1.25)  # of the size that is asked of a cause


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A cause in all tests; shape: of what is not settled by its name (where a kink is, a period)."""

    name: str
    amplitude: float
    shape: float = 0.0
    sigma: float = 0.0
    where: str = "all"


@dataclass(frozen=True, kw_only=True)
class Case:
    """A cylinder of each material, pressed `count` ramps (every other one back)."""

    seed: int
    count: int
    noise: float
    hidden: tuple[Hidden, ...] = ()

    @property
    def strain(self) -> Array:
        return ramps(self.count)


def stress(case: Case, hidden: Sequence[Hidden], material: str = "soft") -> Array:
    """Of one cylinder over its shear modulus, negative in compression."""
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
    """Of both cylinders, over their noise."""
    return np.concatenate(
        [
            stress(case, hidden, m) / (case.noise * float(np.abs(stress(case, case.hidden, m)).max()))
            for m in SHEAR_MODULI
        ]
    )


def free_of(case: Case) -> Array:
    """A modulus a material."""
    count, base = len(SHEAR_MODULI), whitened(case, ())
    return np.asarray(np.repeat(np.eye(count), len(case.strain), axis=0) * base[:, None])


def sigmas(case: Case, hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size in standard deviations, a modulus a material projected out."""
    z = whitened(case, (*others, hidden)) - whitened(case, others)
    return float(np.sqrt(left(free_of(case), z)))


def hide(case: Case, name: str, size: float) -> Hidden:
    """A cause of that size, or the largest that a lab meets."""
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
    """A case with these causes, each nearly as large as asked, and seen beside the others."""
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
    """The experiment's folder."""
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
