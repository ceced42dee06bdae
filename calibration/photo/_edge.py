"""Edges to sub-pixel: where the grey values across a contour fall fastest.

Profiles across the contour are averaged along it over a few pixels, so that noise does not carry the
maximum away; a lens blurs both sides alike, so it stays on the edge. The half-way level between the two sides
is taken as a second opinion: shading of a round body moves it, and how far the two disagree is what the
tracing cannot know better.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from calibration.photo._image import Grey

Array = NDArray[np.float64]

REACH = 9.0  # pixels across, to either side
_STEP = 0.25
_ALONG = 3.0  # sd of the averaging along the contour [px]
_SOFT = 1.2  # sd of the derivative across [px]


@dataclass(frozen=True, eq=False, kw_only=True)
class Edge:
    """points (k, 2) [px], about one pixel apart; contrast (k,) [grey levels] across the edge; half (k,) [px]:
    how far the half-way level lies off, along the normal; found (k,): the maximum lies within reach."""

    points: Array
    contrast: Array
    half: Array
    found: NDArray[np.bool_]


def refine(image: Grey, rough: Array, *, rounds: int = 2) -> Edge:
    """Moves a rough open contour (k, 2) [px], good to a few pixels, onto the edge."""
    line = _even(gaussian_filter1d(rough, 2.0, axis=0, mode="nearest"))
    grey = image.astype(np.float32)
    for _ in range(rounds):
        offset, half, contrast, found = _across(grey, line)
        normal = _normals(line)
        edge = line + offset[:, None] * normal
        result = Edge(points=edge, contrast=contrast, half=half - offset, found=found)
        line = _even(
            gaussian_filter1d(edge[found] if found.sum() > 20 else edge, 2.0, axis=0, mode="nearest")
        )
    return result


def _even(line: Array) -> Array:
    """The polyline at steps of one pixel."""
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0.0, s[-1], max(int(s[-1]), 2))
    return np.column_stack([np.interp(at, s, line[:, 0]), np.interp(at, s, line[:, 1])])


def _normals(line: Array) -> Array:
    tangent = np.gradient(gaussian_filter1d(line, 3.0, axis=0, mode="nearest"), axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    return np.column_stack([tangent[:, 1], -tangent[:, 0]])


def _across(grey: NDArray[np.float32], line: Array) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    t = np.arange(-REACH, REACH + _STEP / 2, _STEP)
    at = line[:, None, :] + t[None, :, None] * _normals(line)[:, None, :]
    # bilinear sampling of coordinates beyond 16 bits of rows would overflow in one call: in strips
    parts = [
        cv2.remap(
            grey,
            strip[..., 0].astype(np.float32),
            strip[..., 1].astype(np.float32),
            cv2.INTER_CUBIC,
            borderMode=cv2.BORDER_REPLICATE,
        )
        for strip in np.array_split(at, max(1, len(at) // 8000 + 1))
    ]
    profile = gaussian_filter1d(np.concatenate(parts).astype(np.float64), _ALONG, axis=0, mode="nearest")
    slope = gaussian_filter1d(profile, _SOFT / _STEP, axis=1, order=1, mode="nearest") / _STEP
    size = np.abs(slope)
    size[:, : int(1.0 / _STEP)] = 0.0
    size[:, -int(1.0 / _STEP) :] = 0.0
    best = np.clip(size.argmax(axis=1), 1, len(t) - 2)
    row = np.arange(len(line))
    a, b, c = size[row, best - 1], size[row, best], size[row, best + 1]
    bend = a - 2 * b + c
    shift = np.where(bend < 0, 0.5 * (a - c) / np.where(bend < 0, bend, -1.0), 0.0)
    offset = t[best] + _STEP * np.clip(shift, -1.0, 1.0)
    inner, outer = (
        np.array([np.interp(o + d, t, p) for o, p in zip(offset, profile, strict=True)]) for d in (-4.0, 4.0)
    )
    contrast = np.abs(outer - inner)
    half = _half_way(t, profile, offset, 0.5 * (inner + outer))
    found = (np.abs(offset) < REACH - 1.5) & (b > 0)
    return offset, half, contrast, found


def _half_way(t: Array, profile: Array, offset: Array, level: Array) -> Array:
    """Where the profile crosses the level, nearest to the offset; the offset itself where it does not."""
    above = profile - level[:, None]
    crosses = above[:, 1:] * above[:, :-1] < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        where = t[:-1] + _STEP * above[:, :-1] / (above[:, :-1] - above[:, 1:])
    distance = np.where(crosses, np.abs(where - offset[:, None]), np.inf)
    nearest = distance.argmin(axis=1)
    row = np.arange(len(t)) if len(t) == len(offset) else np.arange(len(offset))
    ok = distance[row, nearest] < 3.0
    return np.where(ok, where[row, nearest], offset)
