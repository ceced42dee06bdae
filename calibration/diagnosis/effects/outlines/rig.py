"""Effects of rig and camera on photographed beams: they change the scene's supports, or its picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.measurements.outlines._effect import (
    OutlineEffect,
    Situation,
    bridge,
    cantilever,
)
from tisim import Beam

Array = NDArray[np.float64]

# -- grip-length --
# The grips hold deeper (positive) or shallower than their faces: the material is free that much inside.


def _bend_grip_length(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    ends = 2.0 if situation.trial.supports == "clamped-clamped" else 1.0
    return replace(beam, length=beam.length + ends * amplitude)


def _image_grip_length(points: Array, amplitude: float, _: Situation) -> Array:
    # the scene's x = 0 is where the material gets free, behind the face that the picture's x = 0 is
    return points - np.array([amplitude, 0.0])


GRIP_LENGTH = OutlineEffect(
    effect=catalogue.GRIP_LENGTH,
    step=1e-4,
    bounds=(-5e-3, 8e-3),
    prior_scale=3e-3,
    bend=_bend_grip_length,
    image=_image_grip_length,
)


# -- clamp-compliance --
# The clamps yield: they turn in proportion to the bending moment that they carry.


def _bend_clamp_compliance(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam,
        clamp_imperfections=replace(
            beam.clamp_imperfections, compliance=beam.clamp_imperfections.compliance + amplitude
        ),
    )


CLAMP_COMPLIANCE = OutlineEffect(
    effect=catalogue.CLAMP_COMPLIANCE,
    step=1.0,
    bounds=(0.0, 20.0),
    prior_scale=8.0,
    bend=_bend_clamp_compliance,
)


# -- clamp-tilt --
# The clamp is mounted askew: its face is turned, the beam leaves it upwards (positive) or downwards.


def _bend_clamp_tilt(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam,
        clamp_imperfections=replace(beam.clamp_imperfections, tilt=beam.clamp_imperfections.tilt + amplitude),
    )


CLAMP_TILT = OutlineEffect(
    effect=catalogue.CLAMP_TILT,
    step=5e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.05,
    bend=_bend_clamp_tilt,
)


# -- gravity-tilt --
# The whole rig leans in the plane of the picture: gravity is not along -z. Positive turns it towards +x.


def _bend_gravity_tilt(beam: Beam, amplitude: float, _: Situation) -> Beam:
    x, y, z = beam.gravity
    c, s = float(np.cos(amplitude)), float(np.sin(amplitude))
    return replace(beam, gravity=(c * x - s * z, y, s * x + c * z))


GRAVITY_TILT = OutlineEffect(
    effect=catalogue.GRAVITY_TILT,
    step=1e-2,
    bounds=(-0.2, 0.2),
    prior_scale=0.08,
    bend=_bend_gravity_tilt,
)


# -- free-length --
# A cantilever has slipped out of its grip: its free length is longer (positive) than measured.


def _bend_free_length(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(beam, length=beam.length + amplitude)


FREE_LENGTH = OutlineEffect(
    effect=catalogue.FREE_LENGTH,
    step=5e-4,
    bounds=(-8e-3, 8e-3),
    prior_scale=2e-3,
    bend=_bend_free_length,
    applies_to=cantilever,
)


# -- grip-squeeze --
# The grip squeezes the section that it holds: lower by this part, and wider by the same.


def _bend_grip_squeeze(beam: Beam, amplitude: float, _: Situation) -> Beam:
    return replace(
        beam,
        clamp_imperfections=replace(
            beam.clamp_imperfections, squeeze=beam.clamp_imperfections.squeeze + amplitude
        ),
    )


GRIP_SQUEEZE = OutlineEffect(
    effect=catalogue.GRIP_SQUEEZE,
    step=0.02,
    bounds=(0.0, 0.25),
    prior_scale=0.1,
    bend=_bend_grip_squeeze,
)


# -- clamp-gap --
# The bridge is slack (positive: its clamps are nearer to each other than its free length) or stretched.


def _bend_clamp_gap(beam: Beam, amplitude: float, _: Situation) -> Beam:
    # the clamps stay where they are seen; more material hangs between them
    dx, dz = beam.clamp_imperfections.far_shift
    return replace(
        beam,
        length=beam.length + amplitude,
        clamp_imperfections=replace(beam.clamp_imperfections, far_shift=(dx - amplitude, dz)),
    )


CLAMP_GAP = OutlineEffect(
    effect=catalogue.CLAMP_GAP,
    step=2e-4,
    bounds=(-5e-3, 5e-3),
    prior_scale=1.5e-3,
    bend=_bend_clamp_gap,
    applies_to=bridge,
)


# -- camera-roll --
# The camera is rolled against the rig's horizontal, in all photographs alike: positive lifts large x.


def _image_camera_roll(points: Array, amplitude: float, _: Situation) -> Array:
    c, s = np.cos(amplitude), np.sin(amplitude)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


CAMERA_ROLL = OutlineEffect(
    effect=catalogue.CAMERA_ROLL,
    step=3e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    image=_image_camera_roll,
    scopes=(),
)


# -- image-scale --
# The scale of all photographs is off by this part: things look larger where positive.


def _image_scale(points: Array, amplitude: float, _: Situation) -> Array:
    return points * (1.0 + amplitude)


IMAGE_SCALE = OutlineEffect(
    effect=catalogue.IMAGE_SCALE,
    step=3e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    image=_image_scale,
    scopes=(),
)


# -- lens-distortion --
# The lens distorts: points move away from the picture's middle by k r^2 of their distance r from it.


def _image_lens_distortion(points: Array, amplitude: float, situation: Situation) -> Array:
    # the middle of the picture is not in the file: the middle of the unbent beam stands for it
    away = points - np.array([0.5 * situation.trial.free_length, 0.0])
    return points + away * amplitude * (away**2).sum(axis=1, keepdims=True)


LENS_DISTORTION = OutlineEffect(
    effect=catalogue.LENS_DISTORTION,
    step=1.0,
    bounds=(-20.0, 20.0),
    prior_scale=8.0,
    image=_image_lens_distortion,
    scopes=(),
)
