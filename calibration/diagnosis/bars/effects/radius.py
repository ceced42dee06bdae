"""The section is larger (or smaller) than measured in all directions, by this part."""

from dataclasses import replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects._effect import BarEffect
from tisim import Circle, Rectangle


def _alter(s: Setting, amplitude: float, _: float | None) -> Setting:
    grown = 1.0 + amplitude
    if isinstance(s.section, Circle):
        return replace(s, section=Circle(radius=grown * s.section.radius))
    return replace(s, section=Rectangle(width=grown * s.section.width, height=grown * s.section.height))


EFFECT = BarEffect(
    name="radius",
    parameter="excess",
    per_unit=1.0,
    belongs_to="specimen",
    step=1e-05,
    bounds=(-0.2, 0.2),
    plausible=0.02,
    sentence="the section is not as large as stated",
    remedy="measure the section with callipers",
    alter=_alter,
)
