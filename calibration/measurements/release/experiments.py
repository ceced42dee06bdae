"""Next experiments for cantilever releases: repeated releases, and direct measurements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from calibration.measurements._design import Gauge
from calibration.measurements.release._beam import BeamParameters

HEAVIER = 0.05  # additional mass on the free end [kg]
LONGER, FURTHER = 1.3, 10.0  # factors on the length of the beam and on the duration of the record


def unchanged(parameters: BeamParameters) -> BeamParameters:
    """Parameters of the beam without a change."""
    return parameters


@dataclass(frozen=True, kw_only=True)
class RepeatedRelease:
    """A repeated release of the same specimens.

    Attributes
    ----------
    name : name of the experiment.
    sentence : instruction for the lab.
    changed : function from the parameters of a beam in the earlier release, including effects, to new ones.
    duration : factor on the duration of the record after its free vibration.
    """

    name: str
    sentence: str
    changed: Callable[[BeamParameters], BeamParameters] = unchanged
    duration: float = 1.0


def _turned_over(s: BeamParameters) -> BeamParameters:
    return replace(s, curvature=-s.curvature)


def _heavier(s: BeamParameters) -> BeamParameters:
    x, z = s.gravity
    force = (s.tip_force[0] + HEAVIER * x, s.tip_force[1] + HEAVIER * z)
    return replace(s, tip_mass=s.tip_mass + HEAVIER, tip_force=force)


def _longer(s: BeamParameters) -> BeamParameters:
    return replace(s, length=LONGER * s.length)


def _swapped(s: BeamParameters) -> BeamParameters:
    return replace(s, axial_gradient=-s.axial_gradient)


EXPERIMENTS: tuple[RepeatedRelease | Gauge, ...] = (
    Gauge(
        name="weigh",
        sentence="weigh the beam and what hangs on it",
        sds={"density": 2e-3, "added-mass": 1e-4},
    ),
    Gauge(name="callipers", sentence="measure the section with callipers", sds={"section-scale": 2e-3}),
    Gauge(
        name="level", sentence="hang a plumb line in view", sds={"gravity-tilt": 5e-3, "camera-roll": 5e-3}
    ),
    Gauge(name="ruler", sentence="measure where on the end face the mass hangs", sds={"load-height": 5e-4}),
    Gauge(
        name="known-way",
        sentence="move a marker by a known distance, beside another clock, in view",
        sds={"image-scale": 2e-3, "clock-rate": 1e-4},
    ),
    Gauge(
        name="metal-bar",
        sentence="clamp a metal bar, load it, and measure where and how far the clamp gives",
        sds={"clamp-compliance": 2e-3, "clamp-sag": 2e-5, "grip-length": 2e-4},
    ),
    RepeatedRelease(name="record-longer", sentence="record ten times as long", duration=FURTHER),
    RepeatedRelease(
        name="turn-over", sentence="turn the beam by 180 degrees about its axis", changed=_turned_over
    ),
    RepeatedRelease(name="swap-ends", sentence="swap the beam's ends", changed=_swapped),
    RepeatedRelease(
        name="heavier", sentence=f"hang {1e3 * HEAVIER:g} g more on the free end", changed=_heavier
    ),
    RepeatedRelease(name="longer-bar", sentence="release a beam that is 30 % longer", changed=_longer),
)
