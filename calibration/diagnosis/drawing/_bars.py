"""Errors of the baseline and of the extension as pairs of bars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib.figure
import numpy as np

from calibration.diagnosis.drawing._labels import label
from calibration.pages import COLOURS, INK, paper, plain, significant

BEFORE, AFTER = COLOURS[0], COLOURS[1]


def paired_bars(
    names: Sequence[str],
    before: Sequence[float],
    after: Sequence[float] | None,
    *,
    quantity: str,
    noise: float | None = None,
    held_out: tuple[str, float, float] | None = None,
) -> matplotlib.figure.Figure:
    """Draw one pair of horizontal bars per name.

    Parameters
    ----------
    names : labels of the pairs.
    before, after : values of the baseline and of the extension; `after` is None if there is no extension.
    quantity : axis label with the unit.
    noise : value that noise alone gives, drawn as a dashed line.
    held_out : (name of the set of folds, before, after), drawn below the other pairs.
    """
    rows = np.arange(len(names), dtype=float)
    shown = [label(n) for n in names]
    lower, upper = list(before), list(after) if after is not None else None
    if held_out is not None and upper is not None:
        rows = np.append(rows, len(names) + 0.5)
        shown.append(f"held out,\n{label(held_out[0])}")
        lower.append(held_out[1])
        upper.append(held_out[2])
    figure = paper(8.5, 1.3 + 0.42 * len(rows))
    axes = plain(figure.subplots(1, 1))
    height = 0.36 if upper is not None else 0.6
    shift = 0.5 * height if upper is not None else 0.0
    axes.barh(rows - shift, lower, height=height, color=BEFORE, label="baseline")
    _written(axes, rows - shift, lower)
    if upper is not None:
        axes.barh(rows + shift, upper, height=height, color=AFTER, label="extended")
        _written(axes, rows + shift, upper)
    if noise is not None:
        axes.axvline(noise, color=INK, lw=1.1, ls="--", zorder=2.5, label="error of the measurement alone")
    axes.set_yticks(rows, shown)
    axes.set_ylim(rows[-1] + 0.7, -0.7)
    axes.set_xlim(0.0, 1.15 * max(*lower, *(upper or ()), noise or 0.0))
    axes.set_xlabel(quantity, fontsize=9)
    figure.legend(loc="outside upper left", ncols=3, fontsize=8, frameon=False)
    return figure


_CLEAR = {"fc": "white", "ec": "none", "pad": 0.4, "alpha": 0.85}


def _written(axes: Any, rows: np.ndarray, values: Sequence[float]) -> None:
    for y, v in zip(rows, values, strict=True):
        axes.text(v, y, f" {significant(v)}", va="center", ha="left", fontsize=7, color=INK, bbox=_CLEAR)
