"""Photographs in: grey values of one photograph."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError

Grey = NDArray[np.uint8]

_SMALLEST = 400  # pixels; below that a board and a beam do not fit in with any precision


def read_photograph(path: Path) -> Grey:
    """Grey values (height, width), turned upright as the camera's EXIF orientation says.

    Raises InputError where the file is missing, is no image, or is too small to measure in.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such photograph")
    data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
    image = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE) if len(data) else None
    if image is None:
        raise InputError(f"{path}: expected a PNG, JPEG or TIFF photograph, it cannot be decoded")
    if min(image.shape) < _SMALLEST:
        raise InputError(
            f"{path}: expected at least {_SMALLEST} pixels a side, it is {image.shape[1]} x {image.shape[0]}"
        )
    return np.asarray(image, dtype=np.uint8)
