"""The picture of a dataset's card: depths and forces that its pokes reached."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from factory.inspection import paper_table
from factory.inspection.features import Spread
from factory.inspection.figures import COLOURS
from factory.publishing.facts import Facts


def draw_features(facts: Facts, path: Path) -> None:
    """Write bars of deepest depth and largest force by shape and softness (mean, least and largest)."""
    shapes, levels = facts.summary.shapes, facts.summary.levels
    figure = Figure(figsize=(13, 4.2), layout="constrained", dpi=110)
    depth, force = figure.subplots(1, 2)
    rows = {(row.shape, row.level): row for row in facts.rows}
    for number, level in enumerate(levels):
        colour = COLOURS[number % len(COLOURS)]
        those = [rows[shape, level] for shape in shapes]
        place = np.arange(len(shapes)) + (number - (len(levels) - 1) / 2) * 0.8 / len(levels)
        width = 0.72 / len(levels)
        _bars(depth, place, [row.deepest for row in those], width=width, color=colour, label=level)
        _bars(force, place, [row.force for row in those], width=width, color=colour, label=level)
        paper = paper_table.PAPER.get(facts.summary.model, {}).get(level)
        if paper:
            for axes, (mean, _) in ((depth, paper[0]), (force, paper[1])):
                axes.axhline(mean, color=colour, ls="--", lw=0.9)
    for axes, label in ((depth, "deepest frame [mm]"), (force, "largest force on the rod [N]")):
        axes.set(ylabel=label, ylim=(0, None))
        axes.set_xticks(range(len(shapes)), shapes, rotation=45, ha="right", fontsize=8)
    of = "material level (dashed: the paper's)" if _drawn(facts) else "material level"
    handles, labels = depth.get_legend_handles_labels()
    figure.legend(handles, labels, title=of, fontsize=8, loc="outside upper right", ncols=len(levels))
    figure.suptitle("mean of the pokes, from the least to the largest of them")
    figure.savefig(path, format="png")


def _drawn(facts: Facts) -> bool:
    rows = paper_table.PAPER.get(facts.summary.model, {})
    return any(level in rows for level in facts.summary.levels)


def _bars(axes: Any, place: Any, spreads: list[Spread | None], **style: Any) -> None:
    there = [(x, spread) for x, spread in zip(place, spreads, strict=True) if spread is not None]
    if not there:
        return
    mean = np.array([spread.mean for _, spread in there])
    low = mean - [spread.low for _, spread in there]
    high = np.array([spread.high for _, spread in there]) - mean
    # rounding may put the mean of a single poke outside its range
    reach = np.maximum([low, high], 0.0)
    axes.bar([x for x, _ in there], mean, yerr=reach, error_kw={"lw": 0.7}, **style)
