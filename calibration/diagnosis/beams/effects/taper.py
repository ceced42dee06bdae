"""The section grows (positive) or shrinks along the beam, linearly, about the middle of its free length."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, specimen=replace(beam.specimen, taper=beam.specimen.taper + amplitude))


EFFECT = BeamEffect(
    name="taper",
    parameter="per_100mm",
    per_unit=0.1,
    belongs_to="specimen",
    step=0.1,
    bounds=(-1.5, 1.5),
    plausible=0.5,
    sentence="the section changes along the beam",
    remedy="measure the width at both ends; swap the ends",
    bend=_bend,
)
