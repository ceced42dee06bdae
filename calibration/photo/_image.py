"""Photographs in, marks drawn on them, and the error that shows what was found in one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError

Picture = NDArray[np.uint8]


class PhotoProblem(InputError):  # noqa: N818 - a fault of the photograph, not of the program
    """One sentence; picture: the photograph with what was found drawn in, (height, width, 3) BGR, or None."""

    def __init__(self, sentence: str, picture: Picture | None = None) -> None:
        super().__init__(sentence)
        self.picture = picture


class UnusablePhotographs(InputError):  # noqa: N818 - a fault of the photographs, not of the program
    """Some photographs of an experiment cannot be used; problems: a sentence by the capture's name."""

    def __init__(self, sentence: str, problems: dict[str, str]) -> None:
        super().__init__(sentence)
        self.problems = problems


Grey = NDArray[np.uint8]

_SMALLEST = 400  # pixels; below that a board and a beam do not fit in with any precision


def read_photograph(path: Path) -> Grey:
    """Grey values (height, width), turned upright as the camera's EXIF orientation says.

    Raises InputError where the file is missing, is no image, or is too small to measure in.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such photograph")
    data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    depth = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH
    image = cv2.imdecode(data, depth) if len(data) else None
    if image is None:
        raise InputError(f"{path}: expected a PNG, JPEG or TIFF photograph, it cannot be decoded")
    if image.dtype == np.uint16:  # of which a camera may use 10 or 12 bits
        image = np.right_shift(image.astype(np.uint16), max(int(image.max()).bit_length() - 8, 0))
    elif image.dtype != np.uint8:
        raise InputError(f"{path}: expected grey values of 8 or 16 bits, they are {image.dtype}")
    if min(image.shape) < _SMALLEST:
        raise InputError(
            f"{path}: expected at least {_SMALLEST} pixels a side, it is {image.shape[1]} x {image.shape[0]}"
        )
    return np.asarray(image, dtype=np.uint8)


Array = NDArray[np.float64]

ORANGE, BLUE, GREEN, RED = (0, 140, 255), (255, 120, 0), (60, 180, 0), (40, 40, 230)
_SHIFT = 4  # fixed-point bits of OpenCV's drawing


def shrink(image: NDArray[np.uint8], factor: int) -> NDArray[np.uint8]:
    """The picture at 1/factor of its size."""
    if factor == 1:
        return image
    small = cv2.resize(image, None, fx=1 / factor, fy=1 / factor, interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


def coloured(image: NDArray[np.uint8]) -> Picture:
    """A grey picture, ready for coloured marks."""
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), dtype=np.uint8)


def draw_line(
    picture: Picture, points: Array, colour: tuple[int, int, int], *, closed: bool = False
) -> Picture:
    """A polyline (k, 2) [px], with a width that shows at the picture's size."""
    width = max(1, round(max(picture.shape) / 500))
    fixed = np.rint(np.asarray(points) * (1 << _SHIFT)).astype(np.int32).reshape(1, -1, 2)
    cv2.polylines(picture, list(fixed), closed, colour, width, cv2.LINE_AA, _SHIFT)
    return picture


def draw_points(picture: Picture, points: Array, colour: tuple[int, int, int]) -> Picture:
    """Rings about points (k, 2) [px]."""
    radius = max(3, round(max(picture.shape) / 250))
    for x, y in np.asarray(points).reshape(-1, 2):
        cv2.circle(
            picture, (round(float(x)), round(float(y))), radius, colour, max(1, radius // 3), cv2.LINE_AA
        )
    return picture


def draw_corners(image: NDArray[np.uint8], corners: Array) -> Picture:
    """A grey photograph with corners (k, 2) [px] ringed."""
    return draw_points(coloured(image), corners, ORANGE)


def draw_mask(image: NDArray[np.uint8], masks: Sequence[NDArray[np.bool_]]) -> Picture:
    """A grey photograph with regions tinted, one colour each."""
    picture = coloured(image)
    for mask, colour in zip(masks, (ORANGE, BLUE, GREEN, RED) * len(masks), strict=False):
        picture[mask] = (0.5 * picture[mask] + 0.5 * np.array(colour)).astype(np.uint8)
    return picture
