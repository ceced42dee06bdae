"""The cameras' frame is turned about y against the bar's, in all trials alike."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, roll=s.roll + amplitude)


EFFECT = BarEffect(
    name="camera-roll",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="camera",
    step=1e-05,
    bounds=(-0.3, 0.3),
    plausible=0.04,
    sentence="the cameras' frame is turned against the bar's",
    remedy="put a gauge along the bar in view",
    alter=_alter,
    reach="rig",
)
