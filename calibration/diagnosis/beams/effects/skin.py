"""A layer of 1 mm at the surface is stiffer than the core by this part; locking elements look the same."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, specimen=replace(beam.specimen, skin=beam.specimen.skin + amplitude))


EFFECT = BeamEffect(
    name="skin",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.1,
    bounds=(-0.9, 3.0),
    plausible=1.0,
    sentence="the surface is stiffer or softer than the core",
    remedy="cut the beam and press both sides; refine the mesh to tell it from locking elements",
    bend=_bend,
)
