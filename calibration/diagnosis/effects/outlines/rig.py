"""Effects of rig and camera in photographs of beams: changes of the scene's supports or of its image."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.measurements._effect import added_to
from calibration.measurements.outlines._effect import (
    OutlineEffect,
    Situation,
    bridge,
    cantilever,
)
from tisim import Beam

Array = NDArray[np.float64]

# -- grip-length --
# The grips hold the beam this far behind (positive) or in front of their faces.


def _bend_grip_length(beam: Beam, amplitude: float, situation: Situation) -> Beam:
    ends = 2.0 if situation.trial.supports == "clamped-clamped" else 1.0
    return replace(beam, length=beam.length + ends * amplitude)


def _image_grip_length(points: Array, amplitude: float, _: Situation) -> Array:
    # x = 0 is the end of the grip in the scene, but the face of the grip in the image
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
# Compliant clamps: they rotate in proportion to their bending moment.


CLAMP_COMPLIANCE = OutlineEffect(
    effect=catalogue.CLAMP_COMPLIANCE,
    step=1.0,
    bounds=(0.0, 20.0),
    prior_scale=8.0,
    bend=added_to(Beam, "clamp_imperfections.compliance"),
)


# -- clamp-tilt --
# Tilted clamp: its face is rotated, so that the beam leaves it upwards (positive) or downwards.


CLAMP_TILT = OutlineEffect(
    effect=catalogue.CLAMP_TILT,
    step=5e-3,
    bounds=(-0.1, 0.1),
    prior_scale=0.05,
    bend=added_to(Beam, "clamp_imperfections.tilt"),
)


# -- gravity-tilt --
# The rig is tilted in the image plane: gravity is not along -z but rotated towards +x (positive).


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
# A cantilever has slipped in its grip: its free length is longer (positive) or shorter than measured.


FREE_LENGTH = OutlineEffect(
    effect=catalogue.FREE_LENGTH,
    step=5e-4,
    bounds=(-8e-3, 8e-3),
    prior_scale=2e-3,
    bend=added_to(Beam, "length"),
    applies_to=cantilever,
)


# -- grip-squeeze --
# The grip squeezes the section: its height is smaller, and its width larger, by this fraction.


GRIP_SQUEEZE = OutlineEffect(
    effect=catalogue.GRIP_SQUEEZE,
    step=0.02,
    bounds=(0.0, 0.25),
    prior_scale=0.1,
    bend=added_to(Beam, "clamp_imperfections.squeeze"),
)


# -- clamp-gap --
# The bridge is slack (positive: its clamps are closer together than its free length) or stretched.


def _bend_clamp_gap(beam: Beam, amplitude: float, _: Situation) -> Beam:
    # the clamps keep their observed positions; the length of the beam between them changes
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
# The camera is rolled relative to the rig's horizontal, equally in all photographs: positive lifts large x.


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
# Scale error of all photographs by this fraction: objects look larger if positive.


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
# Radial lens distortion: points at distance r from the image centre move outwards by k r^3.


def _image_lens_distortion(points: Array, amplitude: float, situation: Situation) -> Array:
    # the image centre is not in the file; it is approximated by the centre of the undeformed beam
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
