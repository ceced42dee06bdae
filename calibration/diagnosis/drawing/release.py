"""Figures of cantilever releases for the page of a diagnosis: tip over time, residuals, their rms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.drawing._bars import AFTER, BEFORE
from calibration.diagnosis.drawing._curves import DrawnCurve, before_and_after, legend_of
from calibration.diagnosis.drawing._domain import Figure, figures_of
from calibration.diagnosis.drawing._panels import dots, draw_rms, legend_handles, per_trial, titled
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements.release._record import Record
from calibration.measurements.release.model import ReleaseModel
from calibration.pages import INK

Array = NDArray[np.float64]

_MM = 1e3
UNIT = ("mm", _MM)
TICKS = [a * 10.0**b for b in range(-3, 5) for a in (1.0, 2.0, 5.0)]
FINE = 2000  # points of a simulated curve


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRelease(DrawnCurve):
    """Height of the tip of a record, the mean of its outer markers.

    Attributes
    ----------
    record : the record.
    time : time since the release [s], shape (k,).
    height : measured height [m], shape (k,).
    tip_before, tip_after : measured minus simulated height without the most likely nuisances, by the baseline
        and by the extension (None without one) [m], shape (k,).
    lines : simulated curves: time [s], height by the baseline and by the extension [m].
    """

    record: Record
    time: Array
    height: Array
    tip_before: Array
    tip_after: Array | None
    lines: tuple[Array, Array, Array | None]


@figures_of.register(ReleaseModel)
def release_figures(model: ReleaseModel, diagnosis: Diagnosis) -> list[Figure]:
    """Figures of the tip, its residuals, and the rms of all markers. ValueError without an equilibrium."""
    releases = drawn(model, diagnosis)
    after = legend_of(diagnosis)
    return [
        draw_motion(releases, after),
        draw_residuals(releases, after),
        draw_rms(
            releases,
            diagnosis,
            after,
            quantity="displacement",
            unit=UNIT,
            noise=model.noise_rms(),
            dashed="the markers' own error",
        ),
    ]


def drawn(model: ReleaseModel, diagnosis: Diagnosis) -> list[DrawnRelease]:
    """All records with the motion by the baseline and by the extension."""
    fine = [np.linspace(0.0, float(r.time[-1] - r.release_time), FINE) for r in model.records]
    left = before_and_after(diagnosis, lambda state: [-x for x in model.registered(state)])
    lines = before_and_after(
        diagnosis, lambda state: [model.tip_height(k, state, time) for k, time in enumerate(fine)]
    )
    return [
        _drawn(r, rows, (time, *heights))
        for r, rows, time, heights in zip(model.records, left, fine, lines, strict=True)
    ]


def _drawn(
    r: Record, left: tuple[Array, Array | None], lines: tuple[Array, Array, Array | None]
) -> DrawnRelease:
    """Data of a record; left : measured minus simulated rows by the baseline and by the extension."""
    before, after = left
    marker, axis, time = r.labels()
    there = np.isfinite(r.deviations())
    tips = np.flatnonzero(r.outer)

    def tip(rows: Array) -> Array:
        """Mean over the outer markers, in z, of the rows after the release."""
        each = [rows[(marker == i) & (axis == 1) & np.isfinite(time)] for i in tips]
        shortest = min(len(e) for e in each)
        return np.asarray(np.mean([e[:shortest] for e in each], axis=0))

    return DrawnRelease(
        name=r.name,
        left_before=before[there],
        left_after=None if after is None else after[there],
        sd=r.deviations()[there],
        record=r,
        time=tip(time),
        height=tip(r.measured()),
        tip_before=tip(before),
        tip_after=None if after is None else tip(after),
        lines=lines,
    )


def draw_motion(releases: Sequence[DrawnRelease], after: str) -> Figure:
    """One panel per trial: height of the tip over time, measured and simulated."""

    def draw(axes: Any, d: DrawnRelease) -> None:
        time, before, extended = d.lines
        dots(axes, d.time, _MM * d.height, INK, hollow=False)
        axes.plot(time, _MM * before, color=BEFORE, lw=1.2, zorder=2)
        if extended is not None:
            axes.plot(time, _MM * extended, color=AFTER, lw=1.2, zorder=2.5)
        titled(axes, d, "time since release / s", "height of the tip / mm", unit=UNIT)

    return per_trial(
        releases,
        draw,
        name="motion",
        caption="Dots: measured, the mean of the outer markers. Lines: simulated, without nuisances.",
        handles=legend_handles(releases, after),
    )


def draw_residuals(releases: Sequence[DrawnRelease], after: str) -> Figure:
    """One panel per trial: measured minus simulated height of the tip, over the logarithm of time."""

    def draw(axes: Any, d: DrawnRelease) -> None:
        axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
        axes.plot(d.time, _MM * d.tip_before, "-", color=BEFORE, lw=1.2)
        if d.tip_after is not None:
            axes.plot(d.time, _MM * d.tip_after, "-", color=AFTER, lw=1.2)
        axes.set_xscale("log")
        ticks = [x for x in TICKS if d.time[0] <= x <= d.time[-1]]
        axes.set_xticks(ticks, [f"{x:g}" for x in ticks])
        axes.minorticks_off()
        titled(axes, d, "time since release / s", "measured - simulated / mm", unit=UNIT)

    return per_trial(
        releases,
        draw,
        name="residuals",
        caption="Measured less simulated height of the tip, the most likely nuisances removed, by the"
        " baseline and by the extension.",
        handles=legend_handles(releases, after, measured=False),
        section="residuals",
    )
