"""The clamps yield: they turn in proportion to the bending moment that they carry."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, clamps=replace(beam.clamps, compliance=beam.clamps.compliance + amplitude))


EFFECT = BeamEffect(
    name="clamp-compliance",
    parameter="rad_per_Nm",
    per_unit=1.0,
    belongs_to="rig",
    step=1.0,
    bounds=(0.0, 20.0),
    plausible=8.0,
    sentence="the clamps turn under the moment that they carry",
    remedy="load the clamp with a known moment and measure its rotation",
    bend=_bend,
)
