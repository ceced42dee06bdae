"""Synthetic indentations of a viscoelastic layer: definitions, and forces stored by `solve_indentation`."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony
from benchmarks.whole import write_whole

Array = NDArray[np.float64]
STORE = Path(__file__).with_name("indentation.json")


@dataclass(frozen=True, kw_only=True)
class Layer:
    """A disc bonded to its base, and the indenter; lengths in m.

    Attributes
    ----------
    height, side : float
        Height and radius of the disc.
    rod, tip : float, str
        Radius of the indenter, and "flat" or "hemisphere".
    fine : float
        Radius of the fine part of the mesh, with `elements` elements.
    friction : float
        Coulomb coefficient.
    penalty : float
        Stiffness of the contact relative to the solver's default.
    bulk_ratio : float
        Bulk modulus over the long-time shear modulus; it does not relax.
    """

    height: float
    side: float
    rod: float
    tip: str
    fine: float
    elements: int = 8
    friction: float = 0.6
    penalty: float = 1.0
    bulk_ratio: float = 300.0


@dataclass(frozen=True, kw_only=True)
class Push:
    """One indentation; the time steps are divided by `finer`."""

    layer: Layer
    prony: Prony
    course: Course
    finer: float = 1.0


LAYERS = {
    "ball": Layer(height=0.020, side=0.050, rod=0.004, tip="hemisphere", fine=0.0025),
    "thick": Layer(height=0.032, side=0.050, rod=0.0025, tip="flat", fine=0.0025),
}
DEEPEST = {"ball": 1.6e-3, "thick": 1.2e-3}  # [m]


def _stiff(layer: Layer) -> Layer:
    """The layer with a nearly rigid contact and a nearly incompressible material."""
    return replace(layer, penalty=8.0, bulk_ratio=3000.0)


_PRONY = Prony(fractions=(0.5, 0.3), times=(0.4, 6.0))
# a sphere of 10 mm radius on a disc of 300 mm: a half-space for contacts of 1.4 mm radius
_HALF_SPACE = _stiff(
    Layer(height=0.3, side=0.3, rod=0.010, tip="hemisphere", fine=1.5e-3, elements=10, friction=0.0)
)
_LOADING = Course(start=0.0).ramp(0.2e-3, 0.1e-3)
_AT_ONCE = Course(start=0.0).ramp(1.2e-3, 1.2e-3 / 1e-4).hold(30.0)
CHECKS = {
    "half-space, elastic": Push(layer=_HALF_SPACE, prony=Prony(), course=_LOADING),
    "half-space, loading": Push(layer=_HALF_SPACE, prony=_PRONY, course=_LOADING),
    "half-space, loading, finer": Push(layer=_HALF_SPACE, prony=_PRONY, course=_LOADING, finer=2.0),
    "ball, hold": Push(layer=_stiff(LAYERS["ball"]), prony=_PRONY, course=_AT_ONCE),
    "thick, hold": Push(layer=_stiff(LAYERS["thick"]), prony=_PRONY, course=_AT_ONCE),
}


def load() -> dict[str, Any]:
    """Stored indentations by name; empty if there is no file."""
    found: dict[str, Any] = json.loads(STORE.read_text(encoding="utf-8")) if STORE.exists() else {}
    return found


def save(found: dict[str, Any]) -> None:
    """Write the store atomically, one entry per line."""
    lines = ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in found.items())
    write_whole(STORE, "{\n" + lines + "\n}\n")


def stored_force(name: str, course: Course, times: Array) -> Array:
    """Force of a stored indentation over the long-time modulus [m2] at times [s].

    Raises
    ------
    KeyError
        If it is not stored; the text names the command that computes it.
    """
    entry = load().get(name)
    if entry is None:
        raise KeyError(
            f"{name}: not in {STORE.name}; python -m benchmarks.blind.timed.solve_indentation makes it"
        )
    stored_times, forces = np.array(entry["time"]), np.array(entry["force"])
    shortest = min(entry["push"]["prony"]["times"], default=1.0)
    found = np.empty_like(times)
    corners, driven = course.corners()
    pieces = zip(itertools.pairwise(corners), itertools.pairwise(driven), strict=True)
    for (begin, end), (before, after) in pieces:
        inside = (stored_times >= begin * (1 - 1e-8)) & (stored_times <= end * (1 + 1e-8))
        mine = (times >= begin) & (times <= end)
        since, asked = (np.maximum(t - begin, 0.0) for t in (stored_times[inside], times[mine]))
        # variable in which the force is smooth: the root of time after first contact; in a hold its logarithm
        # (the steps grow); else time itself. With its root the force after a reversal was 0.7 % too low.
        if before == after:
            since, asked = np.log1p(4.0 * since / shortest), np.log1p(4.0 * asked / shortest)
        elif before == 0.0:
            since, asked = np.sqrt(since), np.sqrt(asked)
        found[mine] = CubicSpline(since, forces[inside])(np.minimum(asked, since[-1]))
    return np.maximum(found, 0.0)  # no adhesion; interpolation may give values below 0
