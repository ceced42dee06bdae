"""The checkerboard in a photograph: its inner corners to sub-pixel, or why it is not there."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import Checkerboard
from calibration.photo._image import Grey, PhotoProblem, coloured, draw_corners, shrink

Array = NDArray[np.float64]

_PIXELS = 7e5  # larger photographs are searched at reduced size; corners are refined at full size
_BLURRED = 9.0  # pixels from 10 to 90 % across an edge; a sharp photograph has 2 to 4
_PARTS = 150  # smaller boards, the largest first, that are looked for where the whole is not found
_FLAGS = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE


@dataclass(frozen=True, eq=False, kw_only=True)
class Board:
    """A checkerboard in a photograph.

    Attributes
    ----------
    corners : array, shape (rows, columns, 2)
        Inner corners [px]; rows count upwards, columns to the right.
    points : array, shape (rows, columns, 2)
        The same corners on the board, x, z from the lower left outer corner of the squares [m].
    square : float
        Side of a square [m].
    squares : tuple of int
        Squares along the two sides.
    blur : float
        Width of the edges, 10 to 90 % [px].
    size : tuple of int
        Size of the photograph, (width, height) [px].
    """

    corners: Array
    points: Array
    square: float
    squares: tuple[int, int]
    blur: float
    size: tuple[int, int]


def find_board(image: Grey, board: Checkerboard) -> Board:
    """The board, upright: its first side runs along the photograph's width.

    Raises PhotoProblem where it is absent, cut off, covered, blurred or lies on its side.
    """
    columns, rows = board.squares[0] - 1, board.squares[1] - 1
    corners = _search(image, columns, rows)
    if corners is None:
        raise _why_not(image, board)
    grid = _upright(corners.reshape(rows, columns, 2))
    if grid is None:
        raise PhotoProblem(
            f"the board lies on its side: expected its {board.squares[0]} squares along the picture's width",
            draw_corners(image, corners.reshape(-1, 2)),
        )
    blur = _edge_width(image, grid, columns, rows)
    if blur > _BLURRED:
        raise _blurred(image, grid.reshape(-1, 2), blur)
    i, j = np.meshgrid(np.arange(1, columns + 1), np.arange(1, rows + 1))
    points = board.square * np.stack([i, j], axis=-1).astype(np.float64)
    size = (image.shape[1], image.shape[0])
    return Board(
        corners=grid, points=points, square=board.square, squares=board.squares, blur=blur, size=size
    )


def _search(image: Grey, columns: int, rows: int) -> Array | None:
    scale = min(1.0, (_PIXELS / image.size) ** 0.5)
    small = image
    if scale < 1.0:
        small = np.asarray(
            cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8
        )
    rough = _rough(small, columns, rows)
    if rough is None:
        return None
    corners = np.asarray(rough, dtype=np.float32).reshape(-1, 1, 2)
    corners = (corners + np.float32(0.5)) / np.float32(scale) - np.float32(0.5)
    reach = max(3, min(int(0.25 * float(np.linalg.norm(corners[1] - corners[0]))), 20))
    stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 60, 1e-3)
    refined = cv2.cornerSubPix(image, corners, (reach, reach), (-1, -1), stop)
    return np.asarray(refined, dtype=np.float64)


def _rough(image: Grey, columns: int, rows: int) -> Array | None:
    """Inner corners, shape (n, 1, 2), as OpenCV finds them.

    Enlarged first ("accuracy"), a picture takes four times as long: that is left to pictures in which nothing
    is found otherwise, since `_search` refines the corners itself.
    """
    for flags in (_FLAGS, _FLAGS | cv2.CALIB_CB_ACCURACY):
        found, corners = cv2.findChessboardCornersSB(image, (columns, rows), flags=flags)
        if found and corners is not None:
            return np.asarray(corners, dtype=np.float64)
    return None


def _upright(grid: Array) -> Array | None:
    """The same corners with columns to the right and rows upwards; None where that takes a quarter turn."""
    for turned in (grid, grid[::-1, ::-1]):
        along = turned[0, -1] - turned[0, 0]
        if along[0] > abs(along[1]):
            return np.asarray(turned[::-1] if turned[-1, 0, 1] > turned[0, 0, 1] else turned)
    if grid.shape[0] == grid.shape[1]:
        return _upright(np.asarray(np.rot90(grid))) if grid[0, -1, 1] != grid[0, 0, 1] else None
    return None


def _edge_width(image: Grey, grid: Array, columns: int, rows: int) -> float:
    """Mean 10-90 % width of the squares' edges [px], by OpenCV."""
    corners = np.ascontiguousarray(grid[::-1].reshape(-1, 1, 2), dtype=np.float32)
    mean, _ = cv2.estimateChessboardSharpness(image, (columns, rows), corners, 0.8)
    return float(np.ravel(np.asarray(mean))[0])


def _blurred(image: Grey, corners: Array, width: float) -> PhotoProblem:
    return PhotoProblem(
        f"the photograph is blurred: edges of the board are {width:.0f} pixels wide, expected at most "
        f"{_BLURRED:.0f}",
        draw_corners(image, corners),
    )


def _why_not(image: Grey, board: Checkerboard) -> PhotoProblem:
    """The reason why a board was not found, from smaller pictures and smaller boards."""
    columns, rows = board.squares[0] - 1, board.squares[1] - 1
    name = f"board of {board.squares[0]} x {board.squares[1]} squares"
    for factor in (2, 4):
        small = np.asarray(shrink(image, factor))
        if min(small.shape) < 150:
            break
        found, corners = cv2.findChessboardCornersSB(small, (columns, rows), flags=_FLAGS)
        if found and corners is not None:
            full = (np.asarray(corners, np.float64).reshape(-1, 2) + 0.5) * factor - 0.5
            grid = full.reshape(rows, columns, 2)
            return _blurred(image, full, max(_edge_width(image, grid, columns, rows), _BLURRED + 1))
    if _search(image, columns + 1, rows + 1) is not None:
        columns, rows = board.squares
        return PhotoProblem(
            f"a board of {columns + 1} x {rows + 1} squares was found, with {columns} x {rows} inner corners:"
            " photo_checkerboard.squares counts squares, not inner corners: expected"
            f" [{columns + 1}, {rows + 1}]",
            coloured(image),
        )
    part = _largest_part(image, columns, rows)
    if part is None:
        return PhotoProblem(f"no {name} was found in the photograph", coloured(image))
    corners, shape = part
    grid = corners.reshape(shape[1], shape[0], 2)
    picture = draw_corners(image, corners)
    lost = f"only {shape[0]} x {shape[1]} of its {columns} x {rows} inner corners were found"
    if _reaches_frame(grid, image.shape):
        return PhotoProblem(f"the {name} is cut off by the photograph's frame: {lost}", picture)
    if float((image > 250).mean()) > 0.01:
        return PhotoProblem(f"part of the {name} is lost in glare: {lost}", picture)
    return PhotoProblem(f"part of the {name} is hidden or is another size: {lost}", picture)


def _largest_part(image: Grey, columns: int, rows: int) -> tuple[Array, tuple[int, int]] | None:
    shapes = [(c, r) for c in range(columns, 2, -1) for r in range(rows, 2, -1) if (c, r) != (columns, rows)]
    shapes.sort(key=lambda s: -s[0] * s[1])
    factor = max(1, round(max(image.shape) / 1200))
    small = np.asarray(shrink(image, factor))
    for shape in shapes[:_PARTS]:
        found, corners = cv2.findChessboardCornersSB(small, shape, flags=cv2.CALIB_CB_NORMALIZE_IMAGE)
        if found and corners is not None:
            return (np.asarray(corners, np.float64).reshape(-1, 2) + 0.5) * factor - 0.5, shape
    return None


def _reaches_frame(grid: Array, shape: tuple[int, ...]) -> bool:
    """Would two more squares, in any direction, leave the photograph?"""
    height, width = shape
    right, down = grid[:, -1] - grid[:, -2], grid[-1] - grid[-2]
    left, up = grid[:, 0] - grid[:, 1], grid[0] - grid[1]
    further = np.concatenate(
        [grid[:, -1] + 2 * right, grid[-1] + 2 * down, grid[:, 0] + 2 * left, grid[0] + 2 * up]
    )
    return bool(((further < 0) | (further > [width - 1, height - 1])).any())
