"""Figures of homogeneous tests for the page of a diagnosis: curves, residuals, rms of residuals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from calibration._numerics import rms_of
from calibration.diagnosis.drawing._curves import DrawnCurve, before_and_after, legend_of, most_telling
from calibration.diagnosis.drawing._domain import Figure, Section, figures_of
from calibration.diagnosis.drawing._panels import (
    PANELS,
    draw_rms,
    legend_handles,
    measured_and_simulated,
    per_trial,
    titled,
)
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.pages import COLOURS, INK

Array = NDArray[np.float64]

Kind = Literal["loading", "unloading", "loading again"]
SEEN = 0.03  # fraction of a record's largest stress: a difference that is visible between its curves
DOTS = 12  # points of a branch in the figure of residuals
LOOK: dict[Kind, str] = {"loading": COLOURS[0], "unloading": COLOURS[1], "loading again": COLOURS[2]}
_KPA = 1e-3
UNIT = ("kPa", _KPA)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRecord(DrawnCurve):
    """A record with its stress [Pa] by the baseline, and by the extension (None if there is none)."""

    record: Record
    before: Array
    after: Array | None

    def branches(self) -> list[tuple[NDArray[np.bool_], Kind]]:
        """Mask of the points of each branch, and its type."""
        found: list[tuple[NDArray[np.bool_], Kind]] = []
        unloaded = self.record.remembers
        for b in np.unique(self.record.branch):
            mine = self.record.branch == b
            if np.isfinite(self.record.turn[mine]).mean() > 0.5:
                found.append((mine, "unloading"))
                unloaded = True
            else:
                found.append((mine, "loading again" if unloaded else "loading"))
        return found


def drawn(model: HomogeneousModel, diagnosis: Diagnosis) -> list[DrawnRecord]:
    """All records with the stresses of the baseline and of the extension."""
    stresses = before_and_after(diagnosis, model.stresses)
    return [
        DrawnRecord(
            name=r.name,
            record=r,
            before=b,
            after=a,
            left_before=r.stress - b,
            left_after=None if a is None else r.stress - a,
            sd=r.sd,
        )
        for r, (b, a) in zip(model.records, stresses, strict=True)
    ]


@figures_of.register(HomogeneousModel)
def homogeneous_figures(model: HomogeneousModel, diagnosis: Diagnosis) -> list[Figure]:
    """Figures of curves, residuals and rms. ValueError if the baseline's law has no stress."""
    records = drawn(model, diagnosis)
    if not all(np.isfinite(d.before).all() for d in records):
        raise ValueError("the law has no stress at the baseline")
    after = legend_of(diagnosis)
    curves = draw_curves(records, after)
    # curves that lie on each other show nothing: what is left of them comes first then
    if any(d.rms("before") > SEEN * np.abs(d.record.stress).max() for d in records):
        first = [curves, draw_residuals(records, after, section="residuals")]
    else:
        first = [draw_residuals(records, after, section="shapes"), curves]
    return [
        *first,
        draw_rms(
            records,
            diagnosis,
            after,
            quantity="stress",
            unit=UNIT,
            noise=rms_of(d.sd for d in records),
            dashed="the error of a single point, stated or assumed; a misfit below it still counts where"
            " neighbouring points, or several tests, have it in common",
        ),
    ]


def draw_curves(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel per trial: stress over stretch, measured and simulated."""

    def draw(axes: Any, d: DrawnRecord) -> None:
        measured_and_simulated(
            axes,
            _strain(d),
            _KPA * d.record.stress,
            _KPA * d.before,
            None if d.after is None else _KPA * d.after,
            [(mine, kind == "unloading") for mine, kind in d.branches()],
        )
        _titled(axes, d, "nominal stress / kPa")

    return per_trial(
        records,
        draw,
        name="curves",
        caption="Dots: measured (hollow: unloading). Lines: simulated.",
        handles=legend_handles(records, after),
    )


def draw_residuals(records: Sequence[DrawnRecord], after: str, *, section: Section) -> Figure:
    """One panel per trial: measured minus baseline (means of neighbours), and extension minus baseline.

    If the extension explains the misfit of the baseline, its lines pass through the dots.
    """

    def draw(axes: Any, d: DrawnRecord) -> None:
        x = _strain(d)
        axes.axhline(0.0, color=INK, lw=0.8, zorder=1)
        for mine, kind in d.branches():
            _means(axes, x[mine], _KPA * d.left("before")[mine], _KPA * d.sd[mine], kind)
            if d.after is not None:
                added = _KPA * (d.after - d.before)[mine]
                axes.plot(x[mine], added, color=LOOK[kind], lw=2.0, zorder=2)
        _titled(axes, d, "above the baseline / kPa")

    kinds = dict.fromkeys(kind for d in most_telling(records, PANELS[section])[0] for _, kind in d.branches())
    handles = [Line2D([], [], ls="", marker="o", ms=4, color=LOOK[k], label=f"measured, {k}") for k in kinds]
    if any(d.extended for d in records):
        handles.append(Line2D([], [], color=INK, lw=2, label=after))
    return per_trial(
        records,
        draw,
        name="residuals",
        caption="Dots: measured less baseline stress, means of neighbouring points with their standard"
        " deviation."
        + (" Lines: what is added to the baseline; right where they go through the dots." if after else ""),
        handles=handles,
        section=section,
    )


def _means(axes: Any, x: Array, y: Array, sd: Array, kind: Kind) -> None:
    """Draw weighted means of neighbouring points with error bars."""
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
    titled(axes, d, across, quantity, unit=UNIT, note=f" ({d.record.mode})")
