"""The report: tables and pictures in one HTML file, and the same numbers as JSON."""

from __future__ import annotations

import base64
import json
from itertools import pairwise
from math import inf, isfinite
from pathlib import Path
from statistics import fmean
from typing import Any

import jinja2

from learn.evaluation.evaluation import Covered, Evaluation
from learn.evaluation.paper import PAPER
from learn.evaluation.parts import parts_of
from learn.evaluation.pictures import draw_forces, draw_poke, encoded, ranked_pokes
from learn.evaluation.summary import Value
from learn.metrics import METRICS
from learn.metrics.rings import EDGES_MM

PAPER_METRICS = ("force", "mean", "max", "tip")
Table = tuple[list[str], list[list[str]]]  # heads, rows

_TEMPLATE = jinja2.Environment(autoescape=True).from_string("""<!doctype html>
<html lang="en"><meta charset="utf-8"><title>{{ title }}</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 1200px; padding: 0 1em; }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums; }
th, td { padding: .25em .7em; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; }
img { max-width: 100%; } .note { color: #555; }
</style>
<h1>{{ title }}</h1>
<table>{% for key, value in about %}<tr><td>{{ key }}</td><td>{{ value }}</td></tr>{% endfor %}</table>
{% for section in sections %}
<h2>{{ section.title }}</h2><p class="note">{{ section.note }}</p>
<table><tr>{% for head in section.table[0] %}<th>{{ head }}</th>{% endfor %}</tr>
{% for row in section.table[1] %}<tr>{% for cell in row %}<td>{{ cell }}</td>{% endfor %}</tr>{% endfor %}
</table>{% endfor %}
<h2>What is measured</h2>
<ul>{% for m in metrics %}<li><b>{{ m.name }}</b>
{% if m.units %} [{{ m.units }}]{% endif %}: {{ m.text }}</li>{% endfor %}</ul>
<h2>Pictures</h2>
{% for picture in pictures %}<p><img alt="{{ picture[0] }}" src="data:image/png;base64,{{ picture[1] }}"></p>
{% endfor %}
</html>
""")


def paper_table(found: Evaluation) -> Table:
    """The paper's columns, by softness, its own rows beside."""
    heads = ["", "softness", *(f"{name} [{METRICS[name].units}]" for name in PAPER_METRICS)]
    rows = []
    for name in found.models:
        for level, values in found.tables[name].items():
            rows.append([name, level, *(values[m].text(METRICS[m]) for m in PAPER_METRICS)])
            paper = PAPER.get((found.store.law, level))
            if paper:
                rows.append(["the paper", level, *(paper[m].text(METRICS[m]) for m in PAPER_METRICS)])
    return heads, rows


def full_table(tables: dict[str, dict[str, Value]], first: str) -> Table:
    """Every metric's mean, a row each."""
    heads = [first, *(f"{m.name}{f' [{m.units}]' if m.units else ''}" for m in METRICS.values())]
    rows = [
        [name, *(values[m.name].text(m, sd=False) for m in METRICS.values())]
        for name, values in tables.items()
    ]
    return heads, rows


def symmetry_table(found: Evaluation) -> Table:
    heads = ["", "any rotation and shift [mm]", "force", "quarter turns about the vertical [mm]", "force"]
    rows = []
    for name, turned in found.turned.items():
        flat = found.turned_flat[name]
        rows.append(
            [
                name,
                f"{turned.displacement_mm:.1e}",
                f"{turned.force:.1e}",
                f"{flat.displacement_mm:.1e}",
                f"{flat.force:.1e}",
            ]
        )
    return heads, rows


def _interval_row(name: str, of: list[Covered]) -> list[str]:
    """Means over what is given, but for the fewest pokes and the least promise."""
    rings = [[r for r in ring if isfinite(r)] for ring in zip(*(c.found.rings for c in of), strict=True)]
    return [
        name,
        f"{of[0].intervals.level:.0%}",
        str(min(c.intervals.pokes for c in of)),
        f"{min(c.intervals.promised for c in of):.0%}",
        f"{fmean(c.found.points for c in of):.1%}",
        *(f"{fmean(ring):.1%}" if ring else "-" for ring in rings),
        f"{fmean(c.found.force for c in of):.1%}",
        f"{fmean(c.found.pokes for c in of):.0%}",
        f"{fmean(c.radius_mm for c in of):.4f}",
        f"{fmean(c.rank for c in of):.2f}",
    ]


def interval_table(found: Evaluation) -> Table:
    rings = [f"{low:g}+" if high == inf else f"{low:g}-{high:g}" for low, high in pairwise(EDGES_MM)]
    heads = [
        "",
        "asked",
        "calibrated on pokes",
        "promised at most",
        "points covered",
        *(f"{ring} mm" for ring in rings),
        "forces covered",
        "pokes covered so",
        "mean radius [mm]",
        "rank correlation with the error",
    ]
    rows = [_interval_row(name, [c]) for name, c in found.covered.items()]
    rows += [_interval_row(f"{name}, by the other folds", [c]) for name, c in found.across.items()]
    if found.across:
        rows.append(_interval_row("mean of those by the other folds", list(found.across.values())))
    return heads, rows


def write_report(found: Evaluation, folder: Path) -> None:
    """FOLDER/report.html, tables.json and the pictures: best.png, median.png, worst.png, force.png."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "tables.json").write_text(json.dumps(as_json(found), indent=1) + "\n", encoding="utf-8")
    store, first = found.store, found.runs[0]
    assert found.cases is not None
    pictures = [
        (name, encoded(draw_poke(store, found.cases, poke, name)))
        for name, poke in ranked_pokes(found.cases).items()
    ]
    pictures.append(("force against depth", encoded(draw_forces(found.cases))))
    for (_, picture), name in zip(pictures, ("best", "median", "worst", "force"), strict=True):
        (folder / f"{name}.png").write_bytes(base64.b64decode(picture))
    many = len(found.runs) > 1
    spread = (
        "± is the standard deviation over runs"
        if many
        else "± is the standard deviation over frames, as in the paper"
    )
    everything = {name: levels["all"] for name, levels in found.tables.items()}
    sections: list[dict[str, Any]] = [
        {
            "title": "The paper's table",
            "table": paper_table(found),
            "note": f"{spread}. The paper's data are others (1,320 pokes, about 14 to 16 mm deep): its rows "
            "are for orientation. Doing nothing is below.",
        },
        {
            "title": "Models and baselines",
            "table": full_table(everything, "model"),
            "note": "Test part, all softness.",
        },
        {
            "title": "Symmetry",
            "table": symmetry_table(found),
            "note": "Largest disagreement between turning the scene before and after the prediction.",
        },
    ]
    if found.covered:
        note = (
            "Conformal, calibrated on half the validation pokes, each poke one draw, in rings of distance "
            "from first touch; counted on test pokes. Few pokes cannot promise 90 %. By the other folds: "
            "calibrated on what the runs of other folds answered to shapes unseen by them; kept with the run."
        )
        sections.append({"title": "Intervals", "table": interval_table(found), "note": note})
    if found.clouds:
        note = (
            "Same weights on other point clouds, against linear interpolation of the surface meshes; that "
            f"interpolation alone is {found.floor_mm:.4f} mm off the grid's stored values."
        )
        sections.append({"title": "Other clouds", "table": full_table(found.clouds, "points"), "note": note})
    if found.deeper:
        note = "Test frames up to and beyond the depth that was trained on."
        sections.append(
            {"title": "Deeper than trained", "table": full_table(found.deeper, "frames"), "note": note}
        )
    about = [
        ("runs", ", ".join(str(run.folder.name) for run in found.runs)),
        ("dataset", f"{store.location}, {store.law}, {store.pokes} pokes, uuid {store.uuid}"),
        (
            "tested on",
            "; ".join(
                f"fold {r.recipe.fold}: {', '.join(parts_of(store, r).groups['test'])}" for r in found.runs
            ),
        ),
        (
            "trained on",
            f"{first.statistics.frames} frames, epoch {first.epoch} of {first.recipe.epochs} kept",
        ),
    ]
    html = _TEMPLATE.render(
        title="Surrogate of pokes: evaluation",
        about=about,
        sections=sections,
        metrics=METRICS.values(),
        pictures=pictures,
    )
    (folder / "report.html").write_text(html, encoding="utf-8")


def as_json(found: Evaluation) -> dict[str, Any]:
    """All numbers; shares as shares, lengths in mm, forces in N."""

    def plain(values: dict[str, Value]) -> dict[str, Any]:
        return {name: {"mean": v.mean, "sd": v.sd} for name, v in values.items()}

    return {
        "dataset": found.store.uuid,
        "law": found.store.law,
        "runs": [str(run.folder.name) for run in found.runs],
        "tables": {m: {s: plain(v) for s, v in levels.items()} for m, levels in found.tables.items()},
        "turned": {n: vars(t) for n, t in found.turned.items()},
        "turned_about_vertical": {n: vars(t) for n, t in found.turned_flat.items()},
        "intervals": {
            n: {**vars(c.found), "promised": c.intervals.promised, "rank": c.rank, "radius_mm": c.radius_mm}
            for n, c in [
                *found.covered.items(),
                *((f"{name}, by the other folds", c) for name, c in found.across.items()),
            ]
        },
        "clouds": {n: plain(v) for n, v in found.clouds.items()},
        "deeper": {n: plain(v) for n, v in found.deeper.items()},
        "cloud_floor_mm": found.floor_mm,
    }
