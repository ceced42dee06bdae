"""A cantilever has slipped out of its grip: its free length is longer (positive) than measured."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation, cantilever
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, length=beam.length + amplitude)


EFFECT = BeamEffect(
    name="free-length",
    parameter="slip_mm",
    per_unit=1e3,
    belongs_to="rig",
    step=5e-4,
    bounds=(-8e-3, 8e-3),
    plausible=2e-3,
    sentence="the beam has slipped in its grip: its free length is not as stated",
    remedy="set the free length with a gauge block, and mark the beam at the clamp's face",
    bend=_bend,
    touches=cantilever,
)
