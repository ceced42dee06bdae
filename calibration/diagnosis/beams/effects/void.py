"""A bubble or a cut: over 15 mm of one beam part of its bending stiffness, and of its weight, is missing."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam, Void


def _bend(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    assert situation.place is not None, "a void sits somewhere"
    hole = Void(position=situation.place * situation.trial.free_length, fraction=amplitude)
    return replace(beam, specimen=replace(beam.specimen, void=hole))


EFFECT = BeamEffect(
    name="void",
    parameter="lost_EI",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.1,
    bounds=(0.0, 0.9),
    plausible=0.5,
    sentence="a void or a cut weakens the beam in one place",
    remedy="look through the beam, or swap its ends: the kink moves along",
    bend=_bend,
    reach="trial",
    places=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7),  # the search moves what it finds: `places.settled`
)
