"""The bar is stiffer towards its free end (positive) or its clamp."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, gradient=s.gradient + amplitude)


EFFECT = BarEffect(
    name="stiffness-gradient-axial",
    parameter="per_100mm",
    per_unit=0.1,
    belongs_to="specimen",
    step=0.001,
    bounds=(-8.0, 8.0),
    plausible=1.5,
    sentence="the bar is stiffer at one end than at the other",
    remedy="swap the bar's ends",
    alter=_alter,
)
