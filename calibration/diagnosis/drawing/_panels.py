"""Pictures of curves, one panel a trial, and of what is left of them, one pair of bars a trial."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.lines import Line2D

from calibration.diagnosis.drawing._bars import AFTER, BEFORE, paired_bars
from calibration.diagnosis.drawing._curves import DrawnCurve, missing, most_telling, rms_of_all
from calibration.diagnosis.drawing._domain import Figure
from calibration.diagnosis.verdict import Diagnosis
from calibration.report import INK, paper, plain, significant

COLUMNS = 3


def panels(count: int) -> tuple[Any, list[Any]]:
    """A figure, and the axes of each trial's panel."""
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    figure = paper(11.0, 0.6 + (2.5 if count > COLUMNS else 3.4) * rows)
    found = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axes in found[count:]:
        axes.set_visible(False)
    return figure, found[:count]


def dots(axes: Any, x: Any, y: Any, colour: str, *, hollow: bool) -> None:
    """Measured points."""
    face = "none" if hollow else colour
    axes.plot(x, y, "o", ms=2.6, mew=0.6, mfc=face, mec=colour, zorder=3)


def titled(axes: Any, curve: DrawnCurve, name: str, across: str, up: str, *, unit: tuple[str, float]) -> None:
    """A panel's title with what is left of its curve, and its axes; unit: of that, and how many are one SI
    unit."""
    plain(axes)
    shown, per_si = unit
    rms = significant(per_si * curve.rms("before"), 3)
    if curve.extended:
        rms += f" → {significant(per_si * curve.rms('after'), 3)}"
    axes.set_title(f"{name}\nrms {rms} {shown}", fontsize=8.5, loc="left")
    axes.set_xlabel(across, fontsize=8)
    axes.set_ylabel(up, fontsize=8)


def legend(figure: Any, curves: Sequence[DrawnCurve], after: str, *, measured: bool = True) -> None:
    """What dots and lines are. after: see `legend_of`. measured: whether all dots are one colour."""
    handles = [Line2D([], [], color=BEFORE, lw=2, label="baseline")]
    if measured:
        handles.insert(0, Line2D([], [], ls="", marker="o", ms=4, color=INK, label="measured"))
    if any(c.extended for c in curves):
        handles.append(Line2D([], [], color=AFTER, lw=2, label=after))
    figure.legend(handles=handles, loc="outside upper left", ncols=3, fontsize=8.5, frameon=False)


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
    """rms of what is left of each trial's curve and of all, before and after, and held out.

    quantity: of the curve; unit: as in `titled`. noise [SI]: drawn as a dashed line, and what that is.
    """
    shown, unshown = most_telling(curves)
    name, per_si = unit
    gain = diagnosis.gain

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
