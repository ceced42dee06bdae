"""The material creeps: its modulus falls by this part with each decade of time since release, from 1 s."""

from dataclasses import replace

import numpy as np

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation, with_moduli
from tisim import Beam, laws


def _bend(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    moduli = laws.get(beam.material.law).moduli(beam.material.parameters)
    part = 1.0 - amplitude * float(np.log10(situation.time))
    softer = with_moduli(beam.material, shear=part * moduli.shear, bulk=part * moduli.bulk)
    return replace(beam, material=softer)


EFFECT = BeamEffect(
    name="creep",
    parameter="per_decade",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.01,
    bounds=(-0.15, 0.25),
    plausible=0.1,
    sentence="the material creeps: it sinks further with time",
    remedy="photograph the same beam at several times",
    bend=_bend,
    timed=True,
)
