"""The material stiffens with strain: W gets a term mu/2 a (I1bar - 3)^2 beside the baseline's."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    known = beam.material.parameters["stiffening"]  # the baseline's law has it, at zero
    assert isinstance(known, float)
    parameters = {**beam.material.parameters, "stiffening": known + amplitude}
    return replace(beam, material=replace(beam.material, parameters=parameters))


EFFECT = BeamEffect(
    name="strain-stiffening",
    parameter="c2_over_c1",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.1,
    bounds=(0.0, 4.0),
    plausible=1.5,
    sentence="the material gets stiffer the more it is strained",
    remedy="photograph a longer beam, or the softest mixture; pull a coupon to large strain",
    bend=_bend,
)
