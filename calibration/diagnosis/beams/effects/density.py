"""The specimen weighs more or less than the lab says: stiffness and weight enter by their ratio alone."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    heavier = beam.material.density * (1.0 + amplitude)
    return replace(beam, material=replace(beam.material, density=heavier))


EFFECT = BeamEffect(
    name="density",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    # the opposite of the baseline's own step in ln G: the two are one, and so must their differences be
    step=-0.003,
    bounds=(-0.3, 0.3),
    plausible=0.05,
    sentence="the material is heavier or lighter than stated",
    remedy="weigh the specimen",
    bend=_bend,
)
