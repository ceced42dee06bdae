"""Figures of curves with one panel per trial, and of their residuals with one pair of bars per trial."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from calibration.diagnosis.drawing._bars import AFTER, BEFORE, paired_bars
from calibration.diagnosis.drawing._curves import Drawn, DrawnCurve, missing, most_telling, rms_of_all
from calibration.diagnosis.drawing._domain import Figure, Section
from calibration.diagnosis.drawing._labels import label
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.pages import INK, paper, plain, significant

Array = NDArray[np.float64]

COLUMNS = 3
PANELS: Mapping[Section, int] = {
    "shapes": 6,
    "residuals": 12,
}  # of one picture: the first ones are to be read
TITLE = 26  # characters of a trial's name


def per_trial(
    curves: Sequence[Drawn],
    draw: Callable[[Any, Drawn], None],
    *,
    name: str,
    caption: str,
    handles: Sequence[Line2D],
    section: Section = "shapes",
) -> Figure:
    """Draw one panel for each of the `PANELS` trials with the largest residuals.

    Parameters
    ----------
    curves : sequence of DrawnCurve
        All trials.
    draw : callable
        Draws a curve into its panel's axes.
    name, section : see `Figure`.
    caption : str
        A sentence on trials without a panel is appended.
    handles : sequence of Line2D
        Handles of the legend above the panels (`legend_handles`).
    """
    shown, unshown = most_telling(curves, PANELS[section])
    figure, each = panels(len(shown))
    for axes, curve in zip(each, shown, strict=True):
        draw(axes, curve)
    figure.legend(handles=handles, loc="outside upper left", ncols=4, fontsize=8.5, frameon=False)
    return Figure(name=name, caption=caption + missing(unshown), figure=figure, section=section)


def panels(count: int) -> tuple[Any, list[Any]]:
    """A figure and its axes, one per panel."""
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    figure = paper(11.0, 0.6 + (2.5 if count > COLUMNS else 3.4) * rows)
    found = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axes in found[count:]:
        axes.set_visible(False)
    return figure, found[:count]


def dots(axes: Any, x: Any, y: Any, colour: str, *, hollow: bool) -> None:
    """Draw measured points."""
    face = "none" if hollow else colour
    axes.plot(x, y, "o", ms=2.6, mew=0.6, mfc=face, mec=colour, zorder=3)


def measured_and_simulated(
    axes: Any,
    x: Array,
    measured: Array,
    before: Array,
    after: Array | None,
    branches: Iterable[tuple[NDArray[np.bool_], bool]],
) -> None:
    """Draw dots for the measured curve and lines for the simulated ones, branch by branch.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    x, measured, before, after : ndarray, shape (k,)
        Values in the units of the axes; `after` is None if there is no extension.
    branches : iterable of (ndarray of bool, shape (k,), bool)
        Points that are joined by a line, and True if their dots are hollow.
    """
    for mine, hollow in branches:
        dots(axes, x[mine], measured[mine], INK, hollow=hollow)
        axes.plot(x[mine], before[mine], color=BEFORE, lw=1.6, zorder=2)
        if after is not None:
            axes.plot(x[mine], after[mine], color=AFTER, lw=1.6, zorder=2.5)


def titled(
    axes: Any, curve: DrawnCurve, across: str, up: str, *, unit: tuple[str, float], note: str = ""
) -> None:
    """Title a panel with its trial's name, a note, and the rms of its residuals; label its axes.

    unit : unit of the rms, and its number per SI unit.
    """
    plain(axes)
    shown, per_si = unit
    rms = significant(per_si * curve.rms("before"), 3)
    if curve.extended:
        rms += f" → {significant(per_si * curve.rms('after'), 3)}"
    axes.set_title(f"{label(curve.name, TITLE)}{note}\nrms {rms} {shown}", fontsize=8.5, loc="left")
    axes.set_xlabel(across, fontsize=8)
    axes.set_ylabel(up, fontsize=8)


def legend_handles(curves: Sequence[DrawnCurve], after: str, *, measured: bool = True) -> list[Line2D]:
    """Legend handles of the measured dots and the simulated lines.

    after : label of the extension (`legend_of`). measured : False leaves out the dots, for figures in which
    they differ in colour.
    """
    handles = [Line2D([], [], color=BEFORE, lw=2, label="baseline")]
    if measured:
        handles.insert(0, Line2D([], [], ls="", marker="o", ms=4, color=INK, label="measured"))
    if any(c.extended for c in curves):
        handles.append(Line2D([], [], color=AFTER, lw=2, label=after))
    return handles


def draw_rms(
    curves: Sequence[DrawnCurve],
    diagnosis: Diagnosis,
    after: str,
    *,
    quantity: str,
    unit: tuple[str, float],
    noise: float,
    dashed: str,
) -> Figure:
    """Draw the rms residual of each trial's curve and of all, before and after, and held out.

    Parameters
    ----------
    quantity : quantity of the curves.
    unit : as in `titled`.
    noise : rms of noise [SI], drawn as a dashed line.
    dashed : description of the dashed line for the caption.
    """
    shown, unshown = most_telling(curves)
    name, per_si = unit
    gain = diagnosis.held_out

    def each(which: str) -> list[float]:
        return [per_si * v for v in (*(c.rms(which) for c in shown), rms_of_all(curves, which))]

    figure = paired_bars(
        [*(c.name for c in shown), "all"],
        each("before"),
        each("after") if any(c.extended for c in curves) else None,
        quantity=f"rms of measured less simulated {quantity} / {name}",
        noise=per_si * noise,
        held_out=(gain.held_out, per_si * gain.rms_before, per_si * gain.rms_after)
        if gain is not None and gain.held_out
        else None,
    )
    return Figure(
        name="rms",
        caption=f"rms of what is left of the {quantity}, trial by trial"
        + (f"; after: {after}" if after else "")
        + f". Dashed: {dashed}."
        + missing(unshown),
        figure=figure,
        section="residuals",
    )
