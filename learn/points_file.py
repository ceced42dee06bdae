"""Points of the top face from a CSV file: where a lab has markers, or wants the displacement."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from learn.data import Setup
from learn.errors import InputError

COLUMNS = ("x_mm", "y_mm")
NAME = "id"
_ROUNDING = 1e-9  # m


class AskedPoints(NamedTuple):
    """Points, (n, 2) or (n, 3) [m], and their names, if they have any."""

    points: NDArray[np.float64]
    names: list[str] | None


def points_on_top(given: Path | str | NDArray[np.float64], setup: Setup) -> AskedPoints:
    """Points (n, 3) of a setup's top face [m], from (x, y), shape (n, 2) [m], or the path of a CSV file.

    Raises
    ------
    InputError
        As in `load_points`, or if a point lies beside the top face.
    """
    if isinstance(given, str | Path):
        where, (xy, names) = str(given), load_points(given)
    else:
        where, names = "points", None
        xy = np.asarray(given, dtype=np.float64)
        if xy.ndim != 2 or xy.shape[1] != 2 or not len(xy):
            raise InputError(f"{where}: expected (x, y) of one point or more, shape (n, 2), got {xy.shape}")
    half = np.array(setup.block_size[:2]) / 2
    beside = ~(np.abs(xy - setup.middle) <= half + _ROUNDING).all(axis=1)
    if beside.any():
        k = int(beside.argmax())
        low, high = 1e3 * (setup.middle - half), 1e3 * (setup.middle + half)
        x, y = 1e3 * xy[k]
        raise InputError(
            f"{where}: point {names[k] if names else k + 1}: expected on the top face, x {low[0]:.4g} to"
            f" {high[0]:.4g} mm and y {low[1]:.4g} to {high[1]:.4g} mm, got ({x:.4g}, {y:.4g}) mm"
        )
    return AskedPoints(np.column_stack([xy, np.full(len(xy), setup.top)]), names)


def load_points(path: Path | str) -> AskedPoints:
    """Load points (x, y) from the columns x_mm, y_mm and, if there is one, id of a CSV file.

    Raises
    ------
    InputError
        If the file or a column is missing, a column is not known, a value is not a finite number, or points
        do not have names of their own in a column id.
    """
    path = Path(path)
    if not path.is_file():
        there = "this is a folder" if path.is_dir() else "there is none"
        raise InputError(f"{path}: expected a CSV file of points, {there}")
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError(f"{path}: expected a CSV file in UTF-8") from None
    rows = csv.reader(lines)
    heads = [head.strip() for head in next(rows, [])]
    known = heads.count(NAME) <= 1 and all(heads.count(c) == 1 for c in COLUMNS)
    if not known or set(heads) - {NAME, *COLUMNS}:
        raise InputError(
            f"{path}: expected a first line with the columns x_mm, y_mm and, if points have names, id,"
            f" separated by commas, got {', '.join(heads) or 'nothing'}"
        )
    xy: list[list[float]] = []
    names: dict[str, None] = {}
    for row in rows:
        if not any(cell.strip() for cell in row):
            continue
        line = f"{path}, line {rows.line_num}"
        if len(row) != len(heads):
            raise InputError(f"{line}: expected {len(heads)} columns, got {len(row)}")
        of = dict(zip(heads, (cell.strip() for cell in row), strict=True))
        xy.append([_number(of[c], c, line) * 1e-3 for c in COLUMNS])
        if NAME in of:
            if not of[NAME]:
                raise InputError(f"{line}: column {NAME}: expected a name, got none")
            if of[NAME] in names:
                raise InputError(
                    f"{line}: column {NAME}: expected another name for each point, got {of[NAME]!r} twice"
                )
            names[of[NAME]] = None
    if not xy:
        raise InputError(f"{path}: expected one point or more, got none")
    return AskedPoints(np.array(xy), list(names) if NAME in heads else None)


def _number(text: str, column: str, line: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{line}: column {column}: expected a number in mm, got {text!r}")
    return value
