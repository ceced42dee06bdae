"""The simulator stops before equilibrium: this part of the way from where it stops to the equilibrium."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect
from calibration.outlines import COARSE
from tisim import Beam


def _instead(beam: Beam) -> Beam:
    return replace(beam, solver=COARSE.solver)


EFFECT = BeamEffect(
    name="not-at-equilibrium",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    step=1.0,
    bounds=(-1.0, 3.0),
    plausible=1.0,
    sentence="the simulator stops before its beams are at rest",
    remedy="judge rest by the force that is out of balance, not by how slowly the beam moves",
    instead=_instead,
    faulty=lambda simulator: simulator.fidelity.solver.method != "static",
)
