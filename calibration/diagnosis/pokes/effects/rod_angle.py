"""The rod leans more, or less, than believed: in the plane of its push (x and z where it is upright), or
across."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import PokeEffect
from tisim import Mesh, Poke

ALONG, ACROSS = 0.0, 1.0
STEEPEST = np.radians(45.0)
DEGREE = float(np.radians(1.0))


def _scene(poke: Poke, mesh: Mesh | None, amplitude: float, kind: float | None) -> Poke:
    axis = np.asarray(poke.direction) / np.linalg.norm(poke.direction)
    level = np.array([axis[0], axis[1], 0.0])
    away = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(level) < 1e-9 else level / np.linalg.norm(level)
    if kind == ACROSS:
        away = np.array([-away[1], away[0], 0.0])
    side = away - (away @ axis) * axis
    side /= np.linalg.norm(side)
    turned = np.cos(amplitude) * axis + np.sin(amplitude) * side
    return replace(poke, direction=(float(turned[0]), float(turned[1]), float(turned[2])), mesh=mesh)


def _kinds(records: Sequence[Record]) -> tuple[float | None, ...]:
    """Across the plane only where forces across the rod tell."""
    return (ALONG, ACROSS) if any(r.across is not None for r in records) else (ALONG,)


def _fits(poke: Poke) -> bool:
    axis = np.asarray(poke.direction) / np.linalg.norm(poke.direction)
    return float(np.arccos(np.clip(-axis[2], -1.0, 1.0))) <= STEEPEST


EFFECT = PokeEffect(
    name="rod-angle",
    parameter="tilt_deg",
    per_unit=1.0 / DEGREE,
    belongs_to="rig",
    step=0.1 * DEGREE,
    bounds=(-10.0 * DEGREE, 10.0 * DEGREE),
    plausible=10.0 * DEGREE,
    sentence="the rod leans more than believed",
    remedy="put a square against the rod, or record the force across it too",
    scene=_scene,
    nodes=(-10.0 * DEGREE, -5.0 * DEGREE, 0.0, 5.0 * DEGREE, 10.0 * DEGREE),
    chord=5.0 * DEGREE,
    fits=_fits,
    kinds=_kinds,
    kind_label=lambda kind: "across its plane" if kind == ACROSS else "in its plane",
    reach="rig",
)
