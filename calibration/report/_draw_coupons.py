"""Pictures of coupons: measured curves, and those of each law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np

from calibration.coupons import CouponObjective, nominal_stress, percent_error
from calibration.report._figure import FAINT, INK, Look, Picture, looks, paper, picture, plain
from calibration.study.calibration import Calibration
from tisim import Material


def material_of(result: Calibration) -> Material:
    """As a simulation takes it; coupons do not see the density."""
    return Material(law=result.law, parameters=dict(result.parameters), density=result.density or 1000.0)


def coupon_errors(coupon: CouponObjective, results: Sequence[Calibration]) -> Mapping[str, float]:
    """rms error of each law [% of the curve's largest stress]; NaN without an answer."""
    if not np.abs(coupon.trial.stress).max(initial=0.0):
        return {r.label: float("nan") for r in results}
    return {r.label: percent_error(coupon.trial, material_of(r)) for r in results}


def draw_coupons(
    coupons: Sequence[CouponObjective], results: Sequence[Calibration], chosen: str | None, name: str
) -> Picture:
    """One panel a test: stress over stretch, measured and fitted."""
    columns = min(3, len(coupons))
    rows = ceil(len(coupons) / columns)
    figure = paper(max(6.0, 4.0 * columns), 0.5 + 3.2 * rows)
    grid = figure.subplots(rows, columns, squeeze=False)
    fitted = [r for r in results if r.parameters]
    by_law = looks(r.label for r in results)
    for axes, coupon in zip(grid.flat, coupons, strict=False):
        _panel(axes, coupon, fitted, chosen, by_law)
    for axes in grid.flat[len(coupons) :]:
        axes.set_visible(False)
    for row in grid:
        row[0].set_ylabel("nominal stress / kPa", fontsize=9)
    # the bars come last to matplotlib, and first to a reader
    handles, names = (x[-1:] + x[:-1] for x in grid.flat[0].get_legend_handles_labels())
    figure.legend(
        handles, names, loc="outside upper left", ncols=min(4, len(names)), fontsize=8, frameon=False
    )
    return picture(
        figure,
        f"{name}-coupons",
        "Coupons: nominal stress measured (dots, bars of two standard deviations) and of each law fitted"
        + (f"; {chosen} leads and is drawn thick." if chosen else "."),
    )


def _panel(
    axes: Any,
    coupon: CouponObjective,
    fitted: Sequence[Calibration],
    chosen: str | None,
    by_law: Mapping[str, Look],
) -> None:
    trial = coupon.trial
    plain(axes).set_title(f"{trial.id}, {trial.mode}", fontsize=9, loc="left")
    shear = trial.mode == "simple-shear"
    axes.set_xlabel("shear" if shear else "stretch", fontsize=9)
    start = 1.0 if shear else 0.0
    axes.axhline(0.0, color=FAINT, lw=0.5)
    axes.errorbar(
        trial.stretch - start,
        trial.stress / 1e3,
        yerr=2e-3 * coupon.sd,
        fmt="o",
        ms=3,
        lw=0.7,
        color=INK,
        label="measured",
        zorder=1,
    )
    stretch = np.linspace(float(trial.stretch.min()), float(trial.stretch.max()), 120)
    for r in fitted:
        stress = nominal_stress(material_of(r), trial.mode, stretch)
        thick = r.label == chosen
        axes.plot(
            stretch - start,
            stress / 1e3,
            color=by_law[r.label].colour,
            ls="-" if thick else by_law[r.label].line,
            lw=2.2 if thick else 1.1,
            label=r.label,
            zorder=3 if thick else 2,
        )
