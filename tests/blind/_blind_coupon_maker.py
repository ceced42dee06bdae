"""Made coupon experiments with a hidden cause, or none: drawn from a seed at test time, the truth apart.

Nothing here comes from `tisim` or `calibration`; measured/FORMAT.md is all that both sides know.
Signs: strain-offset is true less recorded strain; machine-compliance strain per Pa of recorded less true;
rate-dependence is the part of the stress a decade of rate, from 0.01 per second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from _blind_coupon_law import Solid, inverse_of
from numpy.typing import NDArray

Array = NDArray[np.float64]

LIBRARY = (
    "rate-dependence",
    "hysteresis",
    "mullins",
    "anisotropy",
    "strain-offset",
    "machine-compliance",
    "platen-friction",
    "strain-stiffening",
    "second-invariant",
    "limited-extensibility",
)
OUTSIDE = ("cell-drift", "slip", "wrong-area", "cell-saturates", "wavy-gauge")
# the largest that a lab meets, in the unit of truth (SI)
LARGEST = {
    "rate-dependence": 0.2,
    "hysteresis": 0.6,
    "mullins": 0.6,
    "anisotropy": 2.0,
    "strain-offset": 0.04,
    "machine-compliance": 5e-6,
    "platen-friction": 0.4,
    "strain-stiffening": 0.3,
    "second-invariant": 0.6,
    "limited-extensibility": 0.5,
    "cell-drift": 0.4,
    "slip": 0.3,
    "wrong-area": 0.25,
    "cell-saturates": 0.5,
    "wavy-gauge": 0.05,
}
CHAINS = 0.56  # largest squared length of chains, over their contour length: 3/4 of it
REFERENCE_RATE = 0.01  # [1/s]


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """One trial: driven from rest to `top` and back `turns` times at `rate` [1/s]; points a ramp."""

    id: str
    material: str
    specimen: str | None
    mode: str
    top: float
    turns: int
    rate: float
    points: int
    G: float
    stress_sd: float = 0.0
    stretch_sd: float = 0.0

    def again(self, name: str) -> Protocol | None:
        """The same specimen in the test of this name that a diagnosis advises; None where the name is no
        test, or says nothing new of this one."""
        made = replace(self, id=f"{self.id}-{name}")
        beyond = {"further": 1.5, "twice": 2.25, "to-the-end": 4.0}.get(name)
        if beyond:
            top = 1.0 + beyond * (self.top - 1.0) if self.top > 1.0 else self.top**beyond
            return replace(made, top=top, turns=0)
        if name in ("unload", "second-cycle"):
            return replace(made, turns=1 if name == "unload" else 3)
        if name == "faster":
            return replace(made, rate=10.0 * self.rate, turns=0)
        mode = {"pull": "uniaxial", "press": "uniaxial", "shear": "simple-shear"}.get(name, name)
        if mode not in ("uniaxial", "simple-shear", "planar", "equibiaxial"):
            return None
        tops = np.linspace(1.0, 0.3, 2000) if name == "press" else np.linspace(1.0, 6.0, 6000)
        new = [replace(made, mode=mode, top=float(t), turns=0) for t in tops]
        reach = first_invariant(self)
        return min(new, key=lambda p: abs(first_invariant(p) - reach))

    def path(self) -> tuple[Array, Array, NDArray[np.int64]]:
        """Recorded stretch without noise, time [s], number of the ramp (odd: back)."""
        there = np.linspace(1.0, self.top, self.points)
        ramps = [there if k % 2 == 0 else there[::-1] for k in range(self.turns + 1)]
        stretch = np.concatenate([r if k == 0 else r[1:] for k, r in enumerate(ramps)])
        ramp = np.concatenate([np.full(len(r) - (k > 0), k) for k, r in enumerate(ramps)])
        time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(stretch)))]) / self.rate
        return stretch, time, ramp


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A cause in the trials of `where` (all where it is "all"); amplitude in SI; shape: of what is not
    settled by its name (a loop's roundness, a period)."""

    name: str
    amplitude: float
    where: str = "all"
    shape: float = 1.0
    sigma: float = 0.0

    def hits(self, p: Protocol) -> bool:
        return self.where in ("all", p.id, p.material)


@dataclass(frozen=True, kw_only=True)
class Case:
    """kind: clean, one, two or outside."""

    seed: int
    kind: str
    protocols: tuple[Protocol, ...]
    hidden: tuple[Hidden, ...] = ()
    moduli: dict[str, float] = field(default_factory=dict)

    def truth(self) -> dict[str, Any]:
        return {
            "seed": self.seed,
            "kind": self.kind,
            "shear_modulus_Pa": self.moduli,
            "effects": [
                {"effect": h.name, "amplitude": h.amplitude, "scope": h.where, "sigma": h.sigma}
                for h in self.hidden
            ],
        }


def curve(p: Protocol, hidden: tuple[Hidden, ...]) -> Array:
    """Nominal stress [Pa] at the recorded stretches, without noise."""
    mine = [h for h in hidden if h.hits(p)]
    a = {h.name: h.amplitude for h in mine}
    shape = {h.name: h.shape for h in mine}
    solid = Solid(
        G=p.G,
        stiffening=a.get("strain-stiffening", 0.0),
        second=a.get("second-invariant", 0.0),
        locking=a.get("limited-extensibility", 0.0),
        fibre=a.get("anisotropy", 0.0),
    )
    recorded, time, ramp = p.path()
    top_energy = float(solid.energy(p.mode, np.array([p.top]))[0])

    def stress(true: Array) -> Array:
        found = solid.stress(p.mode, true)
        left = np.clip(1.0 - solid.energy(p.mode, true) / top_energy, 0.0, 1.0)
        if "hysteresis" in a:
            lost = 1.0 - (1.0 - left) ** shape["hysteresis"]
            found = found * np.where(ramp % 2 == 1, 1.0 - a["hysteresis"] * lost, 1.0)
        if "mullins" in a:
            worn = np.array([math.erf(x / shape["mullins"]) for x in left]) / math.erf(1.0 / shape["mullins"])
            found = found * np.where(ramp >= 1, 1.0 - a["mullins"] * worn, 1.0)
        if "rate-dependence" in a:
            # a power of the rate, whose slope a decade at the reference is the amplitude
            found = found * (p.rate / REFERENCE_RATE) ** (a["rate-dependence"] / math.log(10.0))
        if "platen-friction" in a and p.mode == "uniaxial" and p.top < 1.0:
            # Coulomb friction under a cylinder: the pressure grows exponentially inwards
            x = 3.0 * a["platen-friction"] * true**-1.5
            found = found * 2.0 * (np.exp(x) - 1.0 - x) / x**2
        return np.asarray(found)

    offset, soft = a.get("strain-offset", 0.0), a.get("machine-compliance", 0.0)
    slipped = a.get("slip", 0.0) * (p.top - 1.0) * (np.arange(len(ramp)) >= shape.get("slip", 1.0) * p.points)
    waves = a.get("wavy-gauge", 0.0) * (p.top - 1.0)
    wave = waves * np.sin(2.0 * np.pi * shape.get("wavy-gauge", 1.0) * (recorded - 1.0) / (p.top - 1.0))
    true = recorded + offset - slipped + wave
    if soft:
        true = inverse_of(lambda s: s + soft * stress(s), true)
    found = stress(true)
    largest = float(np.abs(found).max())
    if "wrong-area" in a:
        found = found * (1.0 + a["wrong-area"])
    if "cell-drift" in a:
        found = found + a["cell-drift"] * largest * time / time[-1]
    if "cell-saturates" in a:
        limit = (1.0 - a["cell-saturates"]) * largest
        found = np.sign(found) * limit * np.tanh((np.abs(found) / limit) ** 3) ** (1.0 / 3.0)
    return np.asarray(found)


def errors(p: Protocol) -> Array:
    """Standard deviation of each point's stress as the lab would say [Pa]."""
    recorded, _, _ = p.path()
    solid = Solid(G=p.G)
    slope = (solid.stress(p.mode, recorded + 1e-6) - solid.stress(p.mode, recorded - 1e-6)) / 2e-6
    return np.asarray(np.hypot(p.stress_sd, slope * p.stretch_sd))


def sigmas(case_protocols: tuple[Protocol, ...], hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size of a cause in standard deviations, after projecting out a modulus a specimen."""
    changed: list[Array] = []
    free: dict[str, Array] = {}
    first = 0
    sizes = [len(p.path()[0]) for p in case_protocols]
    for p, size in zip(case_protocols, sizes, strict=True):
        sd = errors(p)
        base = curve(p, others)
        changed.append((curve(p, (*others, hidden)) - base) / sd)
        column = free.setdefault(p.specimen or p.material, np.zeros(sum(sizes)))
        column[first : first + size] = base / sd
        first += size
    q, _ = np.linalg.qr(np.column_stack(list(free.values())))
    z = np.concatenate(changed)
    return float(np.linalg.norm(z - q @ (q.T @ z)))


def sized(protocols: tuple[Protocol, ...], hidden: Hidden, target: float) -> Hidden:
    """The cause with the amplitude that makes it `target` sigmas, or the largest that a lab meets."""
    low, high = 0.0, LARGEST[hidden.name] / hidden.amplitude
    if hidden.name == "limited-extensibility":
        furthest = max(first_invariant(p) for p in protocols if hidden.hits(p))
        high = min(high, CHAINS * 3.0 / furthest / hidden.amplitude)
    if hidden.name == "machine-compliance":
        # the rig takes at most a fifth of the travel
        travel = [
            abs(p.top - 1.0) / float(np.abs(Solid(G=p.G).stress(p.mode, np.array([p.top])))[0])
            for p in protocols
            if hidden.hits(p)
        ]
        high = min(high, 0.2 * min(travel) / hidden.amplitude)
    scaled: Callable[[float], Hidden] = lambda f: replace(hidden, amplitude=f * hidden.amplitude)  # noqa: E731
    if sigmas(protocols, scaled(high)) > target:
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if sigmas(protocols, scaled(middle)) < target else (low, middle)
    found = scaled(high)
    return replace(found, sigma=sigmas(protocols, found))


def until_it_locks(p: Protocol, hidden: tuple[Hidden, ...]) -> Protocol:
    """The same test, to no more than 3/4 of the chains' length: a lab stops where the curve shoots up."""
    inverse = sum(h.amplitude for h in hidden if h.name == "limited-extensibility" and h.hits(p))
    while first_invariant(p) * inverse / 3.0 > CHAINS:
        p = replace(p, top=1.0 + 0.95 * (p.top - 1.0))
    return p


def first_invariant(p: Protocol) -> float:
    s = p.top
    return {
        "uniaxial": s**2 + 2 / s,
        "equibiaxial": 2 * s**2 + s**-4,
        "planar": 1 + s**2 + s**-2,
        "simple-shear": 3 + (s - 1) ** 2,
    }[p.mode]


def write(case: Case, folder: Path) -> None:
    """experiment.yaml and its CSVs, without the truth."""
    rng = np.random.default_rng([case.seed, 1])
    (folder / "coupons").mkdir(parents=True)
    trials = []
    for p in case.protocols:
        recorded, time, _ = p.path()
        # the lab reads the stretch with an error of its own: the stress is that of the true one
        stress = curve(p, case.hidden) + p.stress_sd * rng.standard_normal(len(recorded))
        shown = recorded + p.stretch_sd * rng.standard_normal(len(recorded))
        rows = ["stretch,nominal_stress_kPa,time_s"]
        rows += [f"{s:.7g},{1e-3 * q:.7g},{t:.7g}" for s, q, t in zip(shown, stress, time, strict=True)]
        (folder / "coupons" / f"{p.id}.csv").write_text("\n".join(rows) + "\n")
        trial = {
            "id": p.id,
            "kind": "coupon",
            "material": p.material,
            "mode": p.mode,
            "record": f"coupons/{p.id}.csv",
            "stretch_sd": p.stretch_sd,
            "stress_sd_kPa": round(1e-3 * p.stress_sd, 9),
        }
        if p.specimen:
            trial["specimen"] = p.specimen
        trials.append(trial)
    materials: dict[str, Any] = {p.material: {} for p in case.protocols}
    content = {"format": 1, "name": f"coupons {case.seed}", "materials": materials, "trials": trials}
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content, sort_keys=False))
