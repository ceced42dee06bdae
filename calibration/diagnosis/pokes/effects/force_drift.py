"""The zero of the force wanders in proportion to time (warming load cell)."""

from __future__ import annotations

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import Array, PokeEffect


def _force(force: Array, amplitude: float, record: Record, kind: float | None) -> Array:
    del kind
    return force + amplitude * (record.time - record.time[0])


EFFECT = PokeEffect(
    name="force-drift",
    parameter="drift_mN_per_s",
    per_unit=1e3,
    belongs_to="rig",
    step=1e-6,
    bounds=(-1.0, 1.0),
    plausible=0.02,
    sentence="the zero of the force drifts",
    remedy="record the free rod before and after the poke; let the load cell warm up",
    force=_force,
    stage=5,
    reach="rig",
)
