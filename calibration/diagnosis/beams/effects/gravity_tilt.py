"""The whole rig leans in the plane of the picture: gravity is not along -z. Positive turns it towards +x."""

from dataclasses import replace

import numpy as np

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    x, y, z = beam.gravity
    c, s = float(np.cos(amplitude)), float(np.sin(amplitude))
    return replace(beam, gravity=(c * x - s * z, y, s * x + c * z))


EFFECT = BeamEffect(
    name="gravity-tilt",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="rig",
    step=1e-2,
    bounds=(-0.2, 0.2),
    plausible=0.08,
    sentence="the rig leans: gravity does not act along its vertical axis",
    remedy="level the rig, or hang a plumb line in the picture",
    bend=_bend,
)
