"""The material has one more relaxation time: this part of the modulus that a swing shows goes with it."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, time: float | None) -> Setting:
    assert time is not None
    return s if amplitude == 0.0 else replace(s, branches=(*s.branches, (amplitude, time)))


def _label(time: float) -> str:
    return f"relaxation time {time:g} s"


EFFECT = BarEffect(
    name="relaxation",
    parameter="part_of_modulus",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-05,
    bounds=(0.0, 0.8),
    plausible=0.2,
    sentence="the material has a second relaxation time",
    remedy="let go with other masses, so that it swings at other frequencies",
    alter=_alter,
    kinds=(0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0),
    kind_label=_label,
)
