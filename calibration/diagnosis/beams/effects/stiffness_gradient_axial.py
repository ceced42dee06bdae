"""The modulus changes linearly along the beam (a mixture that settled), about its free length's middle."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    grown = beam.specimen.axial_gradient + amplitude
    return replace(beam, specimen=replace(beam.specimen, axial_gradient=grown))


EFFECT = BeamEffect(
    name="stiffness-gradient-axial",
    parameter="per_100mm",
    per_unit=0.1,
    belongs_to="specimen",
    step=0.5,
    bounds=(-9.0, 9.0),
    plausible=4.0,
    sentence="the material is stiffer at one end than at the other",
    remedy="swap the ends of the beam",
    bend=_bend,
)
