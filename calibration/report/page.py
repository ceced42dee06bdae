"""The page of a calibration: one section a material, and the commands that make it again."""

from __future__ import annotations

import csv
import io
import json
import shlex
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from calibration._files import write_whole
from calibration.experiment.model import CouponTrial, Experiment
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.measurements.objective import ModelObjective
from calibration.pages import NOTHING, Cell, Picture, significant, template, turned_parts
from calibration.parameters import part_kind
from calibration.report._compare import Comparison, Moved, compare, far_nuisances
from calibration.report._draw_outlines import contours, draw_residuals, draw_trial
from calibration.report._draw_parameters import draw_held_out, draw_parameters
from calibration.report._draw_records import Coupon, coupon_errors, draw_coupons, draw_indentations
from calibration.report._tables import HEADINGS, HELD_OUT_HEADINGS, held_out_rows, law_rows
from calibration.report._template import PAGE
from calibration.report._words import blind, headline, rule, troubles, unidentified
from calibration.study.calibration import Calibration, shared_notes
from calibration.study.measurements import Measurements, measurements
from tisim.view import View


def commands(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> list[str]:
    """Command lines that make these fits again, one for all with equal options; seed and limits from the fits
    in `folder`, where they are still."""
    used = {t.material for t in experiment.trials}
    found = []
    for options, alike in _by_options(folder, results).items():
        words = ["python", "-m", "calibration.fit", str(experiment.folder)]
        words += ["--model", ",".join(dict.fromkeys(r.law for r in alike))]
        materials = dict.fromkeys(r.material for r in alike)
        if set(materials) != used:
            words += ["--material", _listed([*materials])]
        found.append(shlex.join([*words, *options, "--out", str(folder)]))
    return found


def _by_options(folder: Path, results: Sequence[Calibration]) -> dict[tuple[str, ...], list[Calibration]]:
    """Fits by the options of their commands.

    A law that is no series takes no number of terms, and goes with the first fits of otherwise equal options.
    """
    series = {r.law for r in results if r.terms > 1}
    found: dict[tuple[str, ...], dict[int, list[Calibration]]] = {}
    for r in sorted(results, key=lambda r: r.law not in series):
        own = found.setdefault(_options(folder, r), {})
        own.setdefault(r.terms if r.law in series or not own else next(iter(own)), []).append(r)
    order = {id(r): k for k, r in enumerate(results)}
    groups = [
        ((*(("--terms", str(n)) if n > 1 else ()), *options), sorted(alike, key=lambda r: order[id(r)]))
        for options, by_terms in found.items()
        for n, alike in by_terms.items()
    ]
    return dict(sorted(groups, key=lambda pair: order[id(pair[1][0])]))


def _options(folder: Path, result: Calibration) -> tuple[str, ...]:
    """Options of a fit's command beside its law, terms and material."""
    words: list[str] = []
    for spec in result.asked or result.parts:
        asks = part_kind(spec).option
        words += [f"--{asks}"] if asks == spec else [f"--{asks}", spec]
    header = _header(folder, result)
    if header.get("objective", "likelihood") != "likelihood":
        words += ["--objective", str(header["objective"])]
    if header.get("free_bulk_ratio"):
        words.append("--free-bulk-ratio")
    if header.get("rig_file"):
        words += ["--rig", str(header["rig_file"])]
    for option in ("start", "seed", "population", "generations", "restarts"):
        if header.get(option) is not None:
            words += [f"--{option}", str(header[option])]
    if header.get("polish") is False and header.get("objective", "likelihood") == "likelihood":
        words.append("--no-polish")
    polished_beams = bool(result.estimates) and result.rms is not None
    if header.get("held_out") is False or (
        not header and polished_beams and not (result.held_out or result.held_out_note)
    ):
        words.append("--no-held-out")
    return tuple(words)


def _listed(names: Sequence[str]) -> str:
    """Names as an option takes them (`calibration.cli.names_in`)."""
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(names)
    return line.getvalue()


def _header(folder: Path, result: Calibration) -> dict[str, Any]:
    """Header of a fit on disk (`calibration.study._store`), {} where there is none."""
    whole = folder / "fits" / f"{result.material}-{result.label}.json"
    if whole.is_file():
        return dict(json.loads(whole.read_text(encoding="utf-8"))["header"])
    lines = whole.with_suffix(".jsonl")
    if lines.is_file():
        with lines.open(encoding="utf-8") as file:
            return dict(json.loads(file.readline()))
    return {}


Rows = list[list[Cell]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Section:
    """Contents of the template for one material; pictures by their subject, in the page's order."""

    material: str
    verdict: str
    lacking: bool
    chosen: Calibration | None
    laws: Rows
    held_out: Rows
    held_out_notes: list[str]
    coupons: Rows
    coupon_headings: list[str]
    beams: list[Picture]
    view: View | None
    residuals: Picture | None
    held_out_picture: Picture | None
    coupon_picture: Picture | None
    indentation_picture: Picture | None
    parameters: Picture | None
    drawing_note: str
    blind: list[str]
    unidentified: list[str]
    troubles: list[str]
    notes: list[str]
    moved: list[Moved]
    nuisances: int
    ignored: tuple[str, ...]

    @property
    def pictures(self) -> list[Picture]:
        single = (self.residuals, self.held_out_picture, self.coupon_picture, self.indentation_picture)
        return [*self.beams, *(p for p in (*single, self.parameters) if p is not None)]


def section(results: Sequence[Calibration], experiment: Experiment) -> Section:
    """results: of one material, all of its laws."""
    material = results[0].material
    found = compare(results)
    chosen = found.chosen if found else None
    data = measurements(experiment, material, (chosen or results[0]).parametrisation)
    beams, view, residuals, note = _beams(data, chosen)
    coupons = _coupons(data)
    fitted = [r for r in results if r.parameters]
    return Section(
        material=material,
        verdict=headline(results, experiment),
        lacking=chosen is not None and bool(chosen.lacking),
        chosen=chosen,
        laws=law_rows(results, found, experiment),
        held_out=held_out_rows(results, experiment),
        held_out_notes=[f"{r.label}: {r.held_out_note}" for r in results if r.held_out_note],
        coupons=_coupon_rows(coupons, fitted),
        coupon_headings=["test", "mode", "points", *(r.label for r in fitted)],
        beams=beams,
        view=view,
        residuals=residuals,
        held_out_picture=draw_held_out(results, experiment, material),
        coupon_picture=draw_coupons(coupons, results, _label(found), material) if coupons else None,
        indentation_picture=_indentations(data, chosen),
        parameters=draw_parameters(results, material),
        drawing_note=note,
        blind=[sentence for r in results for sentence in blind(r)],
        unidentified=[sentence for r in results for sentence in unidentified(r)],
        troubles=troubles(results),
        notes=[f"{', '.join(r.label for r in fits)}: {n}" for n, fits in shared_notes(results).items()],
        moved=far_nuisances(chosen, experiment) if chosen else [],
        nuisances=len(chosen.nuisances) if chosen else 0,
        ignored=(*data.ignored, *_averaged(experiment, material)),
    )


def _beams(
    data: Measurements, chosen: Calibration | None
) -> tuple[list[Picture], View | None, Picture | None, str]:
    """Pictures of each beam, all to turn around, and all residuals; a sentence where there are none."""
    if data.outlines is None:
        return [], None, None, ""
    if chosen is None:
        return [], None, None, "No law has parameters, so that no beam could be simulated."
    drawn = contours(data.outlines, chosen)
    if drawn is None:
        return [], None, None, f"{chosen.label} has no equilibrium at these parameters: nothing to draw."
    trials = [draw_trial(drawn, t, chosen.label) for t in data.outlines.model.trials]
    return trials, drawn.view, draw_residuals(drawn, data.material, chosen.label), ""


def _averaged(experiment: Experiment, material: str) -> list[str]:
    return [
        f"{t.id}: a record of more than {len(t.stress):,} points: each point is the mean of"
        f" neighbours, {t.samples.mean():,.3g} on average"
        for t in experiment.trials
        if isinstance(t, CouponTrial) and t.material == material and t.samples is not None
    ]


def _indentations(data: Measurements, chosen: Calibration | None) -> Picture | None:
    if data.pokes is None or chosen is None:
        return None
    return draw_indentations(data.pokes, chosen, data.material)


def _coupons(data: Measurements) -> list[Coupon]:
    """Homogeneous tests with their records as they are compared."""
    found: list[Coupon] = []
    for o in data.objectives:
        if isinstance(o, ModelObjective) and isinstance(o.model, HomogeneousModel):
            found += zip(o.model.trials, o.model.records, strict=True)
    return found


def _coupon_rows(coupons: Sequence[Coupon], fitted: Sequence[Calibration]) -> Rows:
    """rms error of each law on each coupon [% of its largest stress]."""
    rows = []
    for trial, record in coupons:
        errors = coupon_errors((trial, record), fitted)
        cells = [
            Cell(text=NOTHING) if e != e else Cell(text=f"{significant(e)} %", value=e / 100.0)
            for e in (errors[r.label] for r in fitted)
        ]
        rows.append([Cell(text=trial.id), Cell(text=trial.mode), Cell(text=str(record.points)), *cells])
    return rows


def _label(found: Comparison | None) -> str | None:
    return found.chosen.label if found else None


def write_page(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> Path:
    """Write `folder/report.html` and its pictures (`folder/pictures/*.png`); the path of the page.

    results: fits of any status, any materials of the experiment. Each material's leading law is simulated
    once, for the pictures of beams. ValueError without results.
    """
    if not results:
        raise ValueError("expected at least one calibration to report")
    materials = dict.fromkeys(r.material for r in results)
    sections = [section([r for r in results if r.material == m], experiment) for m in materials]
    text = render(sections, results, experiment, "\n".join(commands(folder, results, experiment)))
    _pictures(folder / "pictures", sections)
    return write_whole(folder / "report.html", text)


def render(
    sections: Sequence[Section], results: Sequence[Calibration], experiment: Experiment, repeat: str
) -> str:
    """The page as HTML; repeat: the commands that make it again."""
    return template(PAGE).render(
        experiment=experiment,
        sections=sections,
        diagnose=f"python -m calibration.diagnose {shlex.quote(str(experiment.folder))}",
        headings=HEADINGS,
        held_out_headings=HELD_OUT_HEADINGS,
        rule=rule(),
        repeat=repeat,
        turned=turned_parts([s.view for s in sections if s.view is not None]),
        counts=", ".join(f"{n} {s}" for s, n in Counter(r.status for r in results).items()),
        total=len(results),
        kinds=experiment.counts,
    )


def _pictures(folder: Path, sections: Sequence[Section]) -> None:
    written: set[str] = set()
    for nth, shown in enumerate(sections, 1):
        for picture in shown.pictures:
            # names of two materials may become one file's ("a/b" and "a b")
            name = f"{nth}-{picture.name}" if picture.name in written else picture.name
            written.add(name)
            write_whole(folder / name, picture.png)
