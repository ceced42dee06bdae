"""Foreground of a photograph: regions before an uneven background, the specimen's among them, its clamps."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from calibration._numerics import robust_sd
from calibration.photo._board import Board
from calibration.photo._camera import View
from calibration.photo._image import Grey, PhotoProblem, coloured, draw_mask

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
        close = left[np.abs(left) < 4.0 * scale]
        narrower = float(robust_sd(close)) if len(close) else scale
        scale = float(np.clip(narrower, max(0.6 * scale, 0.5), scale))
    column, row = np.arange(width) / width, np.arange(height) / width
    full = np.zeros((height, width))
    for (i, j), c in zip(_POWERS, fit, strict=True):
        full += c * np.outer(row**j, column**i)
    return full.astype(np.float32), scale


def _terms(u: Array, v: Array) -> Array:
    return np.column_stack([u**i * v**j for i, j in _POWERS])


_TALL = 1.35  # a clamp is at least this many times as high as the specimen
_SECOND = 0.1  # a region this part of the specimen's size is a second one


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan:
    """Labels of the foreground laid out on the specimen's plane: labels[j, i] at x = x[i], z = z[j] (upwards)
    in the board frame [m]; -1 outside the photograph."""

    labels: NDArray[np.int32]
    x: Array
    z: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Clamp:
    """End of a clamp's silhouette in the board frame, on the specimen's plane.

    Attributes
    ----------
    x : position of the end [m].
    clamp_z, beam_z : extent of the clamp and of the beam in z there [m].
    """

    x: float
    clamp_z: tuple[float, float]
    beam_z: tuple[float, float]


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """The specimen's region by label, with the clamps that were seen."""

    label: int
    near: Clamp | None
    far: Clamp | None


def lay_out(view: View, found: Foreground, plane: float, *, step: float) -> Plan:
    """The labels on a grid of `step` [m] in the plane y = `plane`."""
    height, width = found.labels.shape
    u, v = np.linspace(0, width - 1, 30), np.linspace(0, height - 1, 30)
    rim = np.concatenate(
        [[[a, b] for a in u for b in (0, height - 1)], [[a, b] for a in (0, width - 1) for b in v]]
    )
    seen = view.on_plane(rim, plane)
    x = np.arange(seen[:, 0].min(), seen[:, 0].max(), step)
    z = np.arange(seen[:, 1].min(), seen[:, 1].max(), step)
    gx, gz = np.meshgrid(x, z)
    pixels = view.project(np.column_stack([gx.ravel(), np.full(gx.size, plane), gz.ravel()]))
    at = np.rint(pixels).astype(np.int64)
    inside = ((at >= 0) & (at < [width, height])).all(axis=1)
    labels = np.full(gx.size, -1, np.int32)
    labels[inside] = found.labels[at[inside, 1], at[inside, 0]]
    return Plan(labels=labels.reshape(gx.shape), x=x, z=z)


def find_body(
    image: Grey,
    found: Foreground,
    plan: Plan,
    *,
    height: float,
    length: float,
    far_clamp: bool,
    clamp_needed: bool,
) -> Body:
    """The one specimen.

    height, length: of the specimen [m]; far_clamp: it is held at both ends; clamp_needed: x = 0 has to be
    found at the clamp. Raises PhotoProblem where there is none, or more than one, or no clamp.
    """
    cell = (plan.x[1] - plan.x[0]) ** 2
    areas = np.bincount(plan.labels[plan.labels > 0], minlength=len(found.areas)) * cell
    label = int(areas.argmax())
    if areas[label] < 0.4 * height * length:
        raise PhotoProblem(
            "no specimen was found before the background", draw_mask(image, [found.labels > 0])
        )
    _check_alone(image, found, areas, label, height * length)
    mask = plan.labels == label
    near, far = _clamp(mask, plan, height), None
    if far_clamp:
        far = _clamp(mask[:, ::-1], Plan(labels=plan.labels, x=plan.x[::-1], z=plan.z), height)
    if near is None and clamp_needed:
        raise PhotoProblem(
            f"the clamp's face was not found: expected the specimen's left end in a clamp at least {_TALL:g} "
            "times as high, or board_corner_mm in photographs.yaml",
            show_body(image, found, label),
        )
    if far_clamp and far is None:
        raise PhotoProblem(
            "the far clamp was not found at the specimen's right end", show_body(image, found, label)
        )
    touching = (cv2.dilate(found.board.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0) & (
        found.labels == label
    )
    if touching.any():
        raise PhotoProblem(
            "specimen or clamp cover the board or come within half a square of it",
            show_body(image, found, label),
        )
    return Body(label=label, near=near, far=far)


def _check_alone(image: Grey, found: Foreground, areas: Array, label: int, size: float) -> None:
    """A second region as large as a good part of a specimen; what reaches in from the frame is not one."""
    rim = np.unique(
        np.concatenate([found.labels[0], found.labels[-1], found.labels[:, 0], found.labels[:, -1]])
    )
    others = [k for k in range(1, len(areas)) if k != label and k not in rim and areas[k] > _SECOND * size]
    if others:
        raise PhotoProblem(
            f"{1 + len(others)} specimens were found, expected one",
            draw_mask(image, [found.labels == k for k in (label, *others)]),
        )


def _clamp(mask: NDArray[np.bool_], plan: Plan, height: float) -> Clamp | None:
    """Reading columns from the left: the body starts high (clamp) and falls to the beam's height."""
    step = abs(float(plan.x[1] - plan.x[0]))
    tall = _longest_runs(mask) * step
    filled = np.flatnonzero(tall > 0.2 * height)
    if not len(filled):
        return None
    start = int(filled[0])
    high = np.flatnonzero(tall[start : start + int(1.5 * height / step)] > _TALL * height)
    if not len(high):
        return None
    k = start + int(high[0])
    low = np.flatnonzero(tall[k:] < _TALL * height)
    if not len(low):
        return None
    edge = k + int(low[0])
    beside, before = edge + int(0.001 / step), max(edge - int(0.0015 / step), k)
    if beside >= mask.shape[1]:
        return None
    beam, clamp = plan.z[mask[:, beside]], plan.z[mask[:, before]]
    if not len(beam) or not len(clamp):
        return None
    return Clamp(
        x=float(plan.x[edge]),
        clamp_z=(float(clamp.min()), float(clamp.max())),
        beam_z=(float(beam.min()), float(beam.max())),
    )


def _longest_runs(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Longest unbroken stretch of each column, in cells: two beams in one clamp do not add up to a clamp."""
    run = np.zeros(mask.shape[1], np.int64)
    best = run.copy()
    for row in mask:
        run = (run + 1) * row
        best = np.maximum(best, run)
    return best


def show_body(image: Grey, found: Foreground, label: int) -> NDArray[np.uint8]:
    """The photograph with the specimen's region tinted."""
    return draw_mask(image, [found.labels == label]) if label else coloured(image)
