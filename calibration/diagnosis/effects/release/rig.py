"""Effects in cantilever release tests: clamp, load and cameras."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.diagnosis import catalogue
from calibration.measurements._effect import added_to
from calibration.measurements.release._beam import BeamParameters, Pair
from calibration.measurements.release._effect import ReleaseEffect, hung

SCOPES = ("load", "trial")

# -- clamp-compliance --
# Compliant clamp: it rotates in proportion to its bending moment.


CLAMP_COMPLIANCE = ReleaseEffect(
    effect=catalogue.CLAMP_COMPLIANCE,
    step=1e-05,
    bounds=(0.0, 1.0),
    prior_scale=0.2,
    alter=added_to(BeamParameters, "clamp_compliance"),
    scopes=SCOPES,
)


# -- clamp-sag --
# Compliant clamp: it sinks in proportion to its force.


CLAMP_SAG = ReleaseEffect(
    effect=catalogue.CLAMP_SAG,
    step=1e-07,
    bounds=(0.0, 3e-3),
    prior_scale=5e-4,
    alter=added_to(BeamParameters, "clamp_sag"),
    scopes=SCOPES,
)


# -- grip-length --
# The clamp holds the beam this far behind (positive) or in front of its face.


GRIP_LENGTH = ReleaseEffect(
    effect=catalogue.GRIP_LENGTH,
    step=1e-06,
    bounds=(-1e-2, 1e-2),
    prior_scale=3e-3,
    alter=added_to(BeamParameters, "grip_depth"),
    scopes=SCOPES,
    action="clamp a metal bar and measure where the clamp holds it",
)


# -- gravity-tilt --
# The rig is tilted in the plane of vibration: gravity is rotated, towards +x if positive.


def _turned(v: Pair, angle: float) -> Pair:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return c * v[0] - s * v[1], s * v[0] + c * v[1]


def _alter_gravity_tilt(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, gravity=_turned(s.gravity, amplitude), tip_force=_turned(s.tip_force, amplitude))


GRAVITY_TILT = ReleaseEffect(
    effect=catalogue.GRAVITY_TILT,
    step=0.0001,
    bounds=(-0.4, 0.4),
    prior_scale=0.08,
    alter=_alter_gravity_tilt,
    scopes=SCOPES,
    action="level the rig, or hang a plumb line in view",
)


# -- air-drag --
# Mass-proportional damping: a drag force proportional to velocity and mass.


AIR_DRAG = ReleaseEffect(
    effect=catalogue.AIR_DRAG,
    step=0.0002,
    bounds=(0.0, 20.0),
    prior_scale=1.0,
    alter=added_to(BeamParameters, "mass_damping"),
    scopes=SCOPES,
)


# -- added-mass --
# The mass on the free end is larger (or smaller) than stated, in weight and inertia.


def _alter_added_mass(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    gx, gz = s.gravity
    fx, fz = s.tip_force
    return replace(s, tip_mass=s.tip_mass + amplitude, tip_force=(fx + amplitude * gx, fz + amplitude * gz))


ADDED_MASS = ReleaseEffect(
    effect=catalogue.ADDED_MASS,
    step=2e-06,
    bounds=(-2e-2, 4e-2),
    prior_scale=5e-3,
    alter=_alter_added_mass,
    scopes=SCOPES,
    action="weigh what hangs on the free end: markers, string and hook too",
)


# -- load-height --
# The hung mass acts above (or below) the centre of the end face: its lever arm changes as the face rotates.


LOAD_HEIGHT = ReleaseEffect(
    effect=catalogue.LOAD_HEIGHT,
    step=1e-05,
    bounds=(-5e-2, 5e-2),
    prior_scale=2e-2,
    alter=added_to(BeamParameters, "load_height"),
    applies_to=hung,
    scopes=SCOPES,
)


# -- loose-load --
# Loosely attached mass: its weight acts, but this fraction of its inertia does not move with the beam (as if
# it hangs on a string).


def _alter_loose_load(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, tip_mass=(1.0 - amplitude) * s.tip_mass)


LOOSE_LOAD = ReleaseEffect(
    effect=catalogue.LOOSE_LOAD,
    step=1e-04,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),
    prior_scale=0.2,
    alter=_alter_loose_load,
    applies_to=hung,
    further=True,
    scopes=SCOPES,
)


# -- rubbing-load --
# Coulomb friction at the attachment of the hung mass: in addition to viscous damping, the vibration loses the
# same amplitude in each quarter period, four times the displacement that friction can hold in each period,
# until it stops.


RUBBING_LOAD = ReleaseEffect(
    effect=catalogue.RUBBING_LOAD,
    step=1e-07,
    bounds=(0.0, 2e-3),
    prior_scale=2e-4,
    alter=added_to(BeamParameters, "rubbing"),
    applies_to=hung,
    further=True,
    scopes=SCOPES,
)


# -- held-pose --
# Before release the beam is held below (positive) or above its straight position, in the shape of its
# deflection at equilibrium. Displacements are relative to that position, so that they are smaller or larger.


HELD_POSE = ReleaseEffect(
    effect=catalogue.HELD_POSE,
    step=1e-07,
    bounds=(-2e-3, 2e-3),
    prior_scale=3e-4,
    alter=added_to(BeamParameters, "held_below"),
    further=True,
    scopes=SCOPES,
)


# -- image-scale --
# Scale error of the cameras: displacements are too large (positive) or too small.


IMAGE_SCALE = ReleaseEffect(
    effect=catalogue.IMAGE_SCALE,
    step=1e-05,
    bounds=(-0.2, 0.2),
    prior_scale=0.01,
    alter=added_to(BeamParameters, "image_scale"),
    scopes=SCOPES,
    action="move a marker by a known distance in view",
)


# -- camera-roll --
# The camera frame is rotated about y relative to the beam's frame.


CAMERA_ROLL = ReleaseEffect(
    effect=catalogue.CAMERA_ROLL,
    step=1e-05,
    bounds=(-0.3, 0.3),
    prior_scale=0.04,
    alter=added_to(BeamParameters, "camera_roll"),
    scopes=SCOPES,
    action="put a gauge along the beam in view",
)


# -- clock-rate --
# The cameras' clock is slow (positive: more time has passed than recorded) or fast.


CLOCK_RATE = ReleaseEffect(
    effect=catalogue.CLOCK_RATE,
    step=1e-06,
    bounds=(-0.2, 0.2),
    prior_scale=0.002,
    alter=added_to(BeamParameters, "clock_rate"),
    scopes=SCOPES,
)
