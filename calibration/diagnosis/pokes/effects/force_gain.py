"""The load cell shows a multiple of the force: in all records alike nothing parts this from the modulus."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import Array, PokeEffect


def _force(force: Array, amplitude: float, record: Record, kind: float | None) -> Array:
    del record, kind
    return (1.0 + amplitude) * force


def _shows(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Another record of the same material that it does not reach."""
    names = {r.name for r in reached}
    materials = {r.material for r in reached}
    return any(r.material in materials and r.name not in names for r in everything)


EFFECT = PokeEffect(
    name="force-gain",
    parameter="excess_percent",
    per_unit=100.0,
    belongs_to="rig",
    step=1e-3,
    bounds=(-0.6, 0.6),
    plausible=0.3,
    sentence="the load cell's scale is off",
    remedy="hang a known weight on the load cell",
    force=_force,
    stage=4,
    shows=_shows,
    reach="rig",
)
