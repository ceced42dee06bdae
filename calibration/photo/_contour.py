"""The specimen's contour to sub-pixel: the rim of its region, moved to where the grey values fall fastest.

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

from calibration._numerics import arc_length
from calibration.photo._camera import View
from calibration.photo._foreground import Foreground, show_body
from calibration.photo._image import RED, Grey, PhotoProblem, draw_points

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
    s = arc_length(line)
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
    """Crossing of the profile and the level nearest to the offset; the offset itself where there is none."""
    above = profile - level[:, None]
    crosses = above[:, 1:] * above[:, :-1] < 0
    with np.errstate(divide="ignore", invalid="ignore"):
        where = t[:-1] + _STEP * above[:, :-1] / (above[:, :-1] - above[:, 1:])
    distance = np.where(crosses, np.abs(where - offset[:, None]), np.inf)
    nearest = distance.argmin(axis=1)
    row = np.arange(len(t)) if len(t) == len(offset) else np.arange(len(offset))
    ok = distance[row, nearest] < 3.0
    return np.where(ok, where[row, nearest], offset)


_SATURATED, _DULL = 250, 240  # grey levels: burnt out before a background that is not
_LOST = 0.002  # of contour without an edge, or in glare, that is too much [m]
_SECOND = 0.2  # a further contour that part as long as the first is a second specimen
_FAINT = 8.0  # grey levels across an edge


@dataclass(frozen=True, eq=False, kw_only=True)
class Contour:
    """Edges in order from the clamp, (k, 2) [px]; end: the rest of the contour about a free end, from the
    upper to the lower one (empty where the far end is clamped). half: how far off the half-way level lies,
    (k,) [px], upper then lower. metres_per_pixel at the specimen."""

    upper: Array
    lower: Array
    end: Array
    half: Array
    metres_per_pixel: float


def trace_contour(
    image: Grey,
    found: Foreground,
    label: int,
    view: View,
    *,
    plane: float,
    start: float,
    stop: float | None,
    height: float,
) -> Contour:
    """The contour right of x = `start` (and left of `stop`, where the far end is clamped), board frame [m].

    height: of the section [m]. Raises PhotoProblem for a specimen that leaves the picture, glare, or an edge
    too faint to follow.
    """
    runs = _free_runs(image, found, label, view, plane, start, stop)
    edges = [refine(image, run) for run in runs]
    for edge in edges:
        _check_edge(image, found, label, edge, view, plane)
    if stop is not None:
        upper, lower = sorted(edges, key=lambda e: float(np.median(e.points[:, 1])))
        upper, lower = _rightwards(upper), _rightwards(lower)
        scale = _scale(upper.points, view, plane)
        return Contour(
            upper=upper.points,
            lower=lower.points,
            end=np.zeros((0, 2)),
            half=np.concatenate([upper.half, lower.half]),
            metres_per_pixel=scale,
        )
    edge = edges[0]
    if view.on_plane(edge.points[[0, -1]], plane)[0, 1] < view.on_plane(edge.points[[0, -1]], plane)[1, 1]:
        edge = _reversed(edge)
    scale = _scale(edge.points, view, plane)
    tip = _tip(edge.points, int(1.3 * height / scale))
    cut = int(0.75 * height / scale)
    a, b = tip - cut, tip + cut
    if a < cut or len(edge.points) - b < cut:
        raise PhotoProblem("the specimen's free end was not found", show_body(image, found, label))
    return Contour(
        upper=edge.points[:a],
        lower=edge.points[b:][::-1],
        end=edge.points[a:b],
        half=np.concatenate([edge.half[:a], edge.half[b:]]),
        metres_per_pixel=scale,
    )


def _free_runs(
    image: Grey, found: Foreground, label: int, view: View, plane: float, start: float, stop: float | None
) -> list[Array]:
    """Pieces of the region's rim beyond the clamp: one about a free end, two between clamps."""
    mask = (found.labels == label).astype(np.uint8)
    rims, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    rim = max(rims, key=len).reshape(-1, 2).astype(np.float64)
    seen = view.on_plane(rim, plane)
    free = seen[:, 0] > start
    if stop is not None:
        free &= seen[:, 0] < stop
    height, width = image.shape
    outside = free & ((rim < 3) | (rim > [width - 4, height - 4])).any(axis=1)
    if outside.any():
        raise PhotoProblem(
            "the specimen touches the photograph's frame",
            draw_points(show_body(image, found, label), rim[outside][::5], RED),
        )
    wanted = 1 if stop is None else 2
    runs = sorted(_runs(free), key=len, reverse=True)
    more = [run for run in runs[wanted:] if len(run) > _SECOND * len(runs[0])]
    if more:
        picture = show_body(image, found, label)
        for run in runs[: wanted + len(more)]:
            draw_points(picture, rim[run][::15], RED)
        count = 1 + -(-len(more) // wanted)
        raise PhotoProblem(f"{count} specimens were found in the clamp, expected one", picture)
    runs = runs[:wanted]
    if len(runs) < wanted or len(runs[-1]) < 60:
        raise PhotoProblem("the specimen's contour is broken", show_body(image, found, label))
    return [rim[run] for run in runs]


def _runs(free: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Index runs of True on a ring."""
    if free.all() or not free.any():
        return [np.arange(len(free))] if free.all() else []
    first = int(np.flatnonzero(~free)[0])
    order = np.roll(np.arange(len(free)), -first)
    ends = np.flatnonzero(np.diff(np.concatenate([[0], free[order].astype(np.int8), [0]])))
    return [order[a:b] for a, b in zip(ends[::2], ends[1::2], strict=True)]


def _check_edge(image: Grey, found: Foreground, label: int, edge: Edge, view: View, plane: float) -> None:
    scale = _scale(edge.points, view, plane)
    burnt = (image >= _SATURATED) & (found.background < _DULL)
    burnt = cv2.dilate(burnt.astype(np.uint8), np.ones((9, 9), np.uint8)) > 0
    at = np.clip(np.rint(edge.points).astype(int), 0, [image.shape[1] - 1, image.shape[0] - 1])
    glare = burnt[at[:, 1], at[:, 0]]
    if glare.sum() * scale > _LOST:
        raise PhotoProblem(
            f"glare on the specimen's edge: {glare.sum() * scale * 1e3:.0f} mm of its contour are burnt out",
            draw_points(show_body(image, found, label), edge.points[glare][::8], RED),
        )
    lost = ~edge.found | (edge.contrast < _FAINT)
    if lost.sum() * scale > _LOST:
        raise PhotoProblem(
            f"the specimen's edge is too faint on {lost.sum() * scale * 1e3:.0f} mm of its contour: expected "
            "a background that differs from it",
            draw_points(show_body(image, found, label), edge.points[lost][::8], RED),
        )


def _scale(points: Array, view: View, plane: float) -> float:
    """Metres per pixel along a contour."""
    seen = view.on_plane(points, plane)
    return float(arc_length(seen)[-1] / arc_length(points)[-1])


def _reversed(edge: Edge) -> Edge:
    return Edge(
        points=edge.points[::-1], contrast=edge.contrast[::-1], half=-edge.half[::-1], found=edge.found[::-1]
    )


def _rightwards(edge: Edge) -> Edge:
    return _reversed(edge) if edge.points[-1, 0] < edge.points[0, 0] else edge


def _tip(points: Array, window: int) -> int:
    """Middle of the stretch of `window` points over which the contour turns most: the free end's face."""
    smooth = cv2.GaussianBlur(points.reshape(-1, 1, 2), (1, 61), 10.0, borderType=cv2.BORDER_REPLICATE)
    tangent = np.gradient(np.asarray(smooth).reshape(-1, 2), axis=0)
    angle = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    turn = np.abs(angle[window:] - angle[:-window]) if len(angle) > window else np.zeros(1)
    near = np.flatnonzero(turn > turn.max() - np.radians(5.0))
    return int(near.mean()) + window // 2
