"""report.html, a self-contained page, and its figures as separate files."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from pathlib import Path

from calibration._files import write_whole
from calibration.diagnosis.drawing import Figure, figures_of
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.diagnosis.report import _tables as tables
from calibration.diagnosis.report._evidence import draw_evidence
from calibration.diagnosis.report._method import false_alarms, lack_of_fit, method, troubles
from calibration.diagnosis.report._template import PAGE
from calibration.diagnosis.report._words import headline
from calibration.measurements._model import MeasurementModel
from calibration.pages import Picture, file_name, picture, template, turned_parts

LONGEST = 60  # letters of a picture's file name


def write_report(diagnosis: Diagnosis, model: MeasurementModel, folder: Path, *, title: str) -> list[Path]:
    """Write `folder/report.html` and its figures (`folder/*.png`); returns the paths, the page first.

    Parameters
    ----------
    model : the model that was diagnosed, which draws the figures (`MeasurementModel.pictures`).
    title : title of the page, any text.
    """
    evidence = draw_evidence(diagnosis.finding)
    extra: list[str] = []
    try:
        figures = figures_of(model, diagnosis)
    except ValueError as problem:  # a simulation that has no answer: the rest of the page still stands
        figures, extra = [], [f"The pictures of shapes and residuals are missing: {problem}."]
    pictures = _pictures(figures, taken={evidence.name})
    text = render(diagnosis, model, evidence, pictures, title=title, extra=extra)
    folder.mkdir(parents=True, exist_ok=True)
    written = [write_whole(folder / "report.html", text)]
    for p in (evidence, *(p for _, p in pictures)):
        written.append(write_whole(folder / p.name, p.png))
    return written


def render(
    diagnosis: Diagnosis,
    model: MeasurementModel,
    evidence: Picture,
    pictures: list[tuple[Figure, Picture]],
    *,
    title: str,
    extra: list[str],
) -> str:
    """The page as HTML. extra : sentences on figures that are missing."""
    data = diagnosis.to_json()
    finding = diagnosis.finding
    return template(PAGE).render(
        title=title,
        verdict=finding.verdict,
        headline=headline(finding),
        sentence=diagnosis.sentence(),
        budget_headings=tables.BUDGET,
        budget=tables.budget_rows(diagnosis, data),
        fold_headings=tables.FOLDS,
        folds=tables.fold_rows(data, diagnosis.unit[0]),
        alternative_headings=tables.ALTERNATIVES,
        alternatives=tables.alternative_rows(diagnosis),
        next_experiment=diagnosis.next_experiment,
        troubles=[*troubles(diagnosis), *extra],
        shapes=[p for f, p in pictures if f.section == "shapes"],
        residuals=[p for f, p in pictures if f.section == "residuals"],
        turned=turned_parts([f.view for f, _ in pictures if f.view is not None]),
        lack_of_fit=lack_of_fit(diagnosis),
        test_headings=tables.TESTS,
        tests=tables.test_rows(diagnosis),
        evidence=evidence,
        false_alarms=false_alarms(diagnosis),
        extended=diagnosis.extended is not None,
        fit_headings=tables.FITS if diagnosis.extended else tables.FITS[:2],
        fits=[
            row[: 4 if diagnosis.extended else 2] for row in tables.fit_rows(data, len(finding.null.noise))
        ],
        gain=tables.gain_sentence(data),
        invisible_headings=tables.INVISIBLE,
        invisible=tables.invisible_rows(diagnosis),
        notes=(*diagnosis.implausible, *diagnosis.notes),
        method=method(diagnosis, model, model.noise_sentence()),
    )


def _pictures(figures: list[Figure], taken: set[str]) -> list[tuple[Figure, Picture]]:
    """Figures as PNG under unique file names; `taken` are names in lower case that are used already."""
    found = []
    for f in figures:
        name = f.name[:LONGEST]
        made = picture(f.figure, name, f.caption)
        for nth in count(2):
            if made.name.lower() not in taken:
                break
            made = replace(made, name=f"{file_name(name)}-{nth}.png")
        taken.add(made.name.lower())
        found.append((f, made))
    return found
