"""Figures of the residuals along the beams before and after the extension, and of their rms per beam."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from calibration.diagnosis.drawing._bars import paired_bars
from calibration.diagnosis.drawing._domain import Figure
from calibration.diagnosis.drawing._labels import label
from calibration.diagnosis.drawing.outlines._drawn import Array, DrawnTrial, rms_of
from calibration.diagnosis.drawing.outlines._grid import grid_of, left_out
from calibration.diagnosis.drawing.outlines._look import EXTENDED, MEASURED, shade
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.pages import BAND, COLOURS, INK, paper, plain

SAMPLES = 60
MEAN = {MEASURED: COLOURS[0], EXTENDED: COLOURS[1]}


def draw_residuals(beams: Sequence[DrawnTrial], *, apart: bool = False) -> Figure:
    """One panel per beam: distance of its mid line for each photograph, and their mean unless `apart`."""
    grid, missing = grid_of(beams)
    figure = paper(11.0, 0.7 + 1.75 * len(grid))
    panels = figure.subplots(len(grid), len(grid[0]), sharey=True, squeeze=False)
    for line, here in zip(panels, grid, strict=True):
        for axes, beam in zip(line, here, strict=True):
            if beam is None:
                axes.set_visible(False)
            else:
                _panel(axes, beam, apart=apart)
        line[0].set_ylabel("residual / mm", fontsize=8)
    for column in zip(*panels, strict=True):
        lowest = [axes for axes in column if axes.get_visible()][-1]
        lowest.set_xlabel("from the clamp / mm", fontsize=8)
    reach = 1.25e3 * max(_reach(b) for b in beams)
    panels[0][0].set_ylim(-reach, reach)
    _legend(figure, any(b.extended for b in beams))
    return Figure(
        name="residuals",
        caption="Measured minus simulated along the normal, positive upwards: the smooth part that fits"
        " compare, mean of upper and lower edge, registration and the other nuisances taken out."
        + (
            " A line a photograph, darker is later. Band: two standard deviations that the contour's error"
            " gives one line;"
            if apart
            else " Thin lines: photographs, darker is later; thick: their mean. Band: two standard deviations"
            " that the contour's error gives the mean;"
        )
        + " a model that lacks nothing stays within it almost everywhere."
        + left_out(missing),
        figure=figure,
        section="residuals",
    )


def draw_rms(beams: Sequence[DrawnTrial], diagnosis: Diagnosis, *, noise: float) -> Figure:
    """rms distance of each beam and of all: before, after, and held out; noise : rms of noise alone [m]."""
    extended = all(b.extended for b in beams)
    everything = [p for b in beams for p in b.photographs]
    gain = diagnosis.held_out
    figure = paired_bars(
        [*(b.trial.id for b in beams), "all"],
        [*(1e3 * b.rms("before") for b in beams), 1e3 * rms_of(everything, "before")],
        [*(1e3 * b.rms("after") for b in beams), 1e3 * rms_of(everything, "after")] if extended else None,
        quantity="rms distance between measured and simulated edge / mm",
        noise=1e3 * noise,
        held_out=(gain.held_out, 1e3 * gain.rms_before, 1e3 * gain.rms_after)
        if gain is not None and gain.held_out
        else None,
    )
    return Figure(
        name="rms",
        caption="rms of the distance's smooth part over all traced points, registration and the other"
        " nuisances taken out, beam by beam. Dashed: what the measurement's own error leaves; no model should"
        " go far below.",
        figure=figure,
        section="residuals",
    )


def _panel(axes: Any, beam: DrawnTrial, *, apart: bool) -> None:
    plain(axes)
    lines = middles(beam)
    at = 1e3 * lines.at
    band = 2e3 * lines.sd * (np.sqrt(len(lines.before)) if apart else 1.0)
    axes.fill_between(at, -band, band, color=BAND, lw=0, zorder=0)
    axes.axhline(0.0, color=INK, lw=0.6, zorder=1)
    for family, drawn in ((MEASURED, lines.before), (EXTENDED, lines.after)):
        if drawn is None:
            continue
        for n, line in enumerate(drawn):
            colour = shade(family, n, len(drawn))
            axes.plot(at, 1e3 * line, color=colour, lw=1.6 if apart else 0.7, alpha=0.85, zorder=2)
        if not apart:
            axes.plot(at, 1e3 * drawn.mean(axis=0), color=MEAN[family], lw=2.4, zorder=3)
    rms = f"{1e3 * beam.rms('before'):.3f}"
    if beam.extended:
        rms += f" → {1e3 * beam.rms('after'):.3f}"
    axes.set_title(f"{label(beam.trial.id, 30)}   rms {rms} mm", fontsize=8.5, loc="left")
    axes.set_xlim(0.0, 1e3 * float(max(p.upper.along.max() for p in beam.photographs)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Middles:
    """Mid lines of a beam's p photographs at k points; all in m.

    Attributes
    ----------
    at : position along the beam, shape (k,).
    before, after : distances by the baseline and by the extension (None without one), shape (p, k).
    sd : standard deviation of the mean of all photographs by the contour error, shape (k,).
    """

    at: Array
    before: Array
    after: Array | None
    sd: Array


def middles(beam: DrawnTrial) -> Middles:
    edges = [e for p in beam.photographs for e in p.edges]
    at = np.linspace(max(e.along[0] for e in edges), min(e.along[-1] for e in edges), SAMPLES)
    variance = np.array([np.interp(at, e.along, e.smooth_sd) ** 2 for e in edges])
    after = None if edges[0].smooth_after is None else _means(at, beam, "smooth_after")
    return Middles(
        at=at,
        before=_means(at, beam, "smooth_before"),
        after=after,
        sd=np.sqrt(variance.sum(axis=0)) / len(edges),  # contours' errors are independent
    )


def _means(at: Array, beam: DrawnTrial, which: str) -> Array:
    """Mean of the two edges, shape (photographs, k)."""
    return np.array(
        [
            np.mean([np.interp(at, e.along, getattr(e, which)) for e in p.edges], axis=0)
            for p in beam.photographs
        ]
    )


def _reach(beam: DrawnTrial) -> float:
    lines = middles(beam)
    both = [lines.before] if lines.after is None else [lines.before, lines.after]
    return float(max(np.abs(x).max() for x in both))


def _legend(figure: Any, extended: bool) -> None:
    handles = [Line2D([], [], color=MEAN[MEASURED], lw=2.4, label="baseline")]
    if extended:
        handles.append(Line2D([], [], color=MEAN[EXTENDED], lw=2.4, label="extended"))
    figure.legend(handles=handles, loc="outside upper left", ncols=2, fontsize=8.5, frameon=False)
