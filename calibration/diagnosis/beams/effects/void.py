"""A bubble or a cut: over 15 mm of one beam part of its bending stiffness, and of its weight, is missing.

The amplitude is that of a void with sharp ends. `tisim.Void` fades out, which any mesh can follow; both bend
the beam by the same angle where the flexibility that they add along it, the integral of 1 / (1 - loss) - 1, is
the same. That of a raised cosine of peak p over twice its length L is 2 L (1 / sqrt(1 - p) - 1), that of a loss f
over L is L f / (1 - f).
"""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam, Void


def faded(loss: float) -> float:
    """Peak loss of the raised cosine that bends as much as a loss with sharp ends."""
    return 1.0 - (1.0 + 0.5 * loss / (1.0 - loss)) ** -2.0


def _bend(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    assert situation.place is not None, "a void sits somewhere"
    hole = Void(position=situation.place * situation.trial.free_length, fraction=faded(amplitude))
    return replace(beam, specimen=replace(beam.specimen, void=hole))


EFFECT = BeamEffect(
    name="void",
    parameter="lost_EI",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.1,
    bounds=(0.0, 0.85),  # a peak of 0.93: tisim takes 0.95 at most
    plausible=0.5,
    sentence="a void or a cut weakens the beam in one place",
    remedy="look through the beam, or swap its ends: the kink moves along",
    bend=_bend,
    reach="trial",
    places=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7),  # the search moves what it finds: `places.settled`
)
