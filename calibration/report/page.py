"""report.html: one page that needs nothing beside it, and its pictures once more as files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from calibration.experiment.model import Experiment
from calibration.report._base import template
from calibration.report._material import Section, section
from calibration.report._origin import command
from calibration.report._tables import HEADINGS, HELD_OUT_HEADINGS
from calibration.report._template import PAGE
from calibration.report._words import rule
from calibration.study.calibration import Calibration


def write_page(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> Path:
    """Write `folder/report.html` and its pictures (`folder/pictures/*.png`); the path of the page.

    results: fits of any status, any materials of the experiment. Each material's leading law is simulated
    once, for the pictures of beams. ValueError without results.
    """
    if not results:
        raise ValueError("expected at least one calibration to report")
    materials = dict.fromkeys(r.material for r in results)
    sections = [section([r for r in results if r.material == m], experiment) for m in materials]
    text = render(sections, results, experiment, command(folder, results, experiment))
    _pictures(folder / "pictures", sections)
    path = folder / "report.html"
    part = path.with_suffix(".html.part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
    return path


def render(
    sections: Sequence[Section], results: Sequence[Calibration], experiment: Experiment, repeat: str
) -> str:
    """The page as HTML; repeat: the command that makes it again."""
    return template(PAGE).render(
        experiment=experiment,
        sections=sections,
        headings=HEADINGS,
        held_out_headings=HELD_OUT_HEADINGS,
        rule=rule(),
        repeat=repeat,
        counts=", ".join(f"{n} {s}" for s, n in Counter(r.status for r in results).items()),
        total=len(results),
        kinds=Counter(type(t).__name__.removesuffix("Trial").lower() for t in experiment.trials),
    )


def _pictures(folder: Path, sections: Sequence[Section]) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for shown in sections:
        for picture in shown.pictures:
            part = folder / f"{picture.name}.part"
            part.write_bytes(picture.png)
            part.replace(folder / picture.name)
