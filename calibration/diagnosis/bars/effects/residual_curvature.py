"""The bar was bent when it was moulded: free of stress it is an arc, upwards where positive."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, curvature=s.curvature + amplitude)


EFFECT = BarEffect(
    name="residual-curvature",
    parameter="curvature_per_m",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.0001,
    bounds=(-2.0, 2.0),
    plausible=0.5,
    sentence="the bar is bent by itself, free of load",
    remedy="turn the bar by 180 degrees about its axis",
    alter=_alter,
)
