"""The whole rig leans in the plane of the swing: weights do not act as stated. Positive turns them to +x."""

from dataclasses import replace

import numpy as np

from calibration.diagnosis.bars._setting import Pair, Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _turned(v: Pair, angle: float) -> Pair:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return c * v[0] - s * v[1], s * v[0] + c * v[1]


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, gravity=_turned(s.gravity, amplitude), tip_force=_turned(s.tip_force, amplitude))


EFFECT = BarEffect(
    name="gravity-tilt",
    parameter="angle_deg",
    per_unit=57.29577951308232,
    belongs_to="rig",
    step=0.0001,
    bounds=(-0.4, 0.4),
    plausible=0.08,
    sentence="the rig leans: gravity does not act as stated",
    remedy="level the rig, or hang a plumb line in view",
    alter=_alter,
    reach="rig",
)
