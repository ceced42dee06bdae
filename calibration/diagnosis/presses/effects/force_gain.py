"""The load cell shows a multiple of the force: in all records alike nothing parts this from the modulus."""

from __future__ import annotations

from calibration.diagnosis.presses.effects._effect import Array, PressEffect


def _reads(stress: Array, amplitude: float) -> Array:
    return (1.0 + amplitude) * stress


EFFECT = PressEffect(
    name="force-gain",
    parameter="excess_percent",
    per_unit=100.0,
    belongs_to="rig",
    step=1e-3,
    bounds=(-0.6, 0.6),
    plausible=0.1,
    sentence="the load cell's scale is off",
    remedy="put a known weight on the load cell",
    reads=_reads,
    reach="rig",
)
