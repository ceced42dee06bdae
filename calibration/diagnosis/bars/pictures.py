"""Pictures of bars for the page of a diagnosis: the tip through time, what is left of it, and its rms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._record import Record
from calibration.diagnosis.bars.model import BarModel
from calibration.diagnosis.drawing import (
    AFTER,
    BEFORE,
    DrawnCurve,
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
    shown_explanation,
    titled,
)
from calibration.diagnosis.nested import State
from calibration.diagnosis.verdict import Diagnosis
from calibration.report._figure import INK

Array = NDArray[np.float64]

_MM = 1e3
UNIT = ("mm", _MM)
TICKS = [a * 10.0**b for b in range(-3, 5) for a in (1.0, 2.0, 5.0)]
FINE = 2000  # points of a simulated curve


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnBar(DrawnCurve):
    """A record's tip: time since the release [s] and measured height (k,) of the outer markers' mean [m];
    what is left of it, with nuisances taken out; lines: simulated (time, before, after)."""

    record: Record
    time: Array
    height: Array
    tip_before: Array
    tip_after: Array | None
    lines: tuple[Array, Array, Array | None]


@pictures_of.register
def bar_pictures(model: BarModel, diagnosis: Diagnosis) -> list[Figure]:
    """The tip, its residual, and the rms of all markers. ValueError where a bar has no equilibrium."""
    bars = drawn(model, diagnosis)
    after = legend_of(diagnosis)
    return [
        draw_motion(bars, after),
        draw_left(bars, after),
        draw_rms(
            bars,
            diagnosis,
            after,
            quantity="displacement",
            unit=UNIT,
            noise=model.noise_rms(),
            dashed="the markers' own error",
        ),
    ]


@noise_of.register
def bar_noise(model: BarModel) -> str:
    return (
        f"{len(model.records)} records, {model.points} points (means of neighbouring samples, in x and z):"
        " the marker error that the lab states, white from sample to sample. Nuisances, one draw a trial: the"
        " cameras' frame (2 degrees), where markers are counted from, a twist of the tip; one draw a marker:"
        " its place (1 mm); one draw in all: a fifth of what FEM adds to the reduced bar, what halving its"
        " mesh moves, 0.5 % of inertia. Free: the modulus of each specimen, one relaxation time a material,"
        " when and where each trial was let go."
    )


def drawn(model: BarModel, diagnosis: Diagnosis) -> list[DrawnBar]:
    """All records. Where nothing is named, what explains most of an unexplained departure stands for the
    extension."""
    shown = shown_explanation(diagnosis.finding, diagnosis.chosen)
    base = diagnosis.finding.baseline.state
    states = [base] if shown is None else [base, shown.fit.state]
    left = [model.registered(s) for s in states]
    return [_drawn(model, k, states, [x[k] for x in left]) for k in range(len(model.records))]


def _drawn(model: BarModel, k: int, states: Sequence[State], left: Sequence[Array]) -> DrawnBar:
    r = model.records[k]
    marker, axis, time = r.labels()
    there = np.isfinite(r.deviations())
    tips = np.flatnonzero(r.tips)

    def tip(rows: Array) -> Array:
        """Mean over the outer markers, in z, of what is not held."""
        each = [rows[(marker == i) & (axis == 1) & np.isfinite(time)] for i in tips]
        shortest = min(len(e) for e in each)
        return np.asarray(np.mean([e[:shortest] for e in each], axis=0))

    fine = np.linspace(0.0, float(r.time[-1] - r.released), FINE)
    curves = [model.tip_height(k, s, fine) for s in states]
    return DrawnBar(
        name=r.name,
        left_before=-left[0][there],
        left_after=-left[1][there] if len(left) > 1 else None,
        sd=r.deviations()[there],
        record=r,
        time=tip(time),
        height=tip(r.measured()),
        tip_before=-tip(left[0]),
        tip_after=-tip(left[1]) if len(left) > 1 else None,
        lines=(fine, curves[0], curves[1] if len(curves) > 1 else None),
    )


def draw_motion(bars: Sequence[DrawnBar], after: str) -> Figure:
    """One panel a trial: the tip's height through time, measured and simulated."""
    shown, unshown = most_telling(bars)
    figure, each = panels(len(shown))
    for axes, d in zip(each, shown, strict=True):
        time, before, extended = d.lines
        dots(axes, d.time, _MM * d.height, INK, hollow=False)
        axes.plot(time, _MM * before, color=BEFORE, lw=1.2, zorder=2)
        if extended is not None:
            axes.plot(time, _MM * extended, color=AFTER, lw=1.2, zorder=2.5)
        titled(axes, d, label(d.name, 26), "time since release / s", "height of the tip / mm", unit=UNIT)
    legend(figure, shown, after)
    return Figure(
        name="motion",
        caption="Dots: measured, the mean of the outer markers. Lines: simulated, nuisances not taken out."
        + missing(unshown),
        figure=figure,
    )


def draw_left(bars: Sequence[DrawnBar], after: str) -> Figure:
    """One panel a trial: measured less simulated height of the tip, over the logarithm of time."""
    shown, unshown = most_telling(bars)
    figure, each = panels(len(shown))
    for axes, d in zip(each, shown, strict=True):
        axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
        axes.plot(d.time, _MM * d.tip_before, "-", color=BEFORE, lw=1.2)
        if d.tip_after is not None:
            axes.plot(d.time, _MM * d.tip_after, "-", color=AFTER, lw=1.2)
        axes.set_xscale("log")
        shown_ticks = [x for x in TICKS if d.time[0] <= x <= d.time[-1]]
        axes.set_xticks(shown_ticks, [f"{x:g}" for x in shown_ticks])
        axes.minorticks_off()
        titled(axes, d, label(d.name, 26), "time since release / s", "measured - simulated / mm", unit=UNIT)
    legend(figure, shown, after, measured=False)
    return Figure(
        name="residuals",
        caption="What is left of the tip's height, nuisances taken out, by the baseline and by the extension."
        + missing(unshown),
        figure=figure,
        section="residuals",
    )
