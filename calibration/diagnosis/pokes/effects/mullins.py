"""Once poked, the material is softer down to the deepest depth that it has seen: by this part near the
surface, by nothing at that depth; or, of another kind, by the same part all the way in later loadings."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import Array, PokeEffect

FADING, EVEN = 0.0, 1.0


def _force(force: Array, amplitude: float, record: Record, kind: float | None) -> Array:
    if kind == EVEN:
        softened = np.maximum(record.cycle > 1, record.begun[0])
    else:
        below = 1.0 - record.depth / np.maximum(record.peak, 1e-9)
        softened = record.begun * np.clip(below, 0.0, 1.0)
    return force * (1.0 - amplitude * softened)


def reloaded(record: Record) -> bool:
    """Whether it was loaded again after an unloading, in this record or after another."""
    return bool((record.cycle > 1).any() or record.begun[0] > 0.0)


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some second loading."""
    del everything
    return any(reloaded(r) for r in reached)


EFFECT = PokeEffect(
    name="mullins",
    parameter="softening",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-3,
    bounds=(0.0, 0.95),
    plausible=0.5,
    sentence="the first poke softens the material (Mullins): the second one needs less force",
    remedy="poke the same place twice to the same depth",
    force=_force,
    stage=1,
    kinds=lambda _: (FADING, EVEN),
    kind_label=lambda kind: "all the way" if kind == EVEN else "below the deepest depth",
    touches=reloaded,
    shows=_shows,
    reach="material",
)
