"""The zero of the force is off, by the same all through a record."""

from __future__ import annotations

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import Array, PokeEffect


def _force(force: Array, amplitude: float, record: Record, kind: float | None) -> Array:
    del record, kind
    return force + amplitude


EFFECT = PokeEffect(
    name="force-offset",
    parameter="offset_N",
    per_unit=1.0,
    belongs_to="rig",
    step=1e-4,
    bounds=(-5.0, 5.0),
    plausible=0.1,
    sentence="the zero of the force is off",
    remedy="record some seconds before the rod touches, and tare the load cell",
    force=_force,
    stage=5,
    reach="rig",
)
