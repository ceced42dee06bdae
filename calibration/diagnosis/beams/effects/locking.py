"""The simulator's elements lock: this part of the way from its beams to those of a mixed element."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect
from calibration.outlines import COARSE
from tisim import Beam


def _instead(beam: Beam) -> Beam:
    return replace(beam, element="default", layer=COARSE.layer, rings=2)


EFFECT = BeamEffect(
    name="locking",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    step=1.0,
    bounds=(-1.0, 3.0),
    plausible=1.0,
    sentence="the simulator's elements lock: its beams are too stiff",
    remedy="use elements with a pressure of their own; refine the mesh to see the answer move",
    instead=_instead,
    faulty=lambda simulator: simulator.fidelity.element == "tet4",
)
