"""The cameras' clock is slow (positive: more time has passed than they say) or fast."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, clock=s.clock + amplitude)


EFFECT = BarEffect(
    name="clock-rate",
    parameter="excess",
    per_unit=1.0,
    belongs_to="camera",
    step=1e-06,
    bounds=(-0.2, 0.2),
    plausible=0.002,
    sentence="the cameras' clock is wrong",
    remedy="record a metronome, or another camera's clock",
    alter=_alter,
    reach="rig",
)
