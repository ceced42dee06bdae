"""Checks of a traced outline: two sides along the beam, in the image plane."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import arc_length
from calibration.errors import InputError
from calibration.experiment._files import Table, parse_table
from calibration.experiment.model import Array

_FAR = 3.0  # free lengths: a point beyond is a slip of the unit or a stray click
_OFF = 0.5  # of the section's height: what a side may begin from its place, or the corners be nearer
_CORNERS = 0.99  # of the section's height: distance of the sides' ends from which both are corners
_ACROSS = 0.5  # least part of a step on the end face by which the ends of the sides come closer
_SHORT = 0.1  # of the free length: a shorter side says nothing of the beam's shape

Indices = NDArray[np.intp]


def read_sides(
    content: bytes, table_path: Path, *, free_length_mm: float, height_mm: float
) -> tuple[Array, Array]:
    """The upper and the lower side, (k, 2) of x, z in mm, each from the clamp on.

    A side whose last point lies nearer to where that side leaves the clamp, (0, +-height / 2), than its first
    was traced towards the clamp: it is turned round. Otherwise the order is kept as it came.
    """
    table = parse_table(content, table_path, texts=("side",), numbers=("x_mm", "z_mm"))
    names = table.texts["side"]
    for row, name in enumerate(names):
        if name not in ("upper", "lower"):
            raise table.error(row, f"column side: expected upper or lower, got {name!r}")
    points = table.columns("x_mm", "z_mm")
    reach = _FAR * max(free_length_mm, height_mm)
    far = np.flatnonzero(np.hypot(*points.T) > reach)
    if far.size:
        raise table.error(
            int(far[0]),
            f"expected a point within {reach:g} mm (3 free lengths) of the clamp, got "
            f"x_mm, z_mm = {points[far[0], 0]:g}, {points[far[0], 1]:g}",
        )
    rows = {}
    for side, sign in (("upper", 1.0), ("lower", -1.0)):
        chosen = np.array([row for row, name in enumerate(names) if name == side], dtype=np.intp)
        rows[side] = _from_clamp(table, side, points, chosen, corner=(0.0, sign * height_mm / 2))
        length = arc_length(points[rows[side]])[-1]
        if length < _SHORT * free_length_mm:
            raise InputError(
                f"{table_path}: side {side}: expected at least {_SHORT:.0%} of the free length "
                f"({free_length_mm:g} mm), got {length:g} mm"
            )
    _check_crossing(table, points, rows["upper"], rows["lower"])
    upper, lower = points[rows["upper"]], points[rows["lower"]]
    _check_start(table_path, upper, lower, height_mm)
    if _area(np.vstack([lower, upper[::-1]])) <= 0:
        raise InputError(
            f"{table_path}: column side: expected upper above lower, they are the other way round"
        )
    return _without_end_face(table_path, upper, lower, height_mm)


def _check_start(path: Path, upper: Array, lower: Array, height_mm: float) -> None:
    """Refuse sides that do not begin about the clamp's axis."""
    axis = 0.5 * float(upper[0, 1] + lower[0, 1])
    if abs(axis) > _OFF * height_mm:
        raise InputError(
            f"{path}: column z_mm: expected sides that leave the clamp half a section height above and below"
            f" z = 0, their middle is at z = {axis:.3g} mm there: another origin, or a picture upside down"
        )


def _without_end_face(path: Path, upper: Array, lower: Array, height_mm: float) -> tuple[Array, Array]:
    """Sides up to the corners: last points whose step leads towards the other side lie on the end face."""
    sides = [upper, lower]
    while min(map(len, sides)) > 3:
        apart = np.hypot(*(sides[0][-1] - sides[1][-1]))
        if apart > _CORNERS * height_mm:
            return sides[0], sides[1]
        gains = [
            (float(np.hypot(*(a[-2] - b[-1])) - apart) / float(np.hypot(*(a[-1] - a[-2]))), k)
            for k, (a, b) in enumerate((sides, sides[::-1]))
        ]
        gain, k = max(gains)
        if gain < _ACROSS:
            break
        sides[k] = sides[k][:-1]
    apart = float(np.hypot(*(sides[0][-1] - sides[1][-1])))
    if apart < _OFF * height_mm:
        raise InputError(
            f"{path}: column side: expected sides that end at the corners of the end face, a section height"
            f" of {height_mm:g} mm apart, got {apart:.3g} mm"
        )
    return sides[0], sides[1]


def _from_clamp(
    table: Table, side: str, points: Array, rows: Indices, corner: tuple[float, float]
) -> Indices:
    if len(rows) < 3:
        raise InputError(
            f"{table.path}: column side: expected at least 3 points of side {side}, got {len(rows)}"
        )
    same = np.flatnonzero((np.diff(points[rows], axis=0) == 0).all(axis=1))
    if same.size:
        raise table.error(
            int(rows[same[0] + 1]), f"expected a point other than the one before on side {side}"
        )
    start, end = np.hypot(*(points[rows[[0, -1]]] - corner).T)
    return rows[::-1] if end < start else rows


def _check_crossing(table: Table, points: Array, upper: Indices, lower: Indices) -> None:
    first = np.concatenate([upper[:-1], lower[:-1]])
    second = np.concatenate([upper[1:], lower[1:]])
    pair = crossing(points[first], points[second], joined=_joined(len(upper) - 1, len(lower) - 1))
    if pair is not None:
        a, b = sorted(max(table.lines[first[k]], table.lines[second[k]]) for k in pair)
        raise InputError(
            f"{table.path}: line {b}: expected an outline that does not cross itself, here it crosses the "
            f"piece that ends at line {a}"
        )


def _joined(upper: int, lower: int) -> set[tuple[int, int]]:
    """Pieces of the two sides that may share a point: where the sides begin and where they end."""
    return {(0, upper), (upper - 1, upper + lower - 1)}


def crossing(start: Array, end: Array, *, joined: set[tuple[int, int]]) -> tuple[int, int] | None:
    """Two segments (start, end: (k, 2)) that meet, or None; neighbours that share an end do not count, nor do
    the pairs `joined` (lower index first).

    Sorted along the longer extent, each is compared with those that begin before it ends.
    """
    points = np.concatenate([start, end])
    axis = int(np.argmax(np.ptp(points, axis=0)))
    low = np.minimum(start[:, axis], end[:, axis])
    order = np.argsort(low, kind="stable")
    low, high = low[order], np.maximum(start[order, axis], end[order, axis])
    active = np.arange(len(order))
    for step in range(1, len(order)):
        active = active[active + step < len(order)]
        active = active[low[active + step] <= high[active]]  # sorted: once beyond, always beyond
        if not active.size:
            return None
        a, b = order[active], order[active + step]
        a, b = np.minimum(a, b), np.maximum(a, b)
        neighbours = (b - a == 1) & (end[a] == start[b]).all(axis=1)
        for k in np.flatnonzero(~neighbours & _meet(start[a], end[a], start[b], end[b])):
            pair = (int(a[k]), int(b[k]))
            if pair not in joined:
                return pair
    return None


def _meet(p: Array, q: Array, r: Array, s: Array) -> NDArray[np.bool_]:
    """Do p-q and r-s share a point, row by row?"""

    def turn(a: Array, b: Array, c: Array) -> Array:
        return np.sign((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))

    across = (turn(p, q, r) * turn(p, q, s) <= 0) & (turn(r, s, p) * turn(r, s, q) <= 0)
    boxes = (np.maximum(p, q) >= np.minimum(r, s)).all(axis=1) & (np.maximum(r, s) >= np.minimum(p, q)).all(
        axis=1
    )
    return across & boxes


def _area(polygon: Array) -> float:
    x, z = polygon.T
    return float(0.5 * (x * np.roll(z, -1) - np.roll(x, -1) * z).sum())
