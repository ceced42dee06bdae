"""The clamp is mounted askew: its face is turned, the beam leaves it upwards (positive) or downwards."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, clamps=replace(beam.clamps, tilt=beam.clamps.tilt + amplitude))


EFFECT = BeamEffect(
    name="clamp-tilt",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="rig",
    step=5e-3,
    bounds=(-0.1, 0.1),
    plausible=0.05,
    sentence="the near clamp is tilted",
    remedy="lay a spirit level on the clamp",
    bend=_bend,
)
