"""The material gives way in volume: Poisson's ratio is lower than the baseline's by this much."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation, with_moduli
from tisim import Beam, laws


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    moduli = laws.get(beam.material.law).moduli(beam.material.parameters)
    g, k = moduli.shear, moduli.bulk
    nu = (3.0 * k - 2.0 * g) / (6.0 * k + 2.0 * g) - amplitude
    bulk = 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))
    return replace(beam, material=with_moduli(beam.material, shear=g, bulk=bulk))


EFFECT = BeamEffect(
    name="compressibility",
    parameter="poisson_drop",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.03,
    bounds=(0.0, 0.3),
    plausible=0.05,
    sentence="the material is compressible",
    remedy="weigh it under pressure, or compress a bonded cylinder",
    bend=_bend,
)
