"""Camera calibration from corners of a board at known positions."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.blind.camera import Lens, View
from calibration.photo import Board, calibrate

LENS = Lens(size=(1600, 1200), focal=3720.0, centre=(803.0, 594.0), k1=-0.05)
COLUMNS, ROWS, SQUARE = 8, 5, 0.008
LOWER_LEFT = (12.0, 26.0)  # outer corner of the squares in the camera's frame [mm]


def board(view: View, seed: int, noise: float = 0.03) -> Board:
    """The board's corners in the image of a camera, with noise of `noise` px."""
    i, j = np.meshgrid(np.arange(1, COLUMNS + 1), np.arange(1, ROWS + 1))
    points = SQUARE * np.stack([i, j], axis=-1)
    flat = 1e3 * points.reshape(-1, 2) + LOWER_LEFT
    eye, axes = view.frame()
    seen = (np.insert(flat, 1, 10.0, axis=1) - eye) @ axes.T
    plain = seen[:, :2] / seen[:, 2:]
    bent = plain * (1.0 + LENS.k1 * (plain**2).sum(axis=1, keepdims=True))
    pixels = LENS.focal * bent + LENS.centre
    pixels += np.random.default_rng(seed).normal(0.0, noise, pixels.shape)
    return Board(
        corners=pixels.reshape(ROWS, COLUMNS, 2),
        points=points,
        square=SQUARE,
        squares=(COLUMNS + 1, ROWS + 1),
        blur=2.0,
        size=LENS.size,
    )


@pytest.mark.parametrize("seed", range(12))
def test_one_view_ends_in_no_side_minimum(seed: int) -> None:
    """The lens has twice the initial focal length; the corners are reproduced to their noise nevertheless."""
    rng = np.random.default_rng(seed)
    view = View(
        target=(46.0, 0.0, 11.0),
        distance=450.0,
        yaw=float(rng.uniform(5.0, 14.0)),
        pitch=float(rng.uniform(6.0, 14.0)),
        roll=float(rng.uniform(-3.0, 3.0)),
    )
    camera = calibrate([board(view, seed)])
    assert camera.noise < 0.06
    assert abs(np.log(camera.focal / LENS.focal)) < 4 * camera.focal_sd
