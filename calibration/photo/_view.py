"""One photograph's camera and pose: from pixels to rays and from points to pixels.

Board frame [m]: x to the right along the board, z up, y away from the camera; the origin is the lower left
outer corner of the squares.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.photo._board import Board
from calibration.photo._camera import Camera, _object_points

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class View:
    """rotation (3, 3) and shift (3,) [m] from OpenCV's board frame (x, down, away) to the camera's."""

    camera: Camera
    rotation: Array
    shift: Array

    @property
    def eye(self) -> Array:
        """The camera's centre in the board frame, (3,) [m]."""
        return _upright(-self.rotation.T @ self.shift)

    @property
    def tilt(self) -> float:
        """Angle [rad] between the optical axis and the board's normal."""
        return float(np.arccos(np.clip(self.rotation[2, 2], -1.0, 1.0)))

    @property
    def roll(self) -> float:
        """Angle [rad] of the board's x direction in the picture, positive where it rises."""
        return float(np.arctan2(-self.rotation[1, 0], self.rotation[0, 0]))

    def directions(self, pixels: Array) -> Array:
        """Directions (k, 3) of the rays through pixels (k, 2), in the board frame."""
        flat = self.camera.normalised(pixels)
        return _upright(np.column_stack([flat, np.ones(len(flat))]) @ self.rotation)

    def on_plane(self, pixels: Array, y: float) -> Array:
        """Where the rays meet the plane y = constant [m]: x, z (k, 2) [m]."""
        eye, ray = self.eye, self.directions(pixels)
        return np.asarray((eye + ((y - eye[1]) / ray[:, 1])[:, None] * ray)[:, [0, 2]])

    def project(self, points: Array) -> Array:
        """Pixels (k, 2) of points (k, 3) [m]."""
        points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
        turned = np.column_stack([points[:, 0], -points[:, 2], points[:, 1]])
        seen = turned @ self.rotation.T + self.shift
        flat = seen[:, :2] / seen[:, 2:]
        square = flat[:, :1] ** 2 + flat[:, 1:] ** 2
        camera = self.camera
        bent = flat * (1.0 + camera.k1 * square + camera.k2 * square**2)
        return np.asarray(bent * camera.focal + camera.centre)


def locate(board: Board, camera: Camera) -> View:
    """The pose of the board in one photograph of a known camera."""
    points, pixels = _object_points(board), board.corners.reshape(-1, 2)
    matrix, bend = camera.matrix, camera.distortion
    found, turn, shift = cv2.solvePnP(points, pixels, matrix, bend, flags=cv2.SOLVEPNP_IPPE)
    if not found:
        raise InputError("camera: the board's corners fit no view of a plane")
    turn, shift = cv2.solvePnPRefineLM(points, pixels, matrix, bend, turn, shift)
    return View(
        camera=camera,
        rotation=np.asarray(cv2.Rodrigues(turn)[0], dtype=np.float64),
        shift=np.ravel(np.asarray(shift, dtype=np.float64)),
    )


def _upright(points: Array) -> Array:
    """(x, down, away) as (x, away, up)."""
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)
