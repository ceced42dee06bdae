"""How effects act on a cantilever release: clamp, load and cameras."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.diagnosis import catalogue
from calibration.measurements.release._beam import BeamParameters, Pair
from calibration.measurements.release._effect import ReleaseEffect, hung

# -- clamp-compliance --
# The clamp yields: it turns in proportion to the bending moment that it carries.


def _alter_clamp_compliance(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, clamp_compliance=s.clamp_compliance + amplitude)


CLAMP_COMPLIANCE = ReleaseEffect(
    effect=catalogue.CLAMP_COMPLIANCE,
    step=1e-05,
    bounds=(0.0, 1.0),
    prior_scale=0.2,
    alter=_alter_clamp_compliance,
    scopes=("load", "trial"),
)


# -- clamp-sag --
# The clamp yields: it sinks in proportion to the force that it carries.


def _alter_clamp_sag(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, clamp_sag=s.clamp_sag + amplitude)


CLAMP_SAG = ReleaseEffect(
    effect=catalogue.CLAMP_SAG,
    step=1e-07,
    bounds=(0.0, 3e-3),
    prior_scale=5e-4,
    alter=_alter_clamp_sag,
    scopes=("load", "trial"),
)


# -- grip-length --
# The clamp holds deeper (positive) or shallower than its face: the beam is free that much inside.


def _alter_grip_length(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, grip_depth=s.grip_depth + amplitude)


GRIP_LENGTH = ReleaseEffect(
    effect=catalogue.GRIP_LENGTH,
    step=1e-06,
    bounds=(-1e-2, 1e-2),
    prior_scale=3e-3,
    alter=_alter_grip_length,
    scopes=("load", "trial"),
    action="clamp a metal bar and measure where the clamp holds it",
)


# -- gravity-tilt --
# The whole rig leans in the plane of the vibration: weights do not act as stated. Positive turns them to +x.


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
    scopes=("load", "trial"),
    action="level the rig, or hang a plumb line in view",
)


# -- air-drag --
# Something drags on the beam in proportion to its speed and mass (mass-proportional damping).


def _alter_air_drag(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, mass_damping=s.mass_damping + amplitude)


AIR_DRAG = ReleaseEffect(
    effect=catalogue.AIR_DRAG,
    step=0.0002,
    bounds=(0.0, 20.0),
    prior_scale=1.0,
    alter=_alter_air_drag,
    scopes=("load", "trial"),
)


# -- added-mass --
# More (or less) mass hangs on the free end than stated, with its weight and its inertia.


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
    scopes=("load", "trial"),
    action="weigh what hangs on the free end: markers, string and hook too",
)


# -- load-height --
# The hung mass acts above (or below) the middle of the end face: its arm changes as the face turns.


def _alter_load_height(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, load_height=s.load_height + amplitude)


LOAD_HEIGHT = ReleaseEffect(
    effect=catalogue.LOAD_HEIGHT,
    step=1e-05,
    bounds=(-5e-2, 5e-2),
    prior_scale=2e-2,
    alter=_alter_load_height,
    applies_to=hung,
    scopes=("load", "trial"),
)


# -- loose-load --
# The hung mass is tied loosely: its weight acts, but this part of its inertia does not move with the beam
# (on a string it swings behind).


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
    scopes=("load", "trial"),
)


# -- rubbing-load --
# What hangs on the beam rubs where it is fixed (Coulomb): beside its damping the swing loses the same
# amplitude in each quarter of a period, four of what friction holds a period, until it stops.


def _alter_rubbing_load(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, rubbing=s.rubbing + amplitude)


RUBBING_LOAD = ReleaseEffect(
    effect=catalogue.RUBBING_LOAD,
    step=1e-07,
    bounds=(0.0, 2e-3),
    prior_scale=2e-4,
    alter=_alter_rubbing_load,
    applies_to=hung,
    further=True,
    scopes=("load", "trial"),
)


# -- held-pose --
# The beam is held above or below straight before it is let go, in the shape of its equilibrium: displacements
# are counted from there, so that it comes down less (positive) or more.


def _alter_held_pose(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, held_below=s.held_below + amplitude)


HELD_POSE = ReleaseEffect(
    effect=catalogue.HELD_POSE,
    step=1e-07,
    bounds=(-2e-3, 2e-3),
    prior_scale=3e-4,
    alter=_alter_held_pose,
    further=True,
    scopes=("load", "trial"),
)


# -- image-scale --
# The cameras show displacements too large (positive) or too small.


def _alter_image_scale(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, image_scale=s.image_scale + amplitude)


IMAGE_SCALE = ReleaseEffect(
    effect=catalogue.IMAGE_SCALE,
    step=1e-05,
    bounds=(-0.2, 0.2),
    prior_scale=0.01,
    alter=_alter_image_scale,
    scopes=("load", "trial"),
    action="move a marker by a known distance in view",
)


# -- camera-roll --
# The cameras' frame is turned about y against the beam's, in all trials alike.


def _alter_camera_roll(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, camera_roll=s.camera_roll + amplitude)


CAMERA_ROLL = ReleaseEffect(
    effect=catalogue.CAMERA_ROLL,
    step=1e-05,
    bounds=(-0.3, 0.3),
    prior_scale=0.04,
    alter=_alter_camera_roll,
    scopes=("load", "trial"),
    action="put a gauge along the beam in view",
)


# -- clock-rate --
# The cameras' clock is slow (positive: more time has passed than they say) or fast.


def _alter_clock_rate(s: BeamParameters, amplitude: float, _: float | None) -> BeamParameters:
    return replace(s, clock_rate=s.clock_rate + amplitude)


CLOCK_RATE = ReleaseEffect(
    effect=catalogue.CLOCK_RATE,
    step=1e-06,
    bounds=(-0.2, 0.2),
    prior_scale=0.002,
    alter=_alter_clock_rate,
    scopes=("load", "trial"),
)
