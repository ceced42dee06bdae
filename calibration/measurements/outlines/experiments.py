"""Next experiments for beams: other photographs of the same specimens, and direct measurements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from calibration.experiment.model import BeamTrial
from calibration.measurements._design import Gauge
from calibration.measurements.outlines._effect import cantilever
from tisim import Beam

GRAVITY = 9.81
TIP_MASS = 0.005  # [kg]
OTHER_LENGTH = 0.075  # [m]
LATER = 1e4  # [s]


def _as_it_is(beam: Beam, trial: BeamTrial) -> Beam:
    del trial
    return beam


@dataclass(frozen=True, kw_only=True)
class Photographs:
    """Photographs of the same specimens in another pose.

    Attributes
    ----------
    name : name of the experiment.
    sentence : instruction for the lab.
    trial : function from a trial to the changed trial; None if it cannot be done.
    pose : function of (scene, trial) that transforms the specimen's imperfections in the scene.
    time : time of the photograph since release [s].
    """

    name: str
    sentence: str
    trial: Callable[[BeamTrial], BeamTrial | None]
    pose: Callable[[Beam, BeamTrial], Beam] = _as_it_is
    time: float = 100.0


def _turned(beam: Beam, _: BeamTrial) -> Beam:
    s = beam.imperfections
    turned = replace(s, curvature=-s.curvature, transverse_gradient=-s.transverse_gradient)
    return replace(beam, imperfections=turned)


def _swapped(beam: Beam, trial: BeamTrial) -> Beam:
    """Scene with the ends of the specimen swapped: a point at x from the clamp moves to L - x.

    The gripped part of a cantilever becomes free and its free end is gripped: x moves to L - x - grip length.
    A void that would lie in the grip is left out.
    """
    s = beam.imperfections
    held = trial.grip_length if cantilever(trial) else 0.0
    at = trial.free_length - held - s.void.position if s.void else 0.0
    void = replace(s.void, position=at) if s.void and at > 0.0 else None
    swapped = replace(
        s,
        axial_gradient=-s.axial_gradient,
        density_gradient=-s.density_gradient,
        taper=-s.taper,
        void=void,
    )
    return replace(beam, imperfections=swapped)


def _same(trial: BeamTrial) -> BeamTrial:
    return trial


def _hung(trial: BeamTrial) -> BeamTrial | None:
    return replace(trial, gravity=(GRAVITY, 0.0, 0.0)) if cantilever(trial) else None


def _deeper(trial: BeamTrial) -> BeamTrial | None:
    """Cantilever pushed deeper into its grip; None if it is too short, since it cannot be pulled out."""
    fits = cantilever(trial) and trial.free_length > OTHER_LENGTH
    return replace(trial, free_length=OTHER_LENGTH) if fits else None


def _loaded(trial: BeamTrial) -> BeamTrial | None:
    return replace(trial, tip_force=(0.0, 0.0, -TIP_MASS * GRAVITY)) if cantilever(trial) else None


# The cheapest first: the first that separates the explanations is recommended.
EXPERIMENTS: tuple[Photographs | Gauge, ...] = (
    Gauge(
        name="weigh",
        sentence="weigh the specimens",
        sds={"density": 2e-3, "added-mass": 2e-5},
    ),
    Gauge(
        name="callipers",
        sentence="measure the section with callipers, at both ends and next to the clamp",
        sds={"radius": 2e-5, "taper": 0.03, "grip-squeeze": 5e-3},
    ),
    Gauge(
        name="level",
        sentence="lay a spirit level on the clamp and on the rig, and hang a plumb line into the picture",
        sds={"clamp-tilt": 2e-3, "gravity-tilt": 2e-3, "camera-roll": 2e-3},
    ),
    Gauge(
        name="gauge-block",
        sentence="measure the free lengths and the distance of the clamps with a gauge block",
        sds={"free-length": 5e-5, "clamp-gap": 5e-5, "image-scale": 1e-3},
    ),
    Photographs(
        name="turn-over",
        sentence="turn the beams by 180 degrees about their axis and photograph them again",
        trial=_same,
        pose=_turned,
    ),
    Photographs(
        name="swap-ends",
        sentence="swap the ends of the beams and photograph them again",
        trial=_same,
        pose=_swapped,
    ),
    Photographs(
        name="hang",
        sentence="hang the cantilevers straight down and photograph them",
        trial=_hung,
    ),
    Photographs(
        name="other-length",
        sentence=f"photograph cantilevers of {1e3 * OTHER_LENGTH:.0f} mm free length",
        trial=_deeper,
    ),
    Photographs(
        name="tip-mass",
        sentence=f"hang {1e3 * TIP_MASS:.0f} g on the free end of each cantilever and photograph them",
        trial=_loaded,
    ),
    Photographs(
        name="later",
        sentence=f"photograph the beams again {LATER / 3600:.1f} h after their release",
        trial=_same,
        time=LATER,
    ),
    Gauge(
        name="metal-bar",
        sentence="clamp a metal bar instead of a beam: measure where the grip holds it, and how far it turns"
        " under a known weight",
        sds={"grip-length": 1e-4, "clamp-compliance": 0.2},
    ),
    Gauge(
        name="lens",
        sentence="calibrate the camera's lens with a board in several poses",
        sds={"lens-distortion": 0.2, "image-scale": 1e-3},
    ),
    Gauge(
        name="cut",
        sentence="cut the beam open and look",
        sds={"void": 0.03, "skin": 0.05},
    ),
)
