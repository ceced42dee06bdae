"""One material's part of the page: tables, pictures and sentences, gathered from its fits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from calibration.coupons import CouponObjective
from calibration.experiment.model import Experiment
from calibration.report._compare import Comparison, compare
from calibration.report._contours import contours
from calibration.report._draw_coupons import coupon_errors, draw_coupons
from calibration.report._draw_outlines import draw_residuals, draw_trial
from calibration.report._draw_parameters import draw_held_out, draw_parameters
from calibration.report._figure import Picture
from calibration.report._nuisances import Moved, far_nuisances
from calibration.report._numbers import NOTHING, significant
from calibration.report._tables import Cell, held_out_rows, law_rows
from calibration.report._words import blind, troubles, verdict
from calibration.study.calibration import Calibration
from calibration.study.measurements import Measurements, measurements

Rows = list[list[Cell]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Section:
    """What the template shows of one material; pictures by what they are of, in the page's order."""

    material: str
    verdict: str
    chosen: Calibration | None
    laws: Rows
    held_out: Rows
    held_out_notes: list[str]
    coupons: Rows
    coupon_headings: list[str]
    beams: list[Picture]
    residuals: Picture | None
    held_out_picture: Picture | None
    coupon_picture: Picture | None
    parameters: Picture | None
    drawing_note: str
    blind: list[str]
    troubles: list[str]
    notes: list[str]
    moved: list[Moved]
    nuisances: int
    ignored: tuple[str, ...]

    @property
    def pictures(self) -> list[Picture]:
        single = (self.residuals, self.held_out_picture, self.coupon_picture, self.parameters)
        return [*self.beams, *(p for p in single if p is not None)]


def section(results: Sequence[Calibration], experiment: Experiment) -> Section:
    """results: of one material, all of its laws."""
    material = results[0].material
    data = measurements(experiment, material)
    found = compare(results)
    chosen = found.chosen if found else None
    beams, residuals, note = _beams(data, chosen)
    coupons = [o for o in data.objectives if isinstance(o, CouponObjective)]
    fitted = [r for r in results if r.parameters]
    return Section(
        material=material,
        verdict=verdict(results),
        chosen=chosen,
        laws=law_rows(results, found, experiment),
        held_out=held_out_rows(results, experiment),
        held_out_notes=[f"{r.label}: {r.held_out_note}" for r in results if r.held_out_note],
        coupons=_coupon_rows(coupons, fitted),
        coupon_headings=["coupon", "mode", "points", *(r.label for r in fitted)],
        beams=beams,
        residuals=residuals,
        held_out_picture=draw_held_out(results, experiment, material),
        coupon_picture=draw_coupons(coupons, results, _label(found), material) if coupons else None,
        parameters=draw_parameters(results, material),
        drawing_note=note,
        blind=[sentence for r in results for sentence in blind(r)],
        troubles=troubles(results),
        notes=[f"{r.label}: {r.note}" for r in results if r.note],
        moved=far_nuisances(chosen, experiment) if chosen else [],
        nuisances=len(chosen.nuisances) if chosen else 0,
        ignored=data.ignored,
    )


def _beams(data: Measurements, chosen: Calibration | None) -> tuple[list[Picture], Picture | None, str]:
    """Pictures of each beam and of all residuals; a sentence where there are none."""
    if data.outlines is None:
        return [], None, ""
    if chosen is None:
        return [], None, "No law has parameters, so that no beam could be simulated."
    drawn = contours(data.outlines, chosen)
    if drawn is None:
        return [], None, f"{chosen.label} has no equilibrium at these parameters: nothing to draw."
    trials = [draw_trial(drawn, t, chosen.label) for t in data.outlines.trials]
    return trials, draw_residuals(drawn, data.material, chosen.label), ""


def _coupon_rows(coupons: Sequence[CouponObjective], fitted: Sequence[Calibration]) -> Rows:
    """rms error of each law on each coupon [% of its largest stress]."""
    rows = []
    for coupon in coupons:
        errors = coupon_errors(coupon, fitted)
        cells = [
            Cell(text=NOTHING) if e != e else Cell(text=f"{significant(e)} %", value=e / 100.0)
            for e in (errors[r.label] for r in fitted)
        ]
        trial = coupon.trial
        rows.append([Cell(text=trial.id), Cell(text=trial.mode), Cell(text=str(coupon.points)), *cells])
    return rows


def _label(found: Comparison | None) -> str | None:
    return found.chosen.label if found else None
