"""Pictures of coupons for the page of a diagnosis: curves, what is left of them, and its rms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from calibration.diagnosis.coupons._drawn import DrawnRecord, Kind, drawn
from calibration.diagnosis.coupons.model import CouponModel
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
from calibration.diagnosis.verdict import Diagnosis
from calibration.report import COLOURS, INK

Array = NDArray[np.float64]

DOTS = 12  # a branch, where what is left is drawn
LOOK: dict[Kind, str] = {"loading": COLOURS[0], "unloading": COLOURS[1], "loading again": COLOURS[2]}
_KPA = 1e-3
UNIT = ("kPa", _KPA)


@pictures_of.register
def coupon_pictures(model: CouponModel, diagnosis: Diagnosis) -> list[Figure]:
    """Curves, residuals with the noise's band, and rms. ValueError where a law has no stress."""
    records = drawn(model, diagnosis)
    if not all(np.isfinite(d.before).all() for d in records):
        raise ValueError("the law has no stress at the baseline")
    after = legend_of(diagnosis)
    return [
        draw_curves(records, after),
        draw_residuals(records, after),
        draw_rms(
            records,
            diagnosis,
            after,
            quantity="stress",
            unit=UNIT,
            noise=float(np.sqrt(np.mean(np.concatenate([d.sd for d in records]) ** 2))),
            dashed="the points' own error",
        ),
    ]


@noise_of.register
def coupon_noise(model: CouponModel) -> str:
    stated = [r for r in model.records if not r.estimated]
    parts = []
    if stated:
        parts.append("the stress and stretch errors that the lab states, white from point to point")
    if len(stated) < len(model.records):
        parts.append(
            "where it states none, an error from the scatter about a smooth curve, at least 0.5 % of the"
            " stress"
        )
    return (
        f"{len(model.records)} records, {model.points} points (of long records the means of neighbours); "
        + "; ".join(parts)
        + "; the shear modulus free for each specimen."
    )


def draw_curves(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel a trial: stress over stretch, measured and simulated."""
    shown, unshown = most_telling(records)
    figure, each = panels(len(shown))
    for axes, d in zip(each, shown, strict=True):
        x = _strain(d)
        for mine, kind in d.branches():
            dots(axes, x[mine], _KPA * d.record.stress[mine], INK, hollow=kind == "unloading")
            axes.plot(x[mine], _KPA * d.before[mine], color=BEFORE, lw=1.6, zorder=2)
            if d.after is not None:
                axes.plot(x[mine], _KPA * d.after[mine], color=AFTER, lw=1.6, zorder=2.5)
        _titled(axes, d, "nominal stress / kPa")
    legend(figure, records, after)
    return Figure(
        name="curves",
        caption="Dots: measured (hollow: unloading). Lines: simulated." + missing(unshown),
        figure=figure,
    )


def draw_residuals(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel a trial: measured less baseline, in means of neighbouring points, and what the extension adds
    to the baseline: where it says what the baseline lacks, its lines go through the dots."""
    shown, unshown = most_telling(records)
    figure, each = panels(len(shown))
    kinds: dict[Kind, None] = {}
    for axes, d in zip(each, shown, strict=True):
        x = _strain(d)
        axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
        for mine, kind in d.branches():
            kinds[kind] = None
            _means(axes, x[mine], _KPA * d.left("before")[mine], _KPA * d.sd[mine], kind)
            if d.after is not None:
                added = _KPA * (d.after - d.before)[mine]
                axes.plot(x[mine], added, color=LOOK[kind], lw=2.0, zorder=2)
        _titled(axes, d, "above the baseline / kPa")
    handles: list[Any] = [
        Line2D([], [], ls="", marker="o", ms=4, color=LOOK[k], label=f"measured, {k}") for k in kinds
    ]
    if any(d.extended for d in records):
        handles.append(Line2D([], [], color=INK, lw=2, label=after))
    figure.legend(handles=handles, loc="outside upper left", ncols=4, fontsize=8.5, frameon=False)
    return Figure(
        name="residuals",
        caption="Dots: measured less baseline stress, means of neighbouring points with their standard"
        " deviation."
        + (" Lines: what is added to the baseline; right where they go through the dots." if after else "")
        + missing(unshown),
        figure=figure,
        section="residuals",
    )


def _means(axes: Any, x: Array, y: Array, sd: Array, kind: Kind) -> None:
    """Dots with error bars: weighted means of neighbours."""
    parts = np.array_split(np.arange(x.size), min(x.size, DOTS))
    weights = [sd[p] ** -2.0 for p in parts]
    axes.errorbar(
        [float(np.average(x[p], weights=w)) for p, w in zip(parts, weights, strict=True)],
        [float(np.average(y[p], weights=w)) for p, w in zip(parts, weights, strict=True)],
        yerr=[float(w.sum() ** -0.5) for w in weights],
        fmt="o",
        ms=3.5,
        lw=0.9,
        color=LOOK[kind],
        zorder=3,
    )


def _strain(d: DrawnRecord) -> Any:
    return d.record.stretch - 1.0 if d.record.mode == "simple-shear" else d.record.stretch


def _titled(axes: Any, d: DrawnRecord, quantity: str) -> None:
    across = "shear" if d.record.mode == "simple-shear" else "stretch"
    titled(axes, d, f"{label(d.name, 26)} ({d.record.mode})", across, quantity, unit=UNIT)
