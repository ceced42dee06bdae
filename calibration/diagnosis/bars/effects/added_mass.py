"""More (or less) mass hangs on the free end than stated, with its weight and its inertia."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    gx, gz = s.gravity
    fx, fz = s.tip_force
    return replace(s, tip_mass=s.tip_mass + amplitude, tip_force=(fx + amplitude * gx, fz + amplitude * gz))


EFFECT = BarEffect(
    name="added-mass",
    parameter="mass_g",
    per_unit=1e3,
    belongs_to="specimen",
    step=2e-06,
    bounds=(-2e-2, 4e-2),
    plausible=5e-3,
    sentence="another mass hangs on the free end than stated",
    remedy="weigh what hangs on the free end: markers, string and hook too",
    alter=_alter,
    reach="rig",
)
