"""Figures of indentation for the page of a diagnosis: force over depth, residuals over time, their rms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.drawing._bars import AFTER, BEFORE
from calibration.diagnosis.drawing._curves import DrawnCurve, before_and_after, legend_of
from calibration.diagnosis.drawing._domain import Figure, figures_of
from calibration.diagnosis.drawing._panels import (
    dots,
    draw_rms,
    legend_handles,
    measured_and_simulated,
    per_trial,
    titled,
)
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements.indentation._record import Record
from calibration.measurements.indentation.model import IndentationModel
from calibration.pages import BAND, INK

Array = NDArray[np.float64]

MN = 1e3
UNIT = ("mN", MN)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRecord(DrawnCurve):
    """A record with its force [N] by the baseline, and by the extension (None if there is none).

    Residuals are without the most likely nuisances (mesh error, first touch ...).
    """

    record: Record
    before: Array
    after: Array | None

    def phases(self) -> list[tuple[NDArray[np.bool_], bool]]:
        """Mask of the points of each phase, and True if it is a loading."""
        found = []
        for p in np.unique(self.record.phase):
            mine = self.record.phase == p
            found.append((mine, bool((self.record.direction[mine] > 0).all())))
        return found


def drawn(model: IndentationModel, diagnosis: Diagnosis) -> list[DrawnRecord]:
    """All records with the forces of the baseline and of the extension."""
    forces = before_and_after(diagnosis, model.forces)
    left = before_and_after(diagnosis, lambda state: [-x for x in model.registered(state)])
    return [
        DrawnRecord(
            name=r.name,
            record=r,
            before=before,
            after=after,
            left_before=left_before,
            left_after=left_after,
            sd=sd,
        )
        for r, (before, after), (left_before, left_after), sd in zip(
            model.records, forces, left, model.point_sds(), strict=True
        )
    ]


@figures_of.register(IndentationModel)
def indentation_figures(model: IndentationModel, diagnosis: Diagnosis) -> list[Figure]:
    """Figures of force over depth, residuals over time with the band of the noise, and rms."""
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


def draw_forces(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel per trial: force over depth, measured and simulated."""

    def draw(axes: Any, d: DrawnRecord) -> None:
        measured_and_simulated(
            axes,
            1e3 * d.record.depth,
            MN * d.record.force,
            MN * d.before,
            None if d.after is None else MN * d.after,
            [(mine, not loading) for mine, loading in d.phases()],
        )
        titled(axes, d, "depth / mm", "force / mN", unit=UNIT)

    return per_trial(
        records,
        draw,
        name="forces",
        caption="Dots: measured (hollow: holds and unloading). Lines: simulated.",
        handles=legend_handles(records, after),
    )


def draw_residuals(records: Sequence[DrawnRecord], after: str) -> Figure:
    """One panel per trial: measured minus simulated force over time, with a band of two sd of the noise."""

    def draw(axes: Any, d: DrawnRecord) -> None:
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
        titled(axes, d, "time / s", "residual / mN", unit=UNIT)

    return per_trial(
        records,
        draw,
        name="residuals",
        caption="Measured less simulated force (hollow: holds and unloading), the most likely mesh error and"
        " first touch removed. Band: two standard deviations of the points' error; a model that lacks nothing"
        " stays within it almost everywhere.",
        handles=legend_handles(records, after, measured=False),
        section="residuals",
    )
