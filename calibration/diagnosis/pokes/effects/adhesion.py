"""The surface sticks to the rod: on the way back the force is smaller, and pulls before the rod comes free.

The pull grows from the turning point on within a tenth of the way, and fades above the surface; of another
kind it acts near the surface only.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import Array, PokeEffect

EVERYWHERE, SHALLOW = 0.0, 1.0
TURNS = 0.1  # part of the deepest depth within which the pull grows
LIFT, NEAR = 0.15, 0.3  # parts of the rod's radius: above the surface until it tears, below it (shallow)


def _force(force: Array, amplitude: float, record: Record, kind: float | None) -> Array:
    return force - amplitude * _pull(record, kind)


def _pull(record: Record, kind: float | None) -> Array:
    radius = record.geometry.rod.radius
    d = record.depth
    grown = np.clip((record.peak - d) / np.maximum(TURNS * record.peak, 1e-9), 0.0, 1.0)
    below = np.exp(-np.maximum(d, 0.0) / (NEAR * radius)) if kind == SHALLOW else np.ones(d.size)
    above = np.exp(-((np.minimum(d, 0.0) / (LIFT * radius)) ** 2))
    return np.asarray((record.kind < 0) * grown * below * above)


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some unloading."""
    del everything
    return any((r.kind < 0).any() for r in reached)


EFFECT = PokeEffect(
    name="adhesion",
    parameter="pull_mN",
    per_unit=1e3,
    belongs_to="specimen",
    step=1e-4,
    bounds=(0.0, 2.0),
    plausible=0.1,
    sentence="the surface sticks to the rod and pulls it on the way back",
    remedy="record the way back until the rod is free; powder the surface and repeat",
    force=_force,
    stage=3,
    kinds=lambda _: (EVERYWHERE, SHALLOW),
    kind_label=lambda kind: "near the surface" if kind == SHALLOW else "all the way back",
    touches=lambda record: bool((record.kind < 0).any()),
    shows=_shows,
    reach="material",
)
