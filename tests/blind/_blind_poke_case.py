"""A made poke experiment: trials, causes that are hidden in them, and what is true.

Nothing here comes from `tisim` or `calibration`; measured/FORMAT.md is all that both sides know.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from _blind_record_case import truth_of
from numpy.typing import NDArray

Array = NDArray[np.float64]

# in tables: these have the sizes that were simulated
TABLED = {
    "friction": (" friction 0", " friction 0.1", " friction 0.25"),
    "thickness": (" height 0.85", " height 1.15"),
    "inclusion-misplaced": (" up -3", " up 3"),
    "skin": (" skin 1",),
}
BASES = ("thick", "thin", "ball", "core")
LIBRARY = (
    "friction",
    "thickness",
    "inclusion-misplaced",
    "inclusion-debonded",
    "depth-offset",
    "force-gain",
    "force-offset",
    "force-drift",
    "relaxation",
    "mullins",
    "adhesion",
)
OUTSIDE = ("skin", "saturation", "backlash", "screw")
# the largest that a lab meets, in SI
LARGEST = {
    "inclusion-debonded": 1.0,
    "depth-offset": 0.6e-3,
    "force-gain": 0.4,
    "force-offset": 0.3,
    "force-drift": 0.02,
    "relaxation": 0.5,
    "mullins": 0.5,
    "adhesion": 0.3,
    "saturation": 0.5,
    "backlash": 0.4e-3,
    "screw": 0.15e-3,
}


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One poke: strokes of (depth to go to [m], speed [m/s], hold there [s]); from the surface, at depth
    0."""

    id: str
    material: str
    base: str
    G: float
    strokes: tuple[tuple[float, float, float], ...]
    samples: int
    force_sd: float
    depth_sd: float
    touch: float = 0.0

    def path(self) -> tuple[Array, Array, NDArray[np.int64]]:
        """Time [s], depth [m] and number of the stroke (holds belong to the stroke before them)."""
        t, d, n, now, at = [np.zeros(1)], [np.zeros(1)], [np.zeros(1, int)], 0.0, 0.0
        for k, (to, speed, hold) in enumerate(self.strokes):
            lasts = abs(to - at) / speed
            part = np.arange(1, self.samples + 1) / self.samples
            t.append(now + lasts * part)
            d.append(at + (to - at) * part)
            n.append(np.full(self.samples, k))
            now, at = now + lasts, to
            if hold > 0.0:
                count = self.samples // 2
                part = (np.arange(1, count + 1) / count) ** 2
                t.append(now + hold * part)
                d.append(np.full(count, at))
                n.append(np.full(count, k))
                now += hold
        return np.concatenate(t), np.concatenate(d), np.concatenate(n)


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A cause in the trials of `where` (all where it is "all"); amplitude in SI; shape: of what is not
    settled by its name (a relaxation time, 0 for many). table: end of the table's name."""

    name: str
    amplitude: float = 0.0
    where: str = "all"
    shape: float = 0.0
    table: str = ""
    sigma: float = 0.0

    def hits(self, t: Trial) -> bool:
        return self.where in ("all", t.id, t.material, t.base)


@dataclass(frozen=True, kw_only=True)
class Case:
    """kind: clean, one, two, trap (nothing can be seen) or outside."""

    seed: int
    kind: str
    trials: tuple[Trial, ...]
    hidden: tuple[Hidden, ...] = ()
    moduli: dict[str, float] = field(default_factory=dict)

    def truth(self) -> dict[str, Any]:
        return truth_of(self.seed, self.kind, self.hidden, self.moduli)
