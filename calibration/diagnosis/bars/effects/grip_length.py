"""The clamp holds deeper (positive) or shallower than its face: the bar is free that much inside."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, depth=s.depth + amplitude)


EFFECT = BarEffect(
    name="grip-length",
    parameter="depth_mm",
    per_unit=1e3,
    belongs_to="rig",
    step=1e-06,
    bounds=(-1e-2, 1e-2),
    plausible=3e-3,
    sentence="the clamp holds deeper inside than at its face",
    remedy="clamp a metal bar and measure where the clamp holds it",
    alter=_alter,
    reach="rig",
)
