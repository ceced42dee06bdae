"""A made coupon experiment: trials, causes that are hidden in them, and what is true.

Nothing here comes from `tisim` or `calibration`; measured/FORMAT.md is all that both sides know.
Signs: strain-offset is true less recorded strain; machine-compliance strain per Pa of recorded less true;
rate-dependence is the part of the stress a decade of rate, from 0.01 per second.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from _blind_record_case import truth_of
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


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """One trial: driven from rest to `top` and back `turns` times at `rate` [1/s]; points a ramp.

    before: the farthest stretch of this mode that the same piece saw in trials before.
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
        """The same specimen in the test of this name that a diagnosis advises; None where the name is no
        test, or says nothing new of this one."""
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
        return truth_of(self.seed, self.kind, self.hidden, self.moduli)


def first_invariant(p: Protocol) -> float:
    s = p.top
    return {
        "uniaxial": s**2 + 2 / s,
        "equibiaxial": 2 * s**2 + s**-4,
        "planar": 1 + s**2 + s**-2,
        "simple-shear": 3 + (s - 1) ** 2,
    }[p.mode]
