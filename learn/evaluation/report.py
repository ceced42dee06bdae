"""The report: tables and pictures in one HTML file, and the same numbers as JSON."""

from __future__ import annotations

import base64
import json
from dataclasses import asdict
from itertools import pairwise
from math import hypot, inf, isfinite
from pathlib import Path
from statistics import fmean
from typing import Any

import jinja2

from learn.evaluation.evaluation import Covered, Evaluation
from learn.evaluation.new_to_run import parts_of
from learn.evaluation.pictures import draw_forces, draw_learning, draw_poke, encoded, ranked_pokes
from learn.evaluation.summary import Row, Value, over_folds
from learn.metrics import METRICS, RING_EDGES_MM
from learn.training import read_log
from learn.training.run_folder import write_whole

PAPER_METRICS = ("force", "mean", "max", "tip")
_FEW_POKES = 10
_PICTURES = {f"{name}.png" for name in ("learning", "only", "best", "median", "worst", "force")}
Table = tuple[list[str], list[list[str]]]  # headings, rows

# The paper's results table (arXiv 2509.10125's successor, "GNN prediction results"). Its data reach about 14
# to 16 mm of depth on 1,320 pokes; its tip error is not defined there. Law, softness: force [N], mean [mm],
# max [mm], tip [fraction]; mean and standard deviation.
_PAPER_ROWS = {
    ("mooney-rivlin", "S0"): ((0.537, 1.001), (0.097, 0.152), (1.205, 0.854), (0.023, 0.025)),
    ("mooney-rivlin", "S0.5"): ((0.310, 0.540), (0.097, 0.155), (1.228, 0.924), (0.021, 0.023)),
    ("mooney-rivlin", "S1"): ((0.258, 0.650), (0.092, 0.157), (1.268, 0.944), (0.022, 0.026)),
    ("mooney-rivlin", "all"): ((0.337, 0.708), (0.095, 0.155), (1.239, 0.918), (0.022, 0.024)),
    ("ogden", "S0"): ((2.269, 6.358), (0.127, 0.209), (1.496, 1.084), (0.025, 0.026)),
    ("ogden", "S0.5"): ((1.407, 5.155), (0.132, 0.219), (1.517, 1.104), (0.024, 0.025)),
    ("ogden", "S1"): ((0.222, 0.776), (0.079, 0.145), (1.237, 1.013), (0.021, 0.027)),
    ("ogden", "all"): ((1.253, 4.751), (0.114, 0.198), (1.427, 1.080), (0.023, 0.026)),
}
PAPER = {
    key: dict(zip(PAPER_METRICS, (Value(*pair) for pair in row), strict=True))
    for key, row in _PAPER_ROWS.items()
}

_TEMPLATE = jinja2.Environment(autoescape=True).from_string("""<!doctype html>
<html lang="en"><meta charset="utf-8"><title>{{ title }}</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 1200px; padding: 0 1em;
  color: #222; }
table { border-collapse: collapse; margin: 1em 0; font-variant-numeric: tabular-nums; }
th, td { padding: .25em .7em; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child, table.about td { text-align: left; }
.wide { overflow-x: auto; }
.verdict { font-size: 1.2em; border-left: 5px solid #35608f; padding: .5em 1em; background: #f2f6fa; }
img { max-width: 100%; } .note { color: #555; }
</style>
<h1>{{ title }}</h1>
<p class="verdict">{{ verdict }}</p>
{% for caution in cautions %}<p class="note">{{ caution }}</p>{% endfor %}
<table class="about">{% for key, value in about %}<tr><td>{{ key }}</td><td>{{ value }}</td></tr>{% endfor %}
</table>
{% if learning %}<h2>Learning curve</h2>
<p><img alt="learning curve" src="data:image/png;base64,{{ learning }}"></p>{% endif %}
{% for section in sections %}
<h2>{{ section.title }}</h2>
{% for note in section.notes %}<p class="note">{{ note }}</p>{% endfor %}
{% if section.table[1] %}<div class="wide"><table>
<tr>{% for head in section.table[0] %}<th>{{ head }}</th>{% endfor %}</tr>
{% for row in section.table[1] %}<tr>{% for cell in row %}<td>{{ cell }}</td>{% endfor %}</tr>{% endfor %}
</table></div>{% endif %}{% endfor %}
<h2>Pictures</h2>
{% for picture in pictures %}<p><img alt="{{ picture[0] }}" src="data:image/png;base64,{{ picture[1] }}"></p>
{% endfor %}
<h2>Definitions</h2>
<ul>{% for m in metrics %}<li><b>{{ m.name }}</b>
{% if m.units %} [{{ m.units }}]{% endif %}: {{ m.text }}</li>{% endfor %}</ul>
</html>
""")


def counted(number: int, noun: str) -> str:
    """Number with its noun: "1 poke", "12 pokes"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def verdict(found: Evaluation) -> str:
    """One-sentence result: errors of the first model on its test part, and of the best baseline."""
    name = found.models[0]
    row = found.tables[name]["all"]
    others = {n: levels["all"]["mean"].mean for n, levels in found.tables.items() if n not in found.models}
    best = min(others, key=lambda n: others[n]) if others else None
    beside = f" ({best}: {others[best]:.3f} mm)" if best else ""
    size = f"{counted(found.pokes, 'test poke')} ({counted(found.frames, 'frame')})"
    mean, tip, force = row["mean"].mean, row["tip"].mean * 100, row["rel force"].mean * 100
    return (
        f"On {size} that it was not trained on, {name} is off by {mean:.3f} mm on average{beside}, "
        f"by {tip:.1f} % of the depth at the tip and by {force:.1f} % of the force."
    )


def cautions(found: Evaluation) -> list[str]:
    """Sentences that limit the verdict."""
    lines = []
    if found.pokes < _FEW_POKES:
        lines.append(
            f"{counted(found.pokes, 'test poke').capitalize()} cannot show how the model performs on others: "
            f"expect {_FEW_POKES} or more for figures to compare."
        )
    if found.by_name:
        lines.append(
            f"Shapes were identified by their names for {', '.join(found.by_name)}, whose own dataset is not "
            "where it was: one of another name may be one that was trained on, and one of a known name may "
            "be new."
        )
    timeless = [str(run.folder) for run in found.runs if not run.model.takes_clock]
    if timeless and found.store.clock is not None:
        lines.append(
            f"Trained without time: {', '.join(timeless)}. The answer is the same at any time and speed, but "
            "frames of this dataset differ in both."
        )
    return lines


def paper_table(found: Evaluation) -> Table:
    """The paper's metrics by softness level, with the paper's own rows."""
    heads = ["", "softness", *(METRICS[name].heading for name in PAPER_METRICS)]
    rows = []
    for name in found.models:
        for level, values in found.tables[name].items():
            rows.append([name, level, *(values[m].text(METRICS[m]) for m in PAPER_METRICS)])
            paper = PAPER.get((found.store.law, level))
            if paper:
                rows.append(["the paper", level, *(paper[m].text(METRICS[m]) for m in PAPER_METRICS)])
    return heads, rows


def full_table(tables: dict[str, Row], first: str) -> Table:
    """Mean of every metric, one row per entry."""
    heads = [first, *(m.heading for m in METRICS.values())]
    rows = [
        [name, *(values[m.name].text(m, sd=False) for m in METRICS.values())]
        for name, values in tables.items()
    ]
    return heads, rows


def symmetry_table(found: Evaluation) -> Table:
    """Symmetry errors by run."""
    heads = ["", "any rotation and shift [mm]", "force", "quarter turns about the vertical [mm]", "force"]
    rows = []
    for name, any_motion in found.symmetry.items():
        turns = found.symmetry_vertical[name]
        numbers = (any_motion.displacement_mm, any_motion.force, turns.displacement_mm, turns.force)
        rows.append([name, *(f"{number:.1e}" for number in numbers)])
    return heads, rows


def _interval_row(name: str, entries: list[Covered]) -> list[str]:
    """Row of means over the entries; number of pokes and promised coverage are the smallest."""
    rings = [[r for r in ring if isfinite(r)] for ring in zip(*(c.found.rings for c in entries), strict=True)]
    return [
        name,
        f"{entries[0].intervals.level:.0%}",
        str(min(c.intervals.pokes for c in entries)),
        f"{min(c.intervals.promised for c in entries):.0%}",
        _with_error([(c.found.points, c.found.points_error) for c in entries]),
        *(f"{fmean(ring):.1%}" if ring else "-" for ring in rings),
        _with_error([(c.found.force, c.found.force_error) for c in entries]),
        f"{fmean(c.found.pokes for c in entries):.0%}",
        f"{fmean(c.radius_mm for c in entries):.4f}",
        f"{fmean(c.rank for c in entries):.2f}",
    ]


def _with_error(shares: list[tuple[float, float]]) -> str:
    """Mean of shares with its standard error: "91.2% ± 1.4"; without one, if it is not known of each."""
    error = hypot(*(error for _, error in shares)) / len(shares)
    return f"{fmean(share for share, _ in shares):.1%}" + (f" ± {100 * error:.1f}" if isfinite(error) else "")


def interval_table(found: Evaluation) -> Table:
    """Coverage of the intervals; no rows if there are none (see `no_intervals`)."""
    rings = [f"{low:g}+" if high == inf else f"{low:g}-{high:g}" for low, high in pairwise(RING_EDGES_MM)]
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


def outside_table(found: Evaluation) -> Table:
    """Errors and coverage by distance from the trained ranges."""
    heads = ["", "frames", "pokes", "mean distance", "mean [mm]", "force [%]"]
    heads += [f"{what} covered{how}" for how in (", as inside", ", widened") for what in ("points", "forces")]
    rows = []
    for name, one in found.outside.items():
        row = [name, str(one.frames), str(one.pokes), f"{one.distance:.2f}", f"{one.mean_mm:.3f}"]
        row.append(f"{100 * one.force:.1f}")
        for covered in (one.calibrated, one.widened):
            row += ["-", "-"] if covered is None else [f"{covered.points:.1%}", f"{covered.force:.1%}"]
        rows.append(row)
    return heads, rows


def no_intervals(found: Evaluation) -> list[str]:
    """One sentence for each run without intervals, with the reason."""
    return [f"{name}: {reason}." for name, reason in found.no_intervals.items()]


def _spread(found: Evaluation) -> str:
    """Sentence on what the models' standard deviations are over: runs, or frames where there is one run."""
    several = [name for name in found.models if len(found.folds[name]) > 1]
    one = [name for name in found.models if name not in several]
    if not several or not one:
        return f"± is the standard deviation over {'runs' if several else 'frames, as in the paper'}."
    return (
        f"± is the standard deviation over runs for {', '.join(several)}; over frames, as in the paper, for "
        f"{', '.join(one)}."
    )


def tables(found: Evaluation) -> dict[str, tuple[Table, list[str]]]:
    """All tables by title, each with its notes."""
    size = f"{counted(found.pokes, 'test poke')}, {counted(found.frames, 'frame')}"
    everything = {name: levels["all"] for name, levels in found.tables.items()}
    result: dict[str, tuple[Table, list[str]]] = {
        "Models and baselines": (full_table(everything, "model"), [f"{size}, all softness levels."]),
        "The paper's table": (
            paper_table(found),
            [
                f"{size}. {_spread(found)} The paper's data are others (1,320 pokes, about 14 to 16 mm "
                "deep): its rows are for orientation."
            ],
        ),
        "Symmetry": (
            symmetry_table(found),
            ["Largest difference between moving the scene before and after the prediction."],
        ),
        "Intervals": (
            interval_table(found),
            [
                *no_intervals(found),
                "Conformal, calibrated on the validation pokes in five parts, each poke one draw, in rings "
                "of distance from first contact; counted on test pokes. ± is the standard error of what is "
                "counted, the shapes (below five of them, the pokes) being a sample. Frames inside what "
                "was trained calibrate, outside the intervals are wider. Few pokes cannot promise 90 %. By "
                "the other folds: calibrated on the predictions by runs of other folds for unseen shapes; "
                "kept with the run.",
            ],
        ),
    }
    if found.clouds:
        note = (
            "At scattered points, each in the place of the grid point of its cell (means over clouds of each "
            "size), against interpolation of the surface meshes; that interpolation alone is "
            f"{found.interpolation_mm:.4f} mm off the grid's stored values."
        )
        result["Other points"] = full_table(found.clouds, "points"), [note]
    for bands, what, title in (
        (found.depths, "depth", "By depth"),
        (found.covers, "cover over the inclusion below the contact", "By cover"),
    ):
        if bands:
            rows = {name: over_folds(folds) for name, folds in bands.items()}
            several = any(len(folds) > 1 for folds in bands.values())
            note = f"Test frames by {what}" + (", means over the runs of a model." if several else ".")
            result[title] = full_table(rows, f"model, {title.removeprefix('By ')}"), [note]
    if found.outside:
        note = (
            "Frames by how far they lie outside what was trained, in widths of the trained ranges "
            "(docs/explanation/learning.md, Domain of validity). Widened: as learn.predict states them there."
        )
        result["Outside what was trained"] = outside_table(found), [note]
    if found.deeper:
        note = "Test frames up to and beyond the depth that was trained on."
        result["Deeper than trained"] = full_table(found.deeper, "frames"), [note]
    return result


def write_report(found: Evaluation, folder: Path) -> None:
    """Write FOLDER/report.html, tables.json and the pictures (learning, best, median, worst, force .png).

    All are made before the first is written, so that a fault leaves an earlier report as it was.
    """
    store, first = found.store, found.runs[0]
    assert found.predictions is not None
    titles = {"only": "the only test poke"}
    pictures = {
        name: encoded(draw_poke(store, found.predictions, poke, titles.get(name, name)))
        for name, poke in ranked_pokes(found.predictions).items()
    }
    pictures["force"] = encoded(draw_forces(found.predictions))
    named = dict(zip(_names(found), found.runs, strict=True))
    logs = {name: lines for name, run in named.items() if (lines := read_log(run.folder))}
    learning = encoded(draw_learning(logs)) if logs else ""
    about = [
        ("runs", ", ".join(named)),
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
        title="Surrogate of the poke response: evaluation",
        verdict=verdict(found),
        cautions=cautions(found),
        about=about,
        learning=learning,
        sections=[
            {"title": t, "table": table, "notes": notes} for t, (table, notes) in tables(found).items()
        ],
        metrics=METRICS.values(),
        pictures=pictures.items(),
    )
    files = {
        f"{name}.png": base64.b64decode(picture)
        for name, picture in {"learning": learning, **pictures}.items()
        if picture
    }
    files["tables.json"] = (json.dumps(_finite(as_json(found)), indent=1, allow_nan=False) + "\n").encode()
    files["report.html"] = html.encode()
    folder.mkdir(parents=True, exist_ok=True)
    for name in _PICTURES - {*files}:  # of an earlier report
        (folder / name).unlink(missing_ok=True)
    for name, content in files.items():
        write_whole(folder / name, content)


def _names(found: Evaluation) -> list[str]:
    """Names of the runs: of their folders, or the paths of these if two have the same name."""
    names = [run.folder.name for run in found.runs]
    return names if len(set(names)) == len(names) else [str(run.folder) for run in found.runs]


def _finite(values: Any) -> Any:
    """The values with null for numbers that are none, which JSON has no word for."""
    if isinstance(values, dict):
        return {key: _finite(value) for key, value in values.items()}
    if isinstance(values, list | tuple):
        return [_finite(value) for value in values]
    return None if isinstance(values, float) and not isfinite(values) else values


def as_json(found: Evaluation) -> dict[str, Any]:
    """All numbers; percentages as fractions, lengths in mm, forces in N."""

    def plain(values: Row) -> dict[str, Any]:
        return {name: {"mean": v.mean, "sd": v.sd} for name, v in values.items()}

    return {
        "dataset": found.store.uuid,
        "law": found.store.law,
        "runs": _names(found),
        "test_pokes": found.pokes,
        "test_frames": found.frames,
        "tables": {m: {s: plain(v) for s, v in levels.items()} for m, levels in found.tables.items()},
        "symmetry": {n: vars(t) for n, t in found.symmetry.items()},
        "symmetry_about_vertical": {n: vars(t) for n, t in found.symmetry_vertical.items()},
        "intervals": {
            n: {**vars(c.found), "promised": c.intervals.promised, "rank": c.rank, "radius_mm": c.radius_mm}
            for n, c in [
                *found.covered.items(),
                *((f"{name}, by the other folds", c) for name, c in found.across.items()),
            ]
        },
        "no_intervals": found.no_intervals,
        "clouds": {n: plain(v) for n, v in found.clouds.items()},
        "depths": {n: plain(over_folds(v)) for n, v in found.depths.items()},
        "covers": {n: plain(over_folds(v)) for n, v in found.covers.items()},
        "outside": {n: asdict(one) for n, one in found.outside.items()},
        "deeper": {n: plain(v) for n, v in found.deeper.items()},
        "cloud_interpolation_mm": found.interpolation_mm,
    }
