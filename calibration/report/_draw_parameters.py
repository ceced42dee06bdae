"""Pictures of parameters: each law's constants with their 95 % intervals, and held-out predictions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullLocator

from calibration.experiment.model import Experiment
from calibration.inference import Estimate
from calibration.pages import FAINT, Picture, looks, paper, picture, plain
from calibration.report._tables import beam_lengths
from calibration.study.assessment import display_name
from calibration.study.calibration import Calibration
from calibration.study.cards import shear_interval

_SEEN = {
    "identified": "#0072B2",
    "weak": "#E69F00",
    "at a bound": "#D55E00",
    "not identified": FAINT,
    "held": FAINT,
}
Bar = tuple[str, float, float, float, str]  # law, value, low, high, how well the data see it


def draw_parameters(results: Sequence[Calibration], name: str) -> Picture | None:
    """Panels for the shear modulus and K/G, and one for each shape constant; None without error bars."""
    fitted = [r for r in results if r.estimates]
    if not fitted:
        return None
    above = [("G / kPa", [_shear(r) for r in fitted]), ("K/G", _bars(fitted, "bulk_ratio"))]
    constants = dict.fromkeys(e.name for r in fitted for e in r.estimates)
    below = []
    for constant in constants:
        if constant not in ("shear_modulus", "bulk_ratio"):
            unit = " / kPa" if constant.startswith("shear_modulus") else ""
            below.append((display_name(constant) + unit, _bars(fitted, constant)))
    rows = [above, *(below[i : i + 3] for i in range(0, len(below), 3))]
    heights = [0.75 + 0.26 * max(len(bars) for _, bars in row) for row in rows]
    figure = paper(10.5, sum(heights) + 0.4)
    strips = figure.subfigures(len(rows), 1, height_ratios=heights, squeeze=False)[:, 0]
    for strip, row in zip(strips, rows, strict=True):
        for axes, (title, bars) in zip(strip.subplots(1, len(row), squeeze=False)[0], row, strict=True):
            _panel(axes, title, bars)
    used = dict.fromkeys(bar[4] for row in rows for _, bars in row for bar in bars)
    handles = [Line2D([], [], marker="o", color=_SEEN[seen], ms=4) for seen in used]
    figure.legend(handles, list(used), loc="outside upper left", ncols=4, fontsize=8, frameon=False)
    return picture(
        figure,
        f"{name}-parameters",
        "Constants of each law with their 95 % intervals, coloured by how well the data determine them. Grey:"
        " not identified, the interval is the prior's or the bounds', or, of a constant that was held, the"
        " hold's.",
    )


def draw_held_out(results: Sequence[Calibration], experiment: Experiment, name: str) -> Picture | None:
    """Each beam predicted from the others: distance, and the shear modulus that the others give."""
    trials = list(dict.fromkeys(h.trial for r in results for h in r.held_out))
    if not trials:
        return None
    lengths = beam_lengths(experiment)
    trials.sort(key=lambda t: lengths[t])
    by_law = looks(r.label for r in results)
    figure = paper(11.0, 3.4)
    distance, modulus = figure.subplots(1, 2)
    shown = [r for r in results if r.held_out]
    for i, r in enumerate(shown):
        colour, marker = by_law[r.label].colour, by_law[r.label].marker
        shift = 0.5 * ((i + 0.5) / len(shown) - 0.5)
        at = np.array([trials.index(h.trial) for h in r.held_out]) + shift
        raw, left = (1e3 * np.array([getattr(h, n) for h in r.held_out]) for n in ("rms_raw", "rms"))
        distance.vlines(at, np.minimum(raw, left), np.maximum(raw, left), color=colour, lw=0.6, alpha=0.5)
        distance.plot(at, raw, marker, ms=6, mfc="white", color=colour, alpha=0.8)
        distance.plot(at, left, marker, ms=6, color=colour, label=r.label)
        _, own, low, high, _ = _shear(r)
        modulus.axhline(own, color=colour, lw=0.7, alpha=0.7)
        modulus.axhspan(low, high, color=colour, alpha=0.08, lw=0)
        modulus.plot(at, [h.shear_modulus / 1e3 for h in r.held_out], marker, ms=6, color=colour)
    names = [f"{t}\n({lengths[t] * 1e3:g} mm)" for t in trials]
    for axes in (distance, modulus):
        plain(axes).set_xticks(range(len(trials)), names, fontsize=8)
        axes.set_xlim(-0.5, len(trials) - 0.5)
    distance.set_ylim(bottom=0.0)
    distance.set_ylabel("rms distance / mm", fontsize=9)
    distance.set_title("predicted from the other beams; hollow: as traced", fontsize=9, loc="left")
    modulus.set_ylabel("G / kPa", fontsize=9)
    modulus.set_title("G without this beam; line and band: with all", fontsize=9, loc="left")
    figure.legend(loc="outside upper left", ncols=6, fontsize=8, frameon=False)
    return picture(
        figure,
        f"{name}-held-out",
        "Each beam predicted with the parameters that all other measurements give: rms distance registered"
        " (filled) and as traced (hollow), and the shear modulus of the others (band: 95 % interval of the"
        " fit to all).",
    )


def _shear(r: Calibration) -> Bar:
    """Small-strain modulus of the whole law, also where it has several terms."""
    own = next((e for e in r.estimates if e.name == "shear_modulus"), None)
    if own is not None:
        return _bar(r, own)
    low, high = (0.0 if part is None else part for part in shear_interval(r))
    value = r.shear_modulus / 1e3
    return r.label, value, value * (1.0 + low), value * (1.0 + high), "identified"


def _bar(r: Calibration, e: Estimate) -> Bar:
    part = 1e-3 if e.unit == "Pa" else 1.0
    return r.label, part * e.value, part * e.low, part * e.high, e.seen


def _bars(fitted: Sequence[Calibration], constant: str) -> list[Bar]:
    return [_bar(r, e) for r in fitted for e in r.estimates if e.name == constant]


def _panel(axes: Any, title: str, bars: Sequence[Bar]) -> None:
    plain(axes).set_title(title, fontsize=9, loc="left")
    low, high = min(b[2] for b in bars), max(b[3] for b in bars)
    if low > 0.0 and high > 8.0 * low:
        axes.set_xscale("log")
        few = high < 300.0 * low
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0) if few else (1.0,), numticks=6))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_locator(NullLocator())
    for row, (_, value, low, high, seen) in enumerate(bars):
        axes.plot([low, high], [row, row], "-", lw=2, color=_SEEN[seen], solid_capstyle="butt")
        axes.plot([value], [row], "o", ms=5, color=_SEEN[seen])
    axes.set_yticks(range(len(bars)), [b[0] for b in bars], fontsize=8)
    axes.set_ylim(len(bars) - 0.4, -0.6)
    axes.grid(axis="x", color="#EEEEEE")
    axes.set_axisbelow(True)
