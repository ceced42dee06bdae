"""What stands before the background: regions that differ from a smooth, uneven background."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from calibration.photo._board import Board
from calibration.photo._image import Grey
from calibration.photo._view import View

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_STRIDE = 8  # pixels between those the background is fitted to
_ORDER = 3  # of the polynomial: light that falls off, vignetting
_POWERS = [(i, j) for i in range(_ORDER + 1) for j in range(_ORDER + 1 - i)]
_SPREAD = 50.0  # grey levels either way that uneven light may make at first
_LEAST = 12.0  # grey levels that count as different at all
_NOISE = 6.0  # in sd of what the background leaves over
_MARGIN = 0.5  # squares about the board that are left out with it


@dataclass(frozen=True, eq=False, kw_only=True)
class Foreground:
    """labels (height, width): 0 background, then regions by number; areas [px] by region, areas[0] = 0.
    board: the part left out. noise: sd of the grey values left over on the background."""

    labels: NDArray[np.int32]
    areas: NDArray[np.int64]
    background: NDArray[np.float32]
    board: Mask
    noise: float


def segment(image: Grey, board: Board, view: View) -> Foreground:
    """Regions that differ from the background by more than its noise."""
    hidden = _board_mask(image.shape, board, view)
    soft = cv2.GaussianBlur(image, (0, 0), 1.2).astype(np.float32)
    background, noise = _background(soft, hidden)
    differs = np.abs(soft - background) > max(_LEAST, _NOISE * noise)
    differs[hidden] = False
    cleaned = cv2.morphologyEx(differs.astype(np.uint8), cv2.MORPH_OPEN, np.ones((5, 5), np.uint8))
    _, labels, stats, _ = cv2.connectedComponentsWithStats(cleaned, connectivity=8)
    areas = np.asarray(stats[:, cv2.CC_STAT_AREA], dtype=np.int64)
    areas[0] = 0
    return Foreground(
        labels=np.asarray(labels, dtype=np.int32),
        areas=areas,
        background=background,
        board=hidden,
        noise=noise,
    )


def _board_mask(shape: tuple[int, ...], board: Board, view: View) -> Mask:
    """The squares and a margin about them."""
    margin = _MARGIN * board.square
    right, top = (board.square * n + margin for n in board.squares)
    x = np.linspace(-margin, right, 40)
    z = np.linspace(-margin, top, 40)
    ring = np.concatenate(
        [
            np.column_stack([x, np.full(40, -margin)]),
            np.column_stack([np.full(40, right), z]),
            np.column_stack([x[::-1], np.full(40, top)]),
            np.column_stack([np.full(40, -margin), z[::-1]]),
        ]
    )
    pixels = view.project(np.column_stack([ring[:, 0], np.zeros(len(ring)), ring[:, 1]]))
    mask = np.zeros(shape, np.uint8)
    cv2.fillPoly(mask, [np.rint(pixels).astype(np.int32)], 1)
    return np.asarray(mask > 0)


def _background(soft: NDArray[np.float32], hidden: Mask) -> tuple[NDArray[np.float32], float]:
    """A polynomial through most of the pixels, and the sd of those it describes."""
    height, width = soft.shape
    v, u = np.mgrid[0:height:_STRIDE, 0:width:_STRIDE]
    keep = ~hidden[::_STRIDE, ::_STRIDE]
    terms = _terms(u[keep] / width, v[keep] / width)
    value = soft[::_STRIDE, ::_STRIDE][keep].astype(np.float64)
    # the commonest brightness is the background's (widely smoothed: even clamps make sharp peaks); from there
    # on stiff surfaces first, and ever less tolerance
    counts = gaussian_filter1d(np.bincount(np.rint(value).astype(int), minlength=256).astype(float), 12.0)
    left = value - float(counts.argmax())
    scale = _SPREAD / 4.0
    fit = np.zeros(terms.shape[1])
    for order in (0, 1, 1, 2, 2, 2, *(12 * [_ORDER])):
        columns = [k for k, (i, j) in enumerate(_POWERS) if i + j <= order]
        root = np.clip(1.0 - (left / (4.0 * scale)) ** 2, 0.0, None)
        fit = np.zeros(terms.shape[1])
        fit[columns] = np.linalg.lstsq(terms[:, columns] * root[:, None], value * root, rcond=None)[0]
        left = value - terms @ fit
        close = np.abs(left[np.abs(left) < 4.0 * scale])
        narrower = 1.4826 * float(np.median(close)) if len(close) else scale
        scale = float(np.clip(narrower, max(0.6 * scale, 0.5), scale))
    column, row = np.arange(width) / width, np.arange(height) / width
    full = np.zeros((height, width))
    for (i, j), c in zip(_POWERS, fit, strict=True):
        full += c * np.outer(row**j, column**i)
    return full.astype(np.float32), scale


def _terms(u: Array, v: Array) -> Array:
    return np.column_stack([u**i * v**j for i, j in _POWERS])
