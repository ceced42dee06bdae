"""A synthetic indentation: protocol, hidden causes and measured force.

Forces come from a table of an axisymmetric FEM, `forces.json`, computed by `make_table.py`; most causes act
on these forces, some have tables of their own.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from benchmarks.blind.records import truth_of

Array = NDArray[np.float64]

# causes with tables of their own, at the simulated sizes
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
# largest amplitudes in a lab, in SI
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
    """One indentation, starting at the surface, depth 0.

    Attributes
    ----------
    base : geometry, of `BASES`.
    G : shear modulus [Pa].
    strokes : target depth [m], speed [m/s] and hold [s] of each stroke.
    samples : points of a stroke; a hold has half as many.
    force_sd, depth_sd : standard deviations of force [N] and depth [m].
    touch : error of the depth of first contact [m].
    """

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
        """Time [s], depth [m] and number of the stroke (a hold belongs to the stroke before it)."""
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
    """A cause in the trials of `where` (a trial, a material, a geometry or "all"); amplitude in SI.

    `shape` is a parameter besides the amplitude (a relaxation time, 0 for several); `table` is the suffix of
    the tabled geometry.
    """

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
    """A case; kind: "clean", "one", "two", "three", "trap" (the cause cannot be detected) or "outside"."""

    seed: int
    kind: str
    trials: tuple[Trial, ...]
    hidden: tuple[Hidden, ...] = ()
    moduli: dict[str, float] = field(default_factory=dict)

    def truth(self) -> dict[str, Any]:
        return truth_of(self.seed, self.kind, self.hidden, self.moduli)


TABLE = Path(__file__).with_name("forces.json")


@lru_cache(maxsize=1)
def table() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(TABLE.read_text())
    return found


@lru_cache(maxsize=256)
def _curve(name: str, way: str) -> PchipInterpolator:
    """Interpolant of (force/G)^(1/p) [m2 to the power 1/p] over depth [m]; way: "in" or "out".

    p is 1.5 for a hemisphere, else 1.
    """
    entry = table()[name]
    depth, force = np.array(entry["depth"]), np.array(entry["in"])
    if way == "out" and len(entry["out"]):
        force = force.copy()
        out = np.array(entry["out"])
        # a list that ends early lacks its shallow end: the rod separated, or Newton's method failed; loading
        # forces are used there
        force[len(force) - 1 - len(out) : len(force) - 1] = out
    force = force * np.array(table()[name.split(" ")[0]]["rigid"])[: len(force)]
    power = 1.5 if entry["setup"]["tip"] == "hemisphere" else 1.0
    return PchipInterpolator(
        np.r_[0.0, 1e-3 * depth], np.r_[0.0, (1e-6 * np.maximum(force, 0)) ** (1 / power)]
    )


def elastic(t: Trial, depth: Array, stroke: NDArray[np.int64], ending: str = "") -> Array:
    """Force [N] at depths [m] of the trial's geometry, or of its variant with the name suffix `ending`."""
    name = t.base + ending
    power = 1.5 if table()[t.base]["setup"]["tip"] == "hemisphere" else 1.0
    there = _curve(name, "in")
    top = float(there.x[-1])
    back = _curve(name, "out")
    x = np.clip(depth, 0.0, top)
    steep = max(float(there.derivative()(top)), 0.0)
    # the ratio of unloading to loading force (sliding) is tabled for reversal at the largest depth; it is
    # applied at the same fraction of the depth at which this trial reverses
    part = top * np.clip(depth / max(float(depth.max()), 1e-9), 1e-6, 1.0)
    root = there(x) * np.where(stroke % 2 == 1, back(part) / there(part), 1.0)
    root = root + steep * np.maximum(depth - top, 0.0)
    return np.asarray(t.G * np.maximum(root, 0.0) ** power)


def force(t: Trial, hidden: tuple[Hidden, ...]) -> Array:
    """Force along the indenter [N] as measured, without noise."""
    mine = {h.name: h for h in hidden if h.hits(t)}
    time, depth, stroke = t.path()
    radius = 1e-3 * table()[t.base]["setup"]["rod"]
    true = depth + t.touch
    if "depth-offset" in mine:
        true = true + mine["depth-offset"].amplitude
    if "backlash" in mine:  # the drive reverses before the indenter does
        true = true + mine["backlash"].amplitude * (stroke % 2 == 1) * (depth > 0)
    if "screw" in mine:
        true = true + mine["screw"].amplitude * np.sin(2 * np.pi * depth / 1e-3)
    found = elastic(t, true, stroke)
    for name in TABLED:
        if name in mine:
            found = elastic(t, true, stroke, mine[name].table)
    if "inclusion-debonded" in mine:
        part = mine["inclusion-debonded"].amplitude
        found = (1 - part) * found + part * elastic(t, true, stroke, " none")
    if "mullins" in mine:
        h = mine["mullins"]
        left = np.clip(1.0 - true / np.maximum.accumulate(np.maximum(true, 1e-9)), 0.0, 1.0)
        worn = np.array([math.erf(v / h.shape) for v in left]) / math.erf(1.0 / h.shape)
        found = found * np.where(stroke >= 1, 1.0 - h.amplitude * worn, 1.0)
    if "relaxation" in mine:
        found = _relaxed(time, found, mine["relaxation"])
    if "adhesion" in mine:
        found = found - mine["adhesion"].amplitude * _pull(true, stroke, radius)
    if "saturation" in mine:
        limit = (1.0 - mine["saturation"].amplitude) * float(found.max())
        found = limit * np.tanh((np.maximum(found, 0) / limit) ** 3) ** (1 / 3)
    if "force-gain" in mine:
        found = (1.0 + mine["force-gain"].amplitude) * found
    if "force-offset" in mine:
        found = found + mine["force-offset"].amplitude
    if "force-drift" in mine:
        found = found + mine["force-drift"].amplitude * time
    return np.asarray(found)


def _relaxed(time: Array, found: Array, h: Hidden) -> Array:
    """Force with Maxwell branches in parallel: one of time `shape`, or four over three decades."""
    taus = [h.shape] if h.shape else [0.3, 3.0, 30.0, 300.0]
    total = found * (1.0 - h.amplitude)
    for tau in taus:
        q = np.zeros_like(found)
        for k in range(1, len(found)):
            dt = time[k] - time[k - 1]
            decay = math.exp(-dt / tau)
            q[k] = q[k - 1] * decay + (found[k] - found[k - 1]) * (1 - decay) * tau / dt
        total = total + h.amplitude / len(taus) * q
    return np.maximum(total, 0.0)


def _pull(depth: Array, stroke: NDArray[np.int64], radius: float) -> Array:
    back = np.maximum.accumulate(depth) - depth
    grown = 1.0 - np.exp(-back / (0.06 * float(depth.max())))
    lift = np.clip(1.0 + np.minimum(depth, 0.0) / (0.2 * radius), 0.0, 1.0)
    return np.asarray((stroke % 2 == 1) * grown * lift)
