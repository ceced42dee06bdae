"""The clamp yields: it turns in proportion to the bending moment that it carries."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, clamp_turn=s.clamp_turn + amplitude)


EFFECT = BarEffect(
    name="clamp-compliance",
    parameter="rad_per_Nm",
    per_unit=1.0,
    belongs_to="rig",
    step=1e-05,
    bounds=(0.0, 1.0),
    plausible=0.2,
    sentence="the clamp turns under the moment that it carries",
    remedy="load the clamp with a known moment and measure its rotation",
    alter=_alter,
    reach="rig",
)
