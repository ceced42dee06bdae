"""The zero of the load cell is off, by the same all through a record: the stress that is read is too high by
the amplitude [Pa]."""

from __future__ import annotations

from calibration.diagnosis.presses.effects._effect import Array, PressEffect


def _reads(stress: Array, amplitude: float) -> Array:
    return stress + amplitude


EFFECT = PressEffect(
    name="force-offset",
    parameter="offset_kPa",
    per_unit=1e-3,
    belongs_to="rig",
    step=1.0,
    bounds=(-2e4, 2e4),
    plausible=500.0,
    sentence="the zero of the force is off",
    remedy="record some seconds before the platen touches, and tare the load cell",
    reads=_reads,
    reach="rig",
)
