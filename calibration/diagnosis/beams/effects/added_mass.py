"""Something hangs on the free end of one cantilever: a blob, a hook, a label."""

from dataclasses import replace

import numpy as np

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation, cantilever
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    force = np.asarray(beam.tip_force) + amplitude * np.asarray(beam.gravity)
    return replace(beam, tip_force=(float(force[0]), float(force[1]), float(force[2])))


EFFECT = BeamEffect(
    name="added-mass",
    parameter="mass_g",
    per_unit=1e3,
    belongs_to="specimen",
    step=2e-4,
    bounds=(0.0, 2e-2),
    plausible=2e-3,
    sentence="an extra mass hangs on the free end",
    remedy="look at the free end; weigh the beam",
    bend=_bend,
    touches=cantilever,
    reach="trial",
)
