"""The camera: a bundle adjustment over all boards of one camera, and its pose in each photograph.

One view square on to the board says nothing about the focal length, one tilted view something, several all of
it. Priors wide enough for any camera make the same least squares hold in each case; what the views cannot say
shows as a large standard deviation (`Camera.focal_sd`), and the known diameter of the specimen then decides
(`_frame.settle`). Model: OpenCV's pinhole with radial k1, k2 (Brown), square pixels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.errors import InputError
from calibration.photo._board import Board

Array = NDArray[np.float64]

_FOCAL_SD = 0.6  # of ln(focal length), about the longer side of the picture: 14 to 85 mm lenses within 1.5 sd
_CENTRE_SD = 0.01  # of the principal point, in picture widths
_BEND_SD = (0.03, 0.01)  # distortion at the picture's corner by k1 and by k2, as a part of its radius
_INTRINSICS = 5
_SUSPECT = 0.3  # [px]: corners are found to 0.1
_OTHER_FOCALS = (0.5, 2.0, 4.0)  # of the first start's


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A pinhole camera with radial distortion.

    Attributes
    ----------
    focal, focal_sd : float
        Focal length [px] and its relative standard deviation.
    centre : tuple
        Principal point [px].
    k1, k2 : float
        Radial distortion (Brown).
    noise : float
        Standard deviation of one coordinate of a corner [px].
    views : int
        Photographs that it was calibrated on.
    """

    focal: float
    focal_sd: float
    centre: tuple[float, float]
    k1: float
    k2: float
    noise: float
    views: int

    @property
    def matrix(self) -> Array:
        """OpenCV's camera matrix."""
        return np.array(
            [[self.focal, 0.0, self.centre[0]], [0.0, self.focal, self.centre[1]], [0.0, 0.0, 1.0]]
        )

    @property
    def distortion(self) -> Array:
        """OpenCV's coefficients."""
        return np.array([self.k1, self.k2, 0.0, 0.0, 0.0])

    def with_focal(self, focal: float) -> Camera:
        """The same lens drawn to another focal length: distortion in pixels stays what the board showed."""
        ratio = focal / self.focal
        return replace(self, focal=focal, k1=self.k1 * ratio**2, k2=self.k2 * ratio**4)

    def normalised(self, pixels: Array) -> Array:
        """Undistorted image coordinates (k, 2), by Newton on the radius."""
        bent = (np.asarray(pixels) - self.centre) / self.focal
        far = np.linalg.norm(bent, axis=1)
        r = far.copy()
        for _ in range(20):
            value = r * (1 + self.k1 * r**2 + self.k2 * r**4) - far
            slope = 1 + 3 * self.k1 * r**2 + 5 * self.k2 * r**4
            if (slope <= 0.05).any():
                raise InputError(
                    "camera: the distortion found folds the picture over; add views of the board"
                )
            r = r - value / slope
            if np.abs(value).max(initial=0.0) < 1e-13:
                break
        return np.asarray(bent * np.where(far > 0, r / np.where(far > 0, far, 1.0), 1.0)[:, None])


def calibrate(boards: list[Board]) -> Camera:
    """The camera that took these boards (at least one; all photographs of one size).

    Raises InputError where the boards fit no camera.
    """
    size = np.array(boards[0].size, dtype=np.float64)
    middle = (size - 1) / 2
    focal = float(size.max()) * 1.1
    corner = float(np.linalg.norm(middle)) / focal
    prior = np.array([np.log(focal), *middle, 0.0, 0.0])
    sd = np.array(
        [_FOCAL_SD, *(2 * [_CENTRE_SD * size[0]]), _BEND_SD[0] / corner**2, _BEND_SD[1] / corner**4]
    )
    objects = [_object_points(board) for board in boards]
    pixels = [board.corners.reshape(-1, 2) for board in boards]
    noise, p, problem = _adjust(objects, pixels, prior, sd, focal)
    if noise > _SUSPECT:  # a bent board, or one view's least squares ended in a side minimum: from elsewhere
        others = [_adjust(objects, pixels, prior, sd, ratio * focal) for ratio in _OTHER_FOCALS]
        noise, p, problem = min([(noise, p, problem), *others], key=lambda found: found[0])
    jacobian = problem.jacobian(p)
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    if noise > 3.0:
        raise InputError(f"camera: the board's corners miss a flat board by {noise:.1f} pixels; is it bent?")
    return Camera(
        focal=float(np.exp(p[0])),
        focal_sd=float(np.sqrt(covariance[0, 0])),
        centre=(float(p[1]), float(p[2])),
        k1=float(p[3]),
        k2=float(p[4]),
        noise=noise,
        views=len(boards),
    )


def _adjust(
    objects: list[Array], pixels: list[Array], prior: Array, sd: Array, focal: float
) -> tuple[float, Array, _Bundle]:
    """Corners' noise [px], parameters and problem of the bundle adjustment that starts at a focal length."""
    first = np.concatenate([[np.log(focal)], prior[1:]])
    start = [first]
    for points, seen in zip(objects, pixels, strict=True):
        found, turn, shift = cv2.solvePnP(points, seen, _matrix(first), np.zeros(5), flags=cv2.SOLVEPNP_IPPE)
        if not found:
            raise InputError("camera: the board's corners fit no view of a plane")
        start.append(np.concatenate([np.ravel(turn), np.ravel(shift)]))
    noise = 0.1
    p = np.concatenate(start)
    for _ in range(3):  # the corners' noise weighs them against the priors
        problem = _Bundle(objects, pixels, prior, sd, noise)
        fit = least_squares(
            problem.residual, p, jac=problem.jacobian, x_scale="jac", method="trf", xtol=1e-12
        )
        p = fit.x
        data = fit.fun[_INTRINSICS:] * noise
        noise = max(float(np.sqrt((data**2).sum() / max(len(data) - len(p) + 2, 1))), 0.01)
    return noise, p, problem


def _matrix(p: Array) -> Array:
    f = float(np.exp(p[0]))
    return np.array([[f, 0.0, p[1]], [0.0, f, p[2]], [0.0, 0.0, 1.0]])


def _object_points(board: Board) -> Array:
    """Corners in OpenCV's sense: x right, y down, z = 0 on the board [m]."""
    flat = board.points.reshape(-1, 2)
    return np.column_stack([flat[:, 0], -flat[:, 1], np.zeros(len(flat))])


class _Bundle:
    """Residuals in standard deviations: priors first, then corners view by view."""

    def __init__(
        self, objects: list[Array], pixels: list[Array], prior: Array, sd: Array, noise: float
    ) -> None:
        self.objects, self.pixels, self.prior, self.sd, self.noise = objects, pixels, prior, sd, noise

    def residual(self, p: Array) -> Array:
        parts = [(p[:_INTRINSICS] - self.prior) / self.sd]
        for number, (points, seen) in enumerate(zip(self.objects, self.pixels, strict=True)):
            parts.append((self._project(p, number, points)[0] - seen).ravel() / self.noise)
        return np.concatenate(parts)

    def jacobian(self, p: Array) -> Array:
        blocks = []
        for number, points in enumerate(self.objects):
            raw = self._project(p, number, points)[1]
            block = np.zeros((2 * len(points), len(p)))
            # OpenCV's columns: turn 0-2, shift 3-5, fx fy 6-7, cx cy 8-9, k1 k2 10-11
            block[:, 0] = (raw[:, 6] + raw[:, 7]) * np.exp(p[0])
            block[:, 1:3], block[:, 3:5] = raw[:, 8:10], raw[:, 10:12]
            at = _INTRINSICS + 6 * number
            block[:, at : at + 6] = raw[:, :6]
            blocks.append(block / self.noise)
        top = np.zeros((_INTRINSICS, len(p)))
        top[:, :_INTRINSICS] = np.diag(1 / self.sd)
        return np.vstack([top, *blocks])

    def _project(self, p: Array, number: int, points: Array) -> tuple[Array, Array]:
        at = _INTRINSICS + 6 * number
        bend = np.array([p[3], p[4], 0.0, 0.0, 0.0])
        seen, raw = cv2.projectPoints(points, p[at : at + 3], p[at + 3 : at + 6], _matrix(p), bend)
        return np.asarray(seen, np.float64).reshape(-1, 2), np.asarray(raw, np.float64)


@dataclass(frozen=True, eq=False, kw_only=True)
class View:
    """Pose of a camera to the board in one photograph.

    Attributes
    ----------
    camera : Camera
    rotation, shift : array, shape (3, 3), (3,)
        Map from OpenCV's board frame (x, down, away) to the camera's [m].
    """

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
        """Intersections of the rays with the plane y = constant [m]: x, z (k, 2) [m]."""
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
