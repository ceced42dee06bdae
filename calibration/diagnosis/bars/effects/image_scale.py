"""The cameras show displacements too large (positive) or too small."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, scale=s.scale + amplitude)


EFFECT = BarEffect(
    name="image-scale",
    parameter="excess",
    per_unit=1.0,
    belongs_to="camera",
    step=1e-05,
    bounds=(-0.2, 0.2),
    plausible=0.01,
    sentence="the cameras' scale is wrong",
    remedy="move a marker by a known way in view",
    alter=_alter,
    reach="rig",
)
