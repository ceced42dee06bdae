"""The grip squeezes the section that it holds: lower by this part, and wider by the same."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, clamps=replace(beam.clamps, squeeze=beam.clamps.squeeze + amplitude))


EFFECT = BeamEffect(
    name="grip-squeeze",
    parameter="squeeze",
    per_unit=1.0,
    belongs_to="rig",
    step=0.02,
    bounds=(0.0, 0.25),
    plausible=0.1,
    sentence="the grips squeeze the section that they hold",
    remedy="measure the beam's height next to the clamp; cast a collar on the specimen",
    bend=_bend,
)
