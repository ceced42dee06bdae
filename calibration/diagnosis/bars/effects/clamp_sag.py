"""The clamp yields: it sinks in proportion to the force that it carries."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    return replace(s, clamp_sag=s.clamp_sag + amplitude)


EFFECT = BarEffect(
    name="clamp-sag",
    parameter="mm_per_N",
    per_unit=1e3,
    belongs_to="rig",
    step=1e-07,
    bounds=(0.0, 3e-3),
    plausible=5e-4,
    sentence="the clamp sinks under the weight that it carries",
    remedy="hang a known weight on the clamp and measure how far it sinks",
    alter=_alter,
    reach="rig",
)
