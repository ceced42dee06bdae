"""Figure of measured and simulated shapes, with the distance from the baseline magnified along its normal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from calibration.diagnosis.drawing._bars import AFTER, BEFORE
from calibration.diagnosis.drawing._domain import Figure
from calibration.diagnosis.drawing._labels import label
from calibration.diagnosis.drawing.outlines._drawn import DrawnEdge, DrawnPhotograph, DrawnTrial
from calibration.diagnosis.drawing.outlines._grid import Grid, grid_of, left_out
from calibration.diagnosis.drawing.outlines._look import (
    EXTENDED,
    MEASURED,
    clamps,
    magnification,
    scale_bar,
    shade,
)
from calibration.pages import BAND, paper

WIDE = 11.0  # inches
LETTER = 0.075  # inches that one of a panel's title takes
DOTS = 36  # points drawn an edge
EDGE = "#6B7480"


def draw_shapes(beams: Sequence[DrawnTrial], *, apart: bool = False) -> Figure:
    """One panel per beam, all with one scale and one magnification.

    apart : True if the extension is drawn for each photograph, since it depends on time.
    """
    grid, missing = grid_of(beams)
    factor = magnification(beams)
    depth = 0.06 * max(1e3 * b.trial.free_length for b in beams)
    columns, rows = _extents(grid, factor, depth)
    wide, high = ([b - a for a, b in spans] for spans in (columns, rows))
    per_mm = (WIDE - 0.3) / (sum(wide) * 1.03)
    figure = paper(WIDE, float(np.clip(per_mm * sum(high) + 0.6 * len(grid) + 0.75, 2.5, 40.0)))
    panels = figure.subplots(
        len(grid), len(grid[0]), squeeze=False, gridspec_kw={"width_ratios": wide, "height_ratios": high}
    )
    for line, beams_here, z in zip(panels, grid, rows, strict=True):
        for axes, beam, x in zip(line, beams_here, columns, strict=True):
            axes.set_axis_off()
            axes.set_aspect("equal", adjustable="box")
            axes.set_xlim(*x)
            axes.set_ylim(*z)
            if beam is not None:
                _panel(
                    axes,
                    beam,
                    factor,
                    depth,
                    apart=apart,
                    letters=max(14, int(per_mm * (x[1] - x[0]) / LETTER)),
                )
    scale_bar(panels[-1][0], _round_length(max(wide)))
    _legend(figure, beams, factor, apart)
    extended = any(b.extended for b in beams)
    return Figure(
        name="shapes",
        caption="Grey: the beam as the baseline simulates it, to scale. Dots: the traced edges, their"
        f" distance from the baseline {factor:g} times magnified, registration and the other nuisances"
        " taken out; darker is later"
        + ("." if apart else "; blue lines: the smooth part of their mean.")
        + (
            " Orange lines: the extended simulation, magnified alike. Where what was measured lies on"
            " them and not on the grey body's edge, the extension represents what the baseline lacks."
            if extended
            else " Where that lies on the grey body's edge, the baseline reproduces the measurement."
        )
        + left_out(missing),
        figure=figure,
    )


def _panel(axes: Any, beam: DrawnTrial, factor: float, depth: float, *, apart: bool, letters: int) -> None:
    upper, lower = (1e3 * line for line in beam.body)
    axes.fill(*np.vstack([upper, lower[::-1]]).T, color=BAND, lw=0, zorder=0)
    for line in (upper, lower):
        axes.plot(*line.T, color=EDGE, lw=1.2, zorder=2.5)
    clamps(axes, beam, depth)
    count = len(beam.photographs)
    for n, p in enumerate(beam.photographs):
        for e in p.edges:
            every = max(1, len(e.nearest) // DOTS)
            dots = _moved(e, factor, e.before)[n % every :: every]
            axes.plot(*dots.T, "o", ms=2.0, mew=0, alpha=0.8, color=shade(MEASURED, n, count), zorder=3)
            if apart and e.smooth_after is not None:
                line = _moved(e, factor, e.smooth_before - e.smooth_after)
                axes.plot(*line.T, color=shade(EXTENDED, n, count), lw=1.6, zorder=2)
    for side in () if apart else ("upper", "lower"):
        axes.plot(*_mean(beam, side, factor, extended=False).T, color=BEFORE, lw=1.6, zorder=3.5)
        if beam.extended:
            axes.plot(*_mean(beam, side, factor, extended=True).T, color=AFTER, lw=1.8, zorder=4)
    rms = f"{1e3 * beam.rms('before'):.3f}"
    if beam.extended:
        rms += f" → {1e3 * beam.rms('after'):.3f}"
    axes.set_title(f"{label(beam.trial.id, letters)}\nrms {rms} mm", fontsize=8.5, loc="left")


def _moved(edge: DrawnEdge, factor: float, distance: Any) -> Any:
    return 1e3 * (edge.nearest + factor * distance[:, None] * edge.normal)


def _mean(beam: DrawnTrial, side: str, factor: float, *, extended: bool) -> Any:
    """Smooth part of an edge, magnified, mean over the photographs [mm], shape (k, 2).

    It is that of the measurement, or with `extended` that of the extended simulation.
    """
    edges: list[DrawnEdge] = [getattr(p, side) for p in beam.photographs]
    at = np.linspace(max(e.along[0] for e in edges), min(e.along[-1] for e in edges), DOTS)
    total = np.zeros((len(at), 2))
    for e in edges:
        away = e.smooth_before
        if extended:
            assert e.smooth_after is not None
            away = e.smooth_before - e.smooth_after
        total += np.column_stack([np.interp(at, e.along, column) for column in _moved(e, factor, away).T])
    return total / len(edges)


def _extents(grid: Grid, factor: float, depth: float) -> tuple[list[Any], list[Any]]:
    """Range of x of each column and of z of each row [mm]."""
    boxes = [[None if b is None else _box(b, factor, depth) for b in row] for row in grid]
    whole = [[box for box in row if box is not None] for row in boxes]
    columns = [[box for box in column if box is not None] for column in zip(*boxes, strict=True)]
    return (
        [(min(b[0] for b in column), max(b[1] for b in column)) for column in columns],
        [(min(b[2] for b in row), max(b[3] for b in row)) for row in whole],
    )


def _box(beam: DrawnTrial, factor: float, depth: float) -> tuple[float, float, float, float]:
    points = [1e3 * np.vstack(beam.body)]
    points += [_moved(e, factor, e.before) for p in beam.photographs for e in p.edges]
    low, high = np.vstack(points).min(axis=0), np.vstack(points).max(axis=0)
    right = high[0] + (depth if beam.trial.supports == "clamped-clamped" else 0.0)
    return -depth, float(right) + 2.0, float(low[1]) - 2.0, float(high[1]) + 2.0


def _round_length(width: float) -> float:
    return float(max(n for n in (1, 2, 5, 10, 20, 50, 100, 200, 500) if n <= max(1.0, 0.3 * width)))


def _legend(figure: Any, beams: Sequence[DrawnTrial], factor: float, apart: bool) -> None:
    photographs: Sequence[DrawnPhotograph] = max((b.photographs for b in beams), key=len)
    handles: list[Any] = [Patch(fc=BAND, ec=EDGE, label="baseline simulation, to scale")]
    count = len(photographs)
    for n, p in enumerate(photographs[:4]):
        handles.append(
            Line2D(
                [],
                [],
                ls="",
                marker="o",
                ms=4,
                color=shade(MEASURED, n, count),
                label=f"measured at {p.time:g} s, {factor:g}× magnified",
            )
        )
    if not apart and count > 1:
        handles.append(Line2D([], [], color=BEFORE, lw=2, label=f"their mean, smooth, {factor:g}× magnified"))
    if any(b.extended for b in beams):
        handles.append(Line2D([], [], color=AFTER, lw=2, label=f"extended simulation, {factor:g}× magnified"))
    figure.legend(handles=handles, loc="outside upper left", ncols=3, fontsize=8.5, frameon=False)
