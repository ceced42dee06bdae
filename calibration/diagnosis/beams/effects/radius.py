"""The section is larger (positive) or smaller than stated, all along the beam; swelling looks the same."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam, Circle


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    if isinstance(beam.section, Circle):
        return replace(beam, section=Circle(radius=beam.section.radius + amplitude))
    s = beam.section
    return replace(
        beam, section=replace(s, width=s.width + 2.0 * amplitude, height=s.height + 2.0 * amplitude)
    )


EFFECT = BeamEffect(
    name="radius",
    parameter="excess_mm",
    per_unit=1e3,
    belongs_to="specimen",
    step=5e-5,
    bounds=(-2e-3, 2e-3),
    plausible=5e-4,
    sentence="the section is thicker or thinner than stated",
    remedy="measure the section with callipers",
    bend=_bend,
)
