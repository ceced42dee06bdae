"""Cases of compressed cylinders: closed forms for free platens, and FElupe's table for bonded ones.

Stresses are nominal and divided by the shear modulus, negative in compression; `bonded.json` holds those of a
bonded cylinder of 50 x 30 mm, computed by `make_table.py`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.blind.records import write_yaml

Array = NDArray[np.float64]
Stress = Callable[[Array], Array]  # over the shear modulus, of the strain (positive in compression)

SHEAR_MODULI = {"soft": 1.3e4, "hard": 3.7e4}  # [Pa]
TABLE = Path(__file__).with_name("bonded.json")
LARGEST = 0.45  # strain
RATE = 0.005  # [1/s]


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """Measured data of one test.

    Attributes
    ----------
    id, material : str
    strain : array, shape (k,)
        Positive in compression.
    stress : array, shape (k,)
        Nominal stress with its noise [Pa], negative in compression.
    stress_sd : float
        Standard deviation of the noise [Pa].
    """

    id: str
    material: str
    strain: Array
    stress: Array
    stress_sd: float


def free(strain: Array) -> Array:
    """Stress of an incompressible neo-Hookean cylinder between platens without friction."""
    s = 1.0 - strain
    return s - s**-2


@cache
def bonded(law: str = "neo-hookean") -> Stress:
    """Stress of FElupe's cylinder of 50 x 30 mm with end faces bonded to the platens."""
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    curve = CubicSpline([0.0, *table["strains"]], [0.0, *table["stress_over_shear_modulus"][law]])
    return lambda strain: np.asarray(curve(strain))


def ramps(count: int, largest: float = LARGEST, points: int = 70) -> Array:
    """Strain over `count` ramps, alternately loading and unloading."""
    there = np.linspace(0.0, largest, points)
    return np.concatenate([there if k % 2 == 0 else there[-2::-1] for k in range(count)])


def measured(
    name: str, stress: Array, *, strain: Array, material: str = "soft", seed: int, noise: float
) -> Record:
    """Record with noise.

    `stress` is over the shear modulus, `noise` is its standard deviation over the largest stress.
    """
    clean = SHEAR_MODULI[material] * stress
    sd = noise * float(np.abs(clean).max())
    noisy = clean + sd * np.random.default_rng(seed).standard_normal(strain.size)
    return Record(id=name, material=material, strain=strain, stress=noisy, stress_sd=sd)


def one_each(stress: Stress, *, strain: Array | None = None, seed: int, noise: float) -> tuple[Record, ...]:
    """Records of one cylinder of each material."""
    x = ramps(1) if strain is None else strain
    return tuple(
        measured(f"{m}-1", stress(x), strain=x, material=m, seed=seed + k, noise=noise)
        for k, m in enumerate(SHEAR_MODULI)
    )


def _clean(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    strain = ramps(int(rng.integers(1, 4)))
    return one_each(free, strain=strain, seed=seed, noise=float(rng.uniform(0.001, 0.006)))


def _repeats(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    strain = ramps(1)
    scatter = [0.01 * a + 0.01 * b * (4 * strain - 1) for a, b in rng.standard_normal((5, 2))]
    return tuple(
        measured(f"A{k}", free(strain) * np.exp(x), strain=strain, seed=seed + k, noise=0.002)
        for k, x in enumerate(scatter)
    )


def _tested_again(
    seed: int, strain_of: Callable[[Array, int], Array], factor_of: Callable[[int], float]
) -> tuple[Record, ...]:
    """Five tests of one bonded cylinder with a scatter of about a tenth of a percent.

    By the number of the test, `strain_of` gives the strain of the cylinder and `factor_of` the factor of its
    stress.
    """
    rng = np.random.default_rng(seed)
    strain = ramps(1)
    found = []
    for k in range(5):
        a, b = rng.standard_normal(2)
        stress = bonded()(strain_of(strain, k)) * factor_of(k)
        scatter = np.exp(0.001 * a + 0.001 * b * (4.0 * strain - 1.0))
        found.append(measured(f"A{k}", stress * scatter, strain=strain, seed=seed + k, noise=0.0002))
    return tuple(found)


def _set(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    lost = float(rng.uniform(0.003, 0.006))  # fraction of the height per test
    return _tested_again(seed, lambda strain, k: strain / (1.0 - lost * k), lambda _: 1.0)


def _order(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    grown = float(rng.uniform(0.006, 0.012))  # fraction of the stress per test
    return _tested_again(seed, lambda strain, _: strain, lambda k: 1.0 + grown * k)


def _bonded(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    return one_each(bonded(), seed=seed, noise=float(rng.uniform(0.001, 0.006)))


def _mooney(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    return one_each(bonded("mooney-rivlin 0.3"), seed=seed, noise=float(rng.uniform(0.001, 0.006)))


def _kink(seed: int, rng: np.random.Generator) -> tuple[Record, ...]:
    at, by = rng.uniform(0.08, 0.4), rng.uniform(0.02, 0.06)
    return one_each(lambda strain: free(strain) * (1.0 - by * (strain > at)), seed=seed, noise=0.002)


KINDS: dict[str, tuple[str, Callable[[int, np.random.Generator], tuple[Record, ...]]]] = {
    "clean": ("nothing hidden, one to three ramps", _clean),
    "repeats": ("five tests that differ smoothly by a percent, and by nothing else", _repeats),
    "bonded": ("bonded platens", _bonded),
    "mooney": ("bonded platens, and a second invariant", _mooney),
    "set": ("bonded platens; each test begins with 0.3 to 0.6 % more set", _set),
    "order": ("bonded platens; each test is 0.6 to 1.2 % stiffer than the one before", _order),
    "kink": ("a drop by 2 to 6 % somewhere, outside the library", _kink),
}


def draw(kind: str, number: int) -> tuple[Record, ...]:
    """Records of a case, seeded by `number`."""
    return KINDS[kind][1](100 * number, np.random.default_rng(1000 + number))


def write(records: tuple[Record, ...], folder: Path, name: str = "compression") -> None:
    """Write experiment.yaml and its CSV files, without the truth."""
    (folder / "coupons").mkdir(parents=True)
    trials: list[dict[str, Any]] = []
    for r in records:
        way = np.abs(np.diff(r.strain))
        # between unloading and the next ramp the machine waits for one sampling interval: time must increase
        time = np.concatenate([[0.0], np.cumsum(np.where(way > 0.0, way, way.max()))]) / RATE
        rows = ["stretch,nominal_stress_kPa,time_s"]
        for strain, stress, t in zip(r.strain, r.stress, time, strict=True):
            rows.append(f"{1.0 - strain:.10g},{1e-3 * stress:.10g},{t:.7g}")
        (folder / "coupons" / f"{r.id}.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        trials.append(
            {
                "id": r.id,
                "kind": "coupon",
                "material": r.material,
                "mode": "uniaxial",
                "record": f"coupons/{r.id}.csv",
                "stress_sd_kPa": 1e-3 * r.stress_sd,
            }
        )
    write_yaml(folder, name, [r.material for r in records], trials)
