"""The modulus changes linearly from the lower to the upper side (a filler that settled while curing)."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    grown = beam.specimen.transverse_gradient + amplitude
    return replace(beam, specimen=replace(beam.specimen, transverse_gradient=grown))


EFFECT = BeamEffect(
    name="stiffness-gradient-transverse",
    parameter="per_radius",
    per_unit=0.01,  # a radius of 10 mm, that of the paper's beams
    belongs_to="specimen",
    step=2.0,
    bounds=(-80.0, 80.0),
    plausible=40.0,
    sentence="the material is stiffer on one side, above or below",
    remedy="turn the beam by 180 degrees about its axis",
    bend=_bend,
)
