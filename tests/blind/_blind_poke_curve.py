"""What the load cell of a made poke shows: forces from a table of an axisymmetric FEM, and causes in them.

The table is `blind_pokes.json`, made by `make_poke_table.py`.
"""

from __future__ import annotations

import json
import math
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from _blind_poke_case import TABLED, Hidden, Trial
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

Array = NDArray[np.float64]
TABLE = Path(__file__).with_name("blind_pokes.json")


@lru_cache(maxsize=1)
def table() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(TABLE.read_text())
    return found


@lru_cache(maxsize=256)
def _curve(name: str, way: str) -> PchipInterpolator:
    """Force over G [m2], to the power 1/p, of depth [m]; way "in" or "out"."""
    entry = table()[name]
    depth, force = np.array(entry["depth"]), np.array(entry["in"])
    if way == "out" and len(entry["out"]):
        force = force.copy()
        out = np.array(entry["out"])
        # a list that ends early misses its shallow end: the rod has left, or Newton has; taken as on the way
        # in
        force[len(force) - 1 - len(out) : len(force) - 1] = out
    force = force * np.array(table()[name.split(" ")[0]]["rigid"])[: len(force)]
    power = 1.5 if entry["setup"]["tip"] == "hemisphere" else 1.0
    return PchipInterpolator(
        np.r_[0.0, 1e-3 * depth], np.r_[0.0, (1e-6 * np.maximum(force, 0)) ** (1 / power)]
    )


def elastic(t: Trial, depth: Array, stroke: NDArray[np.int64], ending: str = "") -> Array:
    """Force [N] of the trial's geometry, or of one with a cause (ending of its name), at depths [m]."""
    name = t.base + ending
    power = 1.5 if table()[t.base]["setup"]["tip"] == "hemisphere" else 1.0
    there = _curve(name, "in")
    top = float(there.x[-1])
    back = _curve(name, "out")
    x = np.clip(depth, 0.0, top)
    steep = max(float(there.derivative()(top)), 0.0)
    # what sliding takes from the force on the way back was tabled for a turn at its end: the same part
    # of it is taken at the same part of the way from another
    part = top * np.clip(depth / max(float(depth.max()), 1e-9), 1e-6, 1.0)
    root = there(x) * np.where(stroke % 2 == 1, back(part) / there(part), 1.0)
    root = root + steep * np.maximum(depth - top, 0.0)
    return np.asarray(t.G * np.maximum(root, 0.0) ** power)


def force(t: Trial, hidden: tuple[Hidden, ...]) -> Array:
    """Force along the rod [N] as the load cell shows it, without noise."""
    mine = {h.name: h for h in hidden if h.hits(t)}
    time, depth, stroke = t.path()
    radius = 1e-3 * table()[t.base]["setup"]["rod"]
    true = depth + t.touch
    if "depth-offset" in mine:
        true = true + mine["depth-offset"].amplitude
    if "backlash" in mine:  # the screw turns before the rod comes back
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
    """Maxwell branches beside a spring, stepped in time: one of time `shape`, or four over three decades."""
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
