"""The hung mass acts above (or below) the middle of the end face: its arm changes as the face turns."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect, hung


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, load_height=s.load_height + amplitude)


EFFECT = BarEffect(
    name="load-height",
    parameter="height_mm",
    per_unit=1e3,
    belongs_to="rig",
    step=1e-05,
    bounds=(-5e-2, 5e-2),
    plausible=2e-2,
    sentence="the mass hangs above or below the middle of the end face",
    remedy="measure where on the end face the mass hangs",
    alter=_alter,
    touches=hung,
    reach="rig",
)
