"""What a lab can do next with a bar: let it go otherwise, and measure directly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.experiments import Gauge

HEAVIER = 0.05  # [kg] more on the free end
LONGER, FURTHER = 1.3, 10.0  # times as long a bar, and as long a record


def as_it_is(setting: Setting) -> Setting:
    return setting


@dataclass(frozen=True, kw_only=True)
class Release:
    """The same bars let go anew. pose: what is done to each setting, effects in it; stretch: how many times
    as long the record goes on after its swing."""

    name: str
    sentence: str
    pose: Callable[[Setting], Setting] = as_it_is
    stretch: float = 1.0


def _turned(s: Setting) -> Setting:
    return replace(s, curvature=-s.curvature)


def _heavier(s: Setting) -> Setting:
    x, z = s.gravity
    force = (s.tip_force[0] + HEAVIER * x, s.tip_force[1] + HEAVIER * z)
    return replace(s, tip_mass=s.tip_mass + HEAVIER, tip_force=force)


def _longer(s: Setting) -> Setting:
    return replace(s, length=LONGER * s.length)


def _swapped(s: Setting) -> Setting:
    return replace(s, gradient=-s.gradient)


EXPERIMENTS: tuple[Release | Gauge, ...] = (
    Gauge(
        name="weigh", sentence="weigh the bar and what hangs on it", sds={"density": 2e-3, "added-mass": 1e-4}
    ),
    Gauge(name="callipers", sentence="measure the section with callipers", sds={"radius": 2e-3}),
    Gauge(
        name="level", sentence="hang a plumb line in view", sds={"gravity-tilt": 5e-3, "camera-roll": 5e-3}
    ),
    Gauge(name="ruler", sentence="measure where on the end face the mass hangs", sds={"load-height": 5e-4}),
    Gauge(
        name="known-way",
        sentence="move a marker by a known way, beside another clock, in view",
        sds={"image-scale": 2e-3, "clock-rate": 1e-4},
    ),
    Gauge(
        name="metal-bar",
        sentence="clamp a metal bar, load it, and measure where and how far the clamp gives",
        sds={"clamp-compliance": 2e-3, "clamp-sag": 2e-5, "grip-length": 2e-4},
    ),
    Release(name="record-longer", sentence="record ten times as long", stretch=FURTHER),
    Release(name="turn-over", sentence="turn the bar by 180 degrees about its axis", pose=_turned),
    Release(name="swap-ends", sentence="swap the bar's ends", pose=_swapped),
    Release(name="heavier", sentence=f"hang {1e3 * HEAVIER:g} g more on the free end", pose=_heavier),
    Release(name="longer-bar", sentence="let a bar go that is 30 % longer", pose=_longer),
)
