"""A synthetic homogeneous material test: protocol, hidden causes and measured stress.

The stress is the derivative of an energy of the principal stretches, computed by a complex step. The path
l(s) of a test is incompressible; the nominal stress on a driven face is dW/ds divided by the number of driven
axes.

Signs: strain-offset is true minus recorded strain; machine-compliance is recorded minus true strain per Pa;
rate-dependence is the relative change of the stress per decade of rate, at 0.01 1/s.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.records import truth_of

Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating]
TINY = 1e-30


@dataclass(frozen=True, kw_only=True)
class Solid:
    """An incompressible solid of shear modulus G [Pa] at rest, without fibres.

    Attributes
    ----------
    stiffening : a in the additional energy G/2 a (I1 - 3)^2.
    second : fraction of G in the term with I2.
    locking : 1/N, with N links per chain of the eight-chain model (0: Gaussian chains).
    fibre : k in the additional energy G k/8 (I4 - 1)^2 along axis 1.
    """

    G: float
    stiffening: float = 0.0
    second: float = 0.0
    locking: float = 0.0
    fibre: float = 0.0

    def stress(self, mode: str, s: Array) -> Array:
        """Nominal stress [Pa] at the driven stretch s (simple shear: s = 1 + gamma)."""
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
    """2 W/G of eight Langevin chains with 1/inverse links and modulus G at rest; Gaussian chains: I1 - 3."""
    if inverse == 0.0:
        return i1 - 3.0
    at_rest = _chain_energy(np.array([inverse**0.5 + 0j]))[0]
    force = _chain_tension(np.array([inverse**0.5 + 0j]))[0]
    slope_at_rest = force * inverse**0.5 / 6.0  # d energy / d I1 where I1 is 3: x is (inverse I1 / 3)^(1/2)
    return (_chain_energy(np.sqrt(i1 * inverse / 3.0)) - at_rest) / slope_at_rest


def _chain_energy(x: Complex) -> Complex:
    """Energy per link of a Langevin chain over kT, at the fraction x of its length (Kuhn and Gruen, 1942)."""
    b = _chain_tension(x)
    # ln(b / sinh b), which does not overflow for long b
    return x * b + np.log(2.0 * b) - b - np.log(1.0 - np.exp(-2.0 * b))


def _chain_tension(x: Complex) -> Complex:
    """Solution b of coth b - 1/b = x by Newton's method, which increases monotonically from 3 x."""
    b = 3.0 * x
    for _ in range(100):
        coth = (1.0 + np.exp(-2.0 * b)) / (1.0 - np.exp(-2.0 * b))
        step = (coth - 1.0 / b - x) / (1.0 - coth**2 + 1.0 / b**2)
        b = b - step
        if np.abs(step / b).max(initial=0.0) < 1e-12:
            return b
    raise RuntimeError("no tension of a Langevin chain")


def inverse_of(measured: Callable[[Array], Array], wanted: Array) -> Array:
    """True stretches s with measured(s) = wanted, by fixed-point iteration.

    RuntimeError if it does not converge.
    """
    s = wanted.copy()
    for _ in range(200):
        change = wanted - measured(s)
        s = s + 0.7 * change
        if np.abs(change).max() < 1e-12:
            return s
    raise RuntimeError("no true stretch for what the rig shows")


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
# causes that a diagnosis tries only if no other explains the data; never drawn, requested by name
FURTHER = ("tension-compression-asymmetry", "permanent-set", "gauge-length")
OUTSIDE = ("cell-drift", "slip", "wrong-area", "cell-saturates", "wavy-gauge")
# largest amplitudes in a lab, in SI
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
    "tension-compression-asymmetry": 2.0,
    "permanent-set": 0.3,
    "gauge-length": 0.4,
    "cell-drift": 0.4,
    "slip": 0.3,
    "wrong-area": 0.25,
    "cell-saturates": 0.5,
    "wavy-gauge": 0.05,
}


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """One trial: driven from rest to `top` and back, as `turns` + 1 ramps at `rate` [1/s].

    Attributes
    ----------
    points : number of points of a ramp.
    G : shear modulus [Pa].
    stress_sd, stretch_sd : standard deviations of the stress [Pa] and of the stretch.
    before : farthest stretch of the same specimen in this mode in earlier trials.
    """

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
    before: float = 1.0

    def again(self, name: str) -> Protocol | None:
        """Advised test of this name with the same specimen; None if the name is not a test of coupons."""
        made = replace(self, id=f"{self.id}-{name}", before=self.top if self.specimen else 1.0)
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
        made = replace(made, before=1.0)
        tops = np.linspace(1.0, 0.3, 2000) if name == "press" else np.linspace(1.0, 6.0, 6000)
        new = [replace(made, mode=mode, top=float(t), turns=0) for t in tops]
        reach = first_invariant(self)
        return min(new, key=lambda p: abs(first_invariant(p) - reach))

    def path(self) -> tuple[Array, Array, NDArray[np.int64]]:
        """Recorded stretch without noise, time [s], and number of the ramp (odd: unloading)."""
        there = np.linspace(1.0, self.top, self.points)
        ramps = [there if k % 2 == 0 else there[::-1] for k in range(self.turns + 1)]
        stretch = np.concatenate([r if k == 0 else r[1:] for k, r in enumerate(ramps)])
        ramp = np.concatenate([np.full(len(r) - (k > 0), k) for k, r in enumerate(ramps)])
        time = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(stretch)))]) / self.rate
        return stretch, time, ramp


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A cause in the trials of `where` (a trial, a material or "all"); amplitude in SI.

    `shape` is a parameter besides the amplitude (the roundness of a loop, a period).
    """

    name: str
    amplitude: float
    where: str = "all"
    shape: float = 1.0
    sigma: float = 0.0

    def hits(self, p: Protocol) -> bool:
        return self.where in ("all", p.id, p.material)


@dataclass(frozen=True, kw_only=True)
class Case:
    """A case; kind: "clean", "one", "two", "three" or "outside"."""

    seed: int
    kind: str
    protocols: tuple[Protocol, ...]
    hidden: tuple[Hidden, ...] = ()
    moduli: dict[str, float] = field(default_factory=dict)

    def truth(self) -> dict[str, Any]:
        return truth_of(self.seed, self.kind, self.hidden, self.moduli)


def first_invariant(p: Protocol) -> float:
    s = p.top
    return {
        "uniaxial": s**2 + 2 / s,
        "equibiaxial": 2 * s**2 + s**-4,
        "planar": 1 + s**2 + s**-2,
        "simple-shear": 3 + (s - 1) ** 2,
    }[p.mode]


CHAINS = 0.56  # largest squared ratio of chain length to contour length: (3/4)^2
REFERENCE_RATE = 0.01  # [1/s]


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
    top_energy, worn_energy = solid.energy(p.mode, np.array([p.top, p.before]))
    # a specimen remembers earlier trials: its first ramp here is virgin only beyond them
    peak = np.where(ramp >= 1, max(top_energy, worn_energy), worn_energy)
    virgin = peak <= 1e-9 * top_energy

    def stress(true: Array) -> Array:
        found = solid.stress(p.mode, true)
        energy = solid.energy(p.mode, true)
        left = np.clip(1.0 - energy / top_energy, 0.0, 1.0)
        if "hysteresis" in a:
            lost = 1.0 - (1.0 - left) ** shape["hysteresis"]
            found = found * np.where(ramp % 2 == 1, 1.0 - a["hysteresis"] * lost, 1.0)
        if "mullins" in a:
            unused = np.clip(1.0 - energy / np.where(virgin, top_energy, peak), 0.0, 1.0)
            worn = [math.erf(x / shape["mullins"]) / math.erf(1.0 / shape["mullins"]) for x in unused]
            found = found * np.where(virgin, 1.0, 1.0 - a["mullins"] * np.array(worn))
        if "rate-dependence" in a:
            # a power of the rate, whose slope per decade at the reference is the amplitude
            found = found * (p.rate / REFERENCE_RATE) ** (a["rate-dependence"] / math.log(10.0))
        if "tension-compression-asymmetry" in a and p.mode == "uniaxial":
            found = np.where(true < 1.0, 1.0 + a["tension-compression-asymmetry"], 1.0) * found
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
    if "permanent-set" in a:  # back at zero stress before it is back at its length
        kept = a["permanent-set"]  # of the largest strain
        true = np.where(ramp >= 1, true - kept / (1.0 - kept) * (p.top - true), true)
    if "gauge-length" in a and p.mode == "uniaxial" and p.top > 1.0:
        true = 1.0 + (1.0 + a["gauge-length"]) * (true - 1.0)
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
    """Standard deviation of the stress of each point [Pa], as the lab states it."""
    recorded, _, _ = p.path()
    solid = Solid(G=p.G)
    slope = (solid.stress(p.mode, recorded + 1e-6) - solid.stress(p.mode, recorded - 1e-6)) / 2e-6
    return np.asarray(np.hypot(p.stress_sd, slope * p.stretch_sd))


def until_it_locks(p: Protocol, hidden: tuple[Hidden, ...]) -> Protocol:
    """The same test, to at most 3/4 of the chains' contour length, since a lab stops at the steep rise."""
    inverse = sum(h.amplitude for h in hidden if h.name == "limited-extensibility" and h.hits(p))
    while first_invariant(p) * inverse / 3.0 > CHAINS:
        p = replace(p, top=1.0 + 0.95 * (p.top - 1.0))
    return p
