"""The bar weighs more or less than the lab says. Beside a hung mass that is known, its weight shows."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, density=s.density * (1.0 + amplitude))


EFFECT = BarEffect(
    name="density",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-05,
    bounds=(-0.3, 0.3),
    plausible=0.05,
    sentence="the material is heavier or lighter than stated",
    remedy="weigh the specimen",
    alter=_alter,
)
