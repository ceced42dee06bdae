"""Something drags on the bar in proportion to its speed and mass (mass-proportional damping)."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, drag=s.drag + amplitude)


EFFECT = BarEffect(
    name="air-drag",
    parameter="rate_per_s",
    per_unit=1.0,
    belongs_to="rig",
    step=0.0002,
    bounds=(0.0, 20.0),
    plausible=1.0,
    sentence="something beside the material drags on the moving bar",
    remedy="swing it in other air (a box, a vacuum), and with other masses",
    alter=_alter,
    reach="rig",
)
