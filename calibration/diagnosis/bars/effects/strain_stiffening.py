"""The material stiffens with strain (softens, where negative): W gets mu/2 a (I1 - 3)^2, in bending a term in
the cube of the curvature."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, stiffening=s.stiffening + amplitude)


EFFECT = BarEffect(
    name="strain-stiffening",
    parameter="c2_over_c1",
    per_unit=1.0,
    belongs_to="specimen",
    step=0.001,
    bounds=(-6.0, 10.0),
    plausible=1.5,
    sentence="the material's stiffness changes with strain",
    remedy="hang a larger mass; pull a coupon to large strain",
    alter=_alter,
)
