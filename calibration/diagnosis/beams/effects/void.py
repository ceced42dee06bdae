"""A bubble or a cut: over 15 mm of one beam part of its bending stiffness, and of its weight, is missing.

The amplitude is that of a void with sharp ends. `tisim.Void` sets in over `edge`, since a mesh cannot follow
a jump; both bend the beam by the same angle where the flexibility that they add along it, the integral of
1 / (1 - loss) - 1, is the same. That of a loss f over the length L is L f / (1 - f); that of one of peak p,
half a cosine over E at either end, is (L - E) (w^2 - 1) + 2 E (w - 1) with w = 1 / sqrt(1 - p).
"""

from dataclasses import replace
from math import sqrt

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam, Void


def hole(loss: float, *, position: float) -> Void:
    """The void that bends a beam as much as a loss with sharp ends."""
    flat = Void(position=position, fraction=0.0)
    length, edge = flat.length, flat.edge
    core = length - edge
    w = (sqrt(edge**2 + core * (length + edge + length * loss / (1.0 - loss))) - edge) / core
    return replace(flat, fraction=1.0 - w**-2.0)


def _bend(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    assert situation.place is not None, "a void sits somewhere"
    void = hole(amplitude, position=situation.place * situation.trial.free_length)
    return replace(beam, specimen=replace(beam.specimen, void=void))


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
