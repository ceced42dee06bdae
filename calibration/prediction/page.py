"""report.html of a prediction: what came out, one picture, tables, methods last; and prediction.png."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from calibration._files import write_whole
from calibration.inference import WIDTH
from calibration.pages import BAND, COLOURS, INK, Cell, Picture, paper, picture, plain, template
from calibration.prediction._interval import SOURCES, Record
from calibration.prediction.run import BASELINE, EXTENDED, Prediction
from calibration.prediction.schema import Entry, PredictionFile, RecordEntry, file_of

MOST = 12  # records in the picture
COLUMNS = 3
BESIDE = 0.5  # of what lines and the narrowest band span, shown on either side of them
COLOUR = {BASELINE: COLOURS[4], EXTENDED: COLOURS[0]}

PAGE = """\
{% extends "frame" %}
{% from "parts" import table, figure %}
{% block title %}Prediction: {{ title }}{% endblock %}
{% block body %}
<h1>Prediction: {{ title }}</h1>
<p><strong>{{ sentence }}</strong></p>
<p>Predicted by {{ source }};
{% if fitted %}the models were fitted to these trials: this is no prediction.
{% else %}no model was fitted to the trials below.{% endif %}</p>
{% for note in notes %}
<p class="note">{{ note }}</p>
{% endfor %}
{{ figure(shown) }}
<h2>By trial</h2>
{{ table(headings, rows) }}
<p class="note">rms of predicted less measured. Skill: (rms_base² - rms_ext²) / (rms_base² - rms_noise²), 1
where the extension predicts as well as noise allows, 0 where it is no better than the baseline. Coverage:
points within their 95 % intervals.</p>
<h2>Where the intervals come from</h2>
{{ table(source_headings, sources) }}
<p class="note">Root mean squares of standard deviations.</p>
<h2>Models</h2>
{{ table(model_headings, models) }}
<h2>Method</h2>
<p>Each trial is simulated by the model of its kind of measurement, as fits and diagnoses simulate it.
What is off by the same all through a record (a zero, a place) is taken out at its most likely value.
Intervals add five sources: errors of the fitted parameters, wider by the root of the reduced chi-square where
that is above 1; how specimens of one material scatter, for a specimen that was not fitted to; noise as the
lab states it or as the records show it; and the model's error, the relative error of the modulus that is as
large as what the fit left beyond noise; and the choice of the model, where what was fitted does not tell it
from others. They hold for single points; errors of neighbouring points are alike.</p>
{% endblock %}
"""


def write_page(found: Prediction, folder: Path) -> list[Path]:
    """Write folder/report.html and folder/prediction.png; their paths, the page first."""
    shown = draw(found)
    return [
        write_whole(folder / "report.html", render(found, shown)),
        write_whole(folder / shown.name, shown.png),
    ]


def render(found: Prediction, shown: Picture) -> str:
    """The page as HTML."""
    content = file_of(found)
    return template(PAGE).render(
        title=found.experiment.name,
        sentence=found.sentence(),
        source=found.source,
        fitted=found.fitted,
        notes=found.notes,
        shown=shown,
        headings=_headings(found),
        rows=[_row(content, r) for r in content.records] + _totals(content),
        source_headings=["kind", "model", *SOURCES],
        sources=[
            [_cell(kind), _cell(m), *(_cell(f"{s.sd[n]:.3g} {e.unit}", s.sd[n]) for n in SOURCES)]
            for kind, e in content.kinds.items()
            for m, s in e.models.items()
        ],
        model_headings=["model", "what it has", "material", "shear modulus", "model error"],
        models=[
            [
                _cell(name),
                _cell(m.label),
                _cell(material),
                _cell(f"{g / 1e3:.4g} kPa", g),
                _cell(f"{100 * m.model_error[material]:.2g} %", m.model_error[material]),
            ]
            for name, m in content.models.items()
            for material, g in m.shear_modulus_Pa.items()
        ],
    )


def _cell(text: str, value: float | None = None, mark: str = "") -> Cell:
    return Cell(text=text, value=value, mark=mark)


def _headings(found: Prediction) -> list[str]:
    each = [f"{what}, {m}" for what in ("rms", "coverage") for m in found.models]
    return ["record", "kind", "material", "specimen", "points", "noise", *each, "skill"]


def _row(content: PredictionFile, r: RecordEntry) -> list[Cell]:
    return [_cell(r.record), _cell(r.kind), _cell(r.material), _cell(r.specimen), *_figures(content, r)]


def _totals(content: PredictionFile) -> list[list[Cell]]:
    return [
        [_cell("all", mark="chosen"), _cell(kind), _cell(""), _cell(""), *_figures(content, e)]
        for kind, e in content.kinds.items()
    ]


def _figures(content: PredictionFile, e: Entry) -> list[Cell]:
    rms = [_cell(f"{e.models[m].rms:.3g} {e.unit}", e.models[m].rms) for m in content.models]
    inside = [_cell(f"{e.models[m].coverage:.0%}", e.models[m].coverage) for m in content.models]
    skill = e.skill
    return [
        _cell(str(e.points), e.points),
        _cell(f"{e.rms_noise:.3g} {e.unit}", e.rms_noise),
        *rms,
        *inside,
        _cell("–" if skill is None else f"{skill:.2f}", skill),
    ]


def draw(found: Prediction) -> Picture:
    """Measured against predicted: of at most MOST records, evenly among all."""
    some = [found.records[int(k)] for k in _evenly(len(found.records))]
    columns = min(COLUMNS, len(some))
    lines = -(-len(some) // columns)
    figure = paper(4.2 * columns, 3.1 * lines + 0.8)
    panels = figure.subplots(lines, columns, squeeze=False).ravel()
    for axes, r in zip(panels, some, strict=False):
        _panel(plain(axes), found, r)
    for axes in panels[len(some) :]:
        axes.set_axis_off()
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper center", ncols=columns, frameon=False, fontsize=8)
    left_out = len(found.records) - len(some)
    caption = (
        "Measured points and predictions; bands hold 95 % of measurements where the models are right. A band"
        " that is much wider than all lines goes on beyond its frame."
    )
    if left_out:
        caption += f" {left_out} more records are in prediction.json."
    return picture(figure, "prediction", caption)


def _panel(axes: Any, found: Prediction, r: Record) -> None:
    per_si = r.shown.unit[1]
    x, measured = r.shown.x[r.used], per_si * r.shown.measured[r.used]
    lines, bands = [measured], []
    for m in found.models:
        value = per_si * r.predicted[m].value[r.used]
        wide = WIDTH * per_si * r.predicted[m].sd[r.used]
        colour = COLOUR[m]
        label = m if found.labels[m] == m else f"{m} ({found.labels[m]})"
        axes.fill_between(x, value - wide, value + wide, color=colour, alpha=0.18, linewidth=0)
        axes.plot(x, value, color=colour, linewidth=1.4, label=label)
        lines.append(value)
        bands.append(np.concatenate([value - wide, value + wide]))
    axes.plot(x, measured, ".", color=INK, markersize=3, label="measured")
    axes.set_title(f"{r.name} ({r.material})", fontsize=9)
    axes.set_xlabel(r.shown.axis, fontsize=8)
    axes.set_ylabel(f"{r.shown.quantity} [{r.shown.unit[0]}]", fontsize=8)
    axes.grid(color=BAND, linewidth=0.6)
    # all lines and the narrowest band: a wide band of the other model would leave the lines flat
    seen = np.concatenate([*lines, min(bands, key=np.ptp)])
    beside = BESIDE * float(np.ptp(seen))
    low, high = axes.get_ylim()
    axes.set_ylim(max(low, float(seen.min()) - beside), min(high, float(seen.max()) + beside))


def _evenly(count: int) -> Sequence[int]:
    return [int(k) for k in np.unique(np.linspace(0, count - 1, min(count, MOST)).round())]
