"""Pictures of pokes for the page of a diagnosis: forces over depth, what is left of them in time, and its
rms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from calibration.diagnosis.pokes._drawn import (
    DrawnRecord,
    drawn,
    legend_of,
    most_telling,
    shown_explanation,
)
from calibration.diagnosis.pokes.model import PokeModel
from calibration.diagnosis.report._bars import AFTER, BEFORE, paired_bars
from calibration.diagnosis.report._domain import Figure, noise_of, pictures_of
from calibration.diagnosis.report._labels import label
from calibration.diagnosis.verdict import Diagnosis
from calibration.report._figure import BAND, INK, paper, plain
from calibration.report._numbers import significant

COLUMNS = 3
MN = 1e3


@pictures_of.register
def poke_pictures(model: PokeModel, diagnosis: Diagnosis) -> list[Figure]:
    """Forces over depth, residuals over time with the noise's band, and rms."""
    records = drawn(model, diagnosis)
    after = legend_of(diagnosis)
    return [
        draw_forces(records, after),
        draw_residuals(records, after),
        draw_rms(records, diagnosis, model.noise_rms(), after),
    ]


@noise_of.register
def poke_noise(model: PokeModel) -> str:
    estimated = any(r.estimated for r in model.records)
    return (
        f"{len(model.records)} records, {model.points} values (of long records the means of neighbours);"
        " the force and depth errors that the lab states, white from point to point"
        + (" (where it states none, an error from the scatter of the record)" if estimated else "")
        + "; the touch, off by the depth's error once a record; the simulation's mesh error: 2.5 % of all"
        " forces together, wandering by 1 % with the depth, by more near the surface; the shear modulus free"
        " for each specimen."
    )


def draw_forces(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel a trial: force over depth, measured and simulated."""
    shown, missing = most_telling(records)
    figure, panels = _grid(len(shown))
    for axes, d in zip(panels, shown, strict=True):
        x = 1e3 * d.record.depth
        for mine, loading in d.phases():
            _dots(axes, x[mine], MN * d.record.force[mine], INK, hollow=not loading)
            axes.plot(x[mine], MN * d.before[mine], color=BEFORE, lw=1.6, zorder=2)
            if d.after is not None:
                axes.plot(x[mine], MN * d.after[mine], color=AFTER, lw=1.6, zorder=2.5)
        _titled(axes, d, "depth / mm", "force / mN")
    _legend(figure, records, after, measured=True)
    return Figure(
        name="forces",
        caption="Dots: measured (hollow: holds and the way back). Lines: simulated." + _missing(missing),
        figure=figure,
    )


def draw_residuals(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel a trial: measured less simulated force over time, with two standard deviations of the
    noise."""
    shown, missing = most_telling(records)
    figure, panels = _grid(len(shown))
    for axes, d in zip(panels, shown, strict=True):
        t = d.record.time - d.record.time[0]
        band = 2.0 * MN * d.sd
        axes.fill_between(t, -band, band, color=BAND, lw=0, zorder=0)
        axes.axhline(0.0, color=INK, lw=0.6, zorder=1)
        for which, colour in (("before", BEFORE), ("after", AFTER)):
            if which == "after" and d.left_after is None:
                continue
            y = MN * d.left(which)
            axes.plot(t, y, color=colour, lw=0.8, alpha=0.6, zorder=2)
            for mine, loading in d.phases():
                _dots(axes, t[mine], y[mine], colour, hollow=not loading)
        _titled(axes, d, "time / s", "left / mN")
    _legend(figure, records, after, measured=False)
    return Figure(
        name="residuals",
        caption="Measured less simulated force (hollow: holds and the way back), the likeliest mesh error and"
        " touch taken out. Band: two standard deviations of the points' error; a model that lacks nothing"
        " stays within it almost everywhere." + _missing(missing),
        figure=figure,
        section="residuals",
    )


def draw_rms(records: Sequence[DrawnRecord], diagnosis: Diagnosis, noise: float, after: str) -> Figure:
    """rms force of each trial and of all, before and after, and held out."""
    shown, missing = most_telling(records)
    extended = shown_explanation(diagnosis) is not None
    gain = diagnosis.gain
    figure = paired_bars(
        [*(d.record.name for d in shown), "all"],
        [MN * v for v in (*(d.rms("before") for d in shown), _all(records, "before"))],
        [MN * v for v in (*(d.rms("after") for d in shown), _all(records, "after"))] if extended else None,
        quantity="rms of measured less simulated force / mN",
        noise=MN * noise,
        held_out=(gain.held_out, MN * gain.rms_before, MN * gain.rms_after)
        if gain is not None and gain.held_out
        else None,
    )
    return Figure(
        name="rms",
        caption="rms of what is left of the force, trial by trial"
        + (f"; after: {after}" if after else "")
        + ". Dashed: the noise alone."
        + _missing(missing),
        figure=figure,
        section="residuals",
    )


def _all(records: Sequence[DrawnRecord], which: str) -> float:
    return float(np.sqrt(np.mean(np.concatenate([d.left(which) for d in records]) ** 2)))


def _grid(count: int) -> tuple[Any, list[Any]]:
    columns = min(count, COLUMNS)
    rows = -(-count // columns)
    figure = paper(11.0, 0.6 + (2.5 if count > COLUMNS else 3.4) * rows)
    panels = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axes in panels[count:]:
        axes.set_visible(False)
    return figure, panels[:count]


def _dots(axes: Any, x: Any, y: Any, colour: str, *, hollow: bool) -> None:
    face = "none" if hollow else colour
    axes.plot(x, y, "o", ms=2.6, mew=0.6, mfc=face, mec=colour, zorder=3)


def _titled(axes: Any, d: DrawnRecord, across: str, up: str) -> None:
    plain(axes)
    rms = significant(MN * d.rms("before"), 3)
    if d.left_after is not None:
        rms += f" → {significant(MN * d.rms('after'), 3)}"
    axes.set_title(f"{label(d.record.name, 26)}\nrms {rms} mN", fontsize=8.5, loc="left")
    axes.set_xlabel(across, fontsize=8)
    axes.set_ylabel(up, fontsize=8)


def _legend(figure: Any, records: Sequence[DrawnRecord], after: str, *, measured: bool) -> None:
    handles = [Line2D([], [], color=BEFORE, lw=2, label="baseline")]
    if measured:
        handles.insert(0, Line2D([], [], ls="", marker="o", ms=4, color=INK, label="measured"))
    if any(d.after is not None for d in records):
        handles.append(Line2D([], [], color=AFTER, lw=2, label=after))
    figure.legend(handles=handles, loc="outside upper left", ncols=3, fontsize=8.5, frameon=False)


def _missing(count: int) -> str:
    return f" {count} trials that depart less are not drawn." if count else ""
