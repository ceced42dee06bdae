"""Pictures of records: stress over stretch of homogeneous tests, force over depth of indentations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponTrial
from calibration.measurements.homogeneous import nominal_stress, predicted
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.indentation.model import IndentationModel
from calibration.measurements.objective import ModelObjective
from calibration.pages import BAND, COLOURS, FAINT, INK, Look, Picture, looks, paper, picture, plain
from calibration.study.calibration import Calibration
from tisim import Material

Array = NDArray[np.float64]
Coupon = tuple[CouponTrial, Record]  # a homogeneous test, and its points as a fit compares them


def material_of(result: Calibration) -> Material:
    """Material of a fit for a simulation; homogeneous tests do not depend on the density."""
    return result.simulated()


def coupon_errors(coupon: Coupon, results: Sequence[Calibration]) -> Mapping[str, float]:
    """rms error of each law over the points that a fit compares [% of their largest stress].

    NaN without a solution.
    """
    _, record = coupon
    largest = float(np.abs(record.stress).max(initial=0.0))
    if not largest:
        return {r.label: float("nan") for r in results}
    found = {}
    for r in results:
        if r.parts or r.held:  # along the record's course
            along = predicted(material_of(r), [(record, record.stretch)])[0]
        else:
            along = nominal_stress(material_of(r), record.mode, record.stretch)
        found[r.label] = 100.0 * float(np.sqrt(np.mean((along - record.stress) ** 2))) / largest
    return found


def draw_coupons(
    coupons: Sequence[Coupon], results: Sequence[Calibration], chosen: str | None, name: str
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
        "Homogeneous tests: nominal stress measured (dots, bars of two standard deviations) and of each law"
        + (f"; {chosen} leads and is drawn thick." if chosen else "."),
    )


def _panel(
    axes: Any,
    coupon: Coupon,
    fitted: Sequence[Calibration],
    chosen: str | None,
    by_law: Mapping[str, Look],
) -> None:
    trial, record = coupon
    if record.course is not None and np.isfinite(record.time).all():
        _over_time(axes, coupon, fitted, chosen, by_law)
        return
    plain(axes).set_title(f"{trial.id}, {trial.mode}", fontsize=9, loc="left")
    shear = trial.mode == "simple-shear"
    axes.set_xlabel("shear" if shear else "stretch", fontsize=9)
    start = 1.0 if shear else 0.0
    _measured(axes, record, record.stretch - start, size=3)
    stretch = np.linspace(float(record.stretch.min()), float(record.stretch.max()), 120)
    for r in fitted:
        if r.parts or r.held:  # damage alone: loading and unloading without a clock
            along = predicted(material_of(r), [(record, record.stretch)])[0]
            _line(axes, record.stretch - start, along, r.label, chosen, by_law)
        else:
            stress = nominal_stress(material_of(r), trial.mode, stretch)
            _line(axes, stretch - start, stress, r.label, chosen, by_law)


def _over_time(
    axes: Any,
    coupon: Coupon,
    fitted: Sequence[Calibration],
    chosen: str | None,
    by_law: Mapping[str, Look],
) -> None:
    """Stress over time, of materials that remember."""
    trial, record = coupon
    plain(axes).set_title(f"{trial.id}, {trial.mode}", fontsize=9, loc="left")
    axes.set_xlabel("time / s", fontsize=9)
    _measured(axes, record, record.time, size=2)
    for r in fitted:
        along = predicted(material_of(r), [(record, record.stretch)])[0]
        _line(axes, record.time, along, r.label, chosen, by_law)


def _measured(axes: Any, record: Record, x: Array, *, size: float) -> None:
    """Measured stress over x, with bars of two standard deviations."""
    axes.axhline(0.0, color=FAINT, lw=0.5)
    axes.errorbar(
        x,
        record.stress / 1e3,
        yerr=2e-3 * record.sd,
        fmt="o",
        ms=size,
        lw=0.25 * size,
        color=INK,
        label="measured",
        zorder=1,
    )


def _line(
    axes: Any, x: Array, stress: Array, label: str, chosen: str | None, by_law: Mapping[str, Look]
) -> None:
    thick = label == chosen
    axes.plot(
        x,
        stress / 1e3,
        color=by_law[label].colour,
        ls="-" if thick else by_law[label].line,
        lw=2.2 if thick else 1.1,
        label=label,
        zorder=3 if thick else 2,
    )


def draw_indentations(
    pokes: ModelObjective[IndentationModel], chosen: Calibration, name: str
) -> Picture | None:
    """One column an indentation: force over depth, and what is left of it; None where none has an answer."""
    u = np.array(chosen.u)
    if not pokes.linearise(u):
        return None
    model = pokes.model
    simulated, noise = model.forces(pokes.state(u)), model.point_sds()
    columns = min(3, len(model.records))
    blocks = ceil(len(model.records) / columns)
    figure = paper(max(6.0, 4.0 * columns), 0.6 + 4.2 * blocks)
    grid = figure.subplots(2 * blocks, columns, squeeze=False, height_ratios=[2.0, 1.0] * blocks)
    for axes in grid.flat:
        axes.set_visible(False)
    for i, record in enumerate(model.records):
        row, column = 2 * (i // columns), i % columns
        used = np.isfinite(noise[i])  # the law's simulation reached them
        depth, force, fitted, sd = (x[used] for x in (record.depth, record.force, simulated[i], noise[i]))
        _force_panel(grid[row, column], record.name, depth, force, sd, fitted, chosen.label)
        _residual_panel(grid[row + 1, column], depth, force - fitted, sd)
    handles, names = grid.flat[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper left", ncols=4, fontsize=8, frameon=False)
    return picture(
        figure,
        f"{name}-indentations",
        "Indentation: force along the indenter over depth, measured (dots, bars of two"
        f" standard deviations) and simulated with {chosen.label} (line); below, measured minus simulated,"
        " band of two standard deviations of the noise. The depth of first contact and the mesh's error are"
        " as stated, before the fit's nuisances.",
    )


def _force_panel(axes: Any, title: str, depth: Any, force: Any, sd: Any, simulated: Any, label: str) -> None:
    axes.set_visible(True)
    plain(axes).set_title(title, fontsize=9, loc="left")
    axes.errorbar(
        1e3 * depth, force, yerr=2.0 * sd, fmt="o", ms=3, lw=0.7, color=INK, label="measured", zorder=1
    )
    axes.plot(1e3 * depth, simulated, lw=2.0, color=COLOURS[0], label=f"simulated, {label}", zorder=2)
    axes.set_ylabel("force / N", fontsize=9)
    axes.set_ylim(bottom=min(0.0, float(np.min(force))))
    axes.set_xlim(left=0.0)


def _residual_panel(axes: Any, depth: Any, left: Any, sd: Any) -> None:
    axes.set_visible(True)
    plain(axes).fill_between(1e3 * depth, -2.0 * sd, 2.0 * sd, color=BAND, lw=0)
    axes.axhline(0.0, color=FAINT, lw=0.6)
    axes.plot(1e3 * depth, left, "o-", ms=2.5, lw=0.8, color=COLOURS[0])
    axes.set_ylabel("residual / N", fontsize=9)
    axes.set_xlabel("depth / mm", fontsize=9)
    axes.set_xlim(left=0.0)
