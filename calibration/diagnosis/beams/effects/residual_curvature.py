"""The beam was bent in its mould: free of stress it is an arc, upwards where positive."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, specimen=replace(beam.specimen, curvature=beam.specimen.curvature + amplitude))


EFFECT = BeamEffect(
    name="residual-curvature",
    parameter="curvature_per_m",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.1,
    bounds=(-4.0, 4.0),
    plausible=1.0,
    sentence="the beam is bent without any load, as it came out of its mould",
    remedy="turn the beam by 180 degrees about its axis: a bend changes sign",
    bend=_bend,
)
