"""Pictures of pokes for the page of a diagnosis: forces over depth, what is left of them in time, and its
rms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from calibration.diagnosis.drawing import (
    AFTER,
    BEFORE,
    Figure,
    dots,
    draw_rms,
    label,
    legend,
    legend_of,
    missing,
    most_telling,
    noise_of,
    panels,
    pictures_of,
    titled,
)
from calibration.diagnosis.pokes._drawn import DrawnRecord, drawn
from calibration.diagnosis.pokes.model import PokeModel
from calibration.diagnosis.verdict import Diagnosis
from calibration.report import BAND, INK

MN = 1e3
UNIT = ("mN", MN)


@pictures_of.register
def poke_pictures(model: PokeModel, diagnosis: Diagnosis) -> list[Figure]:
    """Forces over depth, residuals over time with the noise's band, and rms."""
    records = drawn(model, diagnosis)
    after = legend_of(diagnosis)
    return [
        draw_forces(records, after),
        draw_residuals(records, after),
        draw_rms(
            records,
            diagnosis,
            after,
            quantity="force",
            unit=UNIT,
            noise=model.noise_rms(),
            dashed="the noise alone",
        ),
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
    shown, unshown = most_telling(records)
    figure, each = panels(len(shown))
    for axes, d in zip(each, shown, strict=True):
        x = 1e3 * d.record.depth
        for mine, loading in d.phases():
            dots(axes, x[mine], MN * d.record.force[mine], INK, hollow=not loading)
            axes.plot(x[mine], MN * d.before[mine], color=BEFORE, lw=1.6, zorder=2)
            if d.after is not None:
                axes.plot(x[mine], MN * d.after[mine], color=AFTER, lw=1.6, zorder=2.5)
        _titled(axes, d, "depth / mm", "force / mN")
    legend(figure, records, after)
    return Figure(
        name="forces",
        caption="Dots: measured (hollow: holds and the way back). Lines: simulated." + missing(unshown),
        figure=figure,
    )


def draw_residuals(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel a trial: measured less simulated force over time, with two standard deviations of the
    noise."""
    shown, unshown = most_telling(records)
    figure, each = panels(len(shown))
    for axes, d in zip(each, shown, strict=True):
        t = d.record.time - d.record.time[0]
        band = 2.0 * MN * d.sd
        axes.fill_between(t, -band, band, color=BAND, lw=0, zorder=0)
        axes.axhline(0.0, color=INK, lw=0.6, zorder=1)
        for which, colour in (("before", BEFORE), ("after", AFTER)):
            if which == "after" and not d.extended:
                continue
            y = MN * d.left(which)
            axes.plot(t, y, color=colour, lw=0.8, alpha=0.6, zorder=2)
            for mine, loading in d.phases():
                dots(axes, t[mine], y[mine], colour, hollow=not loading)
        _titled(axes, d, "time / s", "left / mN")
    legend(figure, records, after, measured=False)
    return Figure(
        name="residuals",
        caption="Measured less simulated force (hollow: holds and the way back), the likeliest mesh error and"
        " touch taken out. Band: two standard deviations of the points' error; a model that lacks nothing"
        " stays within it almost everywhere." + missing(unshown),
        figure=figure,
        section="residuals",
    )


def _titled(axes: Any, d: DrawnRecord, across: str, up: str) -> None:
    titled(axes, d, label(d.name, 26), across, up, unit=UNIT)
