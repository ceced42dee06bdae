"""Pictures of coupons for the page of a diagnosis: curves, what is left of them, and its rms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from calibration.diagnosis.coupons._drawn import (
    DrawnRecord,
    Kind,
    drawn,
    legend_of,
    most_telling,
    shown_explanation,
)
from calibration.diagnosis.coupons.model import CouponModel
from calibration.diagnosis.report._bars import AFTER, BEFORE, paired_bars
from calibration.diagnosis.report._domain import Figure, noise_of, pictures_of
from calibration.diagnosis.report._labels import label
from calibration.diagnosis.verdict import Diagnosis
from calibration.report._figure import COLOURS, INK, paper, plain
from calibration.report._numbers import significant

Array = NDArray[np.float64]

COLUMNS = 3
DOTS = 12  # a branch, where what is left is drawn
LOOK: dict[Kind, str] = {"loading": COLOURS[0], "unloading": COLOURS[1], "loading again": COLOURS[2]}
_KPA = 1e-3


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
        draw_rms(records, diagnosis, after),
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
    shown, missing = most_telling(records)
    figure, panels = _grid(len(shown))
    for axes, d in zip(panels, shown, strict=True):
        x = _strain(d)
        for mine, kind in d.branches():
            _dots(axes, x[mine], _KPA * d.record.stress[mine], INK, hollow=kind == "unloading")
            axes.plot(x[mine], _KPA * d.before[mine], color=BEFORE, lw=1.6, zorder=2)
            if d.after is not None:
                axes.plot(x[mine], _KPA * d.after[mine], color=AFTER, lw=1.6, zorder=2.5)
        _titled(axes, d, "nominal stress / kPa")
    _legend(figure, records, after)
    return Figure(
        name="curves",
        caption="Dots: measured (hollow: unloading). Lines: simulated." + _missing(missing),
        figure=figure,
    )


def draw_residuals(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel a trial: measured less baseline, in means of neighbouring points, and what the extension adds
    to the baseline: where it says what the baseline lacks, its lines go through the dots."""
    shown, missing = most_telling(records)
    figure, panels = _grid(len(shown))
    kinds: dict[Kind, None] = {}
    for axes, d in zip(panels, shown, strict=True):
        x = _strain(d)
        axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
        for mine, kind in d.branches():
            kinds[kind] = None
            _means(axes, x[mine], _KPA * d.left("before")[mine], _KPA * d.record.sd[mine], kind)
            if d.after is not None:
                added = _KPA * (d.after - d.before)[mine]
                axes.plot(x[mine], added, color=LOOK[kind], lw=2.0, zorder=2)
        _titled(axes, d, "above the baseline / kPa")
    handles: list[Any] = [
        Line2D([], [], ls="", marker="o", ms=4, color=LOOK[k], label=f"measured, {k}") for k in kinds
    ]
    if any(d.after is not None for d in records):
        handles.append(Line2D([], [], color=INK, lw=2, label=after))
    figure.legend(handles=handles, loc="outside upper left", ncols=4, fontsize=8.5, frameon=False)
    return Figure(
        name="residuals",
        caption="Dots: measured less baseline stress, means of neighbouring points with their standard"
        " deviation."
        + (" Lines: what is added to the baseline; right where they go through the dots." if after else "")
        + _missing(missing),
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


def draw_rms(records: Sequence[DrawnRecord], diagnosis: Diagnosis, after: str) -> Figure:
    """rms stress of each trial and of all, before and after, and held out."""
    shown, missing = most_telling(records)
    extended = shown_explanation(diagnosis) is not None
    gain = diagnosis.gain
    noise = float(np.sqrt(np.mean(np.concatenate([d.record.sd for d in records]) ** 2)))
    figure = paired_bars(
        [*(d.record.name for d in shown), "all"],
        [_KPA * v for v in (*(d.rms("before") for d in shown), _all(records, "before"))],
        [_KPA * v for v in (*(d.rms("after") for d in shown), _all(records, "after"))] if extended else None,
        quantity="rms of measured less simulated stress / kPa",
        noise=_KPA * noise,
        held_out=(gain.held_out, _KPA * gain.rms_before, _KPA * gain.rms_after)
        if gain is not None and gain.held_out
        else None,
    )
    return Figure(
        name="rms",
        caption="rms of what is left of the stress, trial by trial"
        + (f"; after: {after}" if after else "")
        + ". Dashed: the points' own error."
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


def _strain(d: DrawnRecord) -> Any:
    return d.record.stretch - 1.0 if d.record.mode == "simple-shear" else d.record.stretch


def _dots(axes: Any, x: Any, y: Any, colour: str, *, hollow: bool) -> None:
    face = "none" if hollow else colour
    axes.plot(x, y, "o", ms=2.6, mew=0.6, mfc=face, mec=colour, zorder=3)


def _titled(axes: Any, d: DrawnRecord, quantity: str) -> None:
    plain(axes)
    rms = significant(_KPA * d.rms("before"), 3)
    if d.after is not None:
        rms += f" → {significant(_KPA * d.rms('after'), 3)}"
    axes.set_title(f"{label(d.record.name, 26)} ({d.record.mode})\nrms {rms} kPa", fontsize=8.5, loc="left")
    axes.set_xlabel("shear" if d.record.mode == "simple-shear" else "stretch", fontsize=8)
    axes.set_ylabel(quantity, fontsize=8)


def _legend(figure: Any, records: Sequence[DrawnRecord], after: str) -> None:
    handles = [
        Line2D([], [], ls="", marker="o", ms=4, color=INK, label="measured"),
        Line2D([], [], color=BEFORE, lw=2, label="baseline"),
    ]
    if any(d.after is not None for d in records):
        handles.append(Line2D([], [], color=AFTER, lw=2, label=after))
    figure.legend(handles=handles, loc="outside upper left", ncols=3, fontsize=8.5, frameon=False)


def _missing(count: int) -> str:
    return f" {count} trials that depart less are not drawn." if count else ""
