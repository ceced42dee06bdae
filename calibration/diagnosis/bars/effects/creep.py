"""The material creeps: its modulus relaxes by this part of what the swing shows with each decade of time,
from a millisecond to a quarter of an hour (two relaxation times a decade): a swing loses energy by it too."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect

A_DECADE = 2
TIMES = tuple(10.0 ** (k / A_DECADE) for k in range(-3 * A_DECADE, 3 * A_DECADE + 1))


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    if amplitude == 0.0:
        return s
    return replace(s, branches=s.branches + tuple((amplitude / A_DECADE, t) for t in TIMES))


EFFECT = BarEffect(
    name="creep",
    parameter="per_decade",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-05,
    bounds=(0.0, 0.25),
    plausible=0.1,
    sentence="the material creeps: it gets softer with each decade of time",
    remedy="record ten times as long",
    alter=_alter,
)
