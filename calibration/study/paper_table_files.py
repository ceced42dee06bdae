"""The table for people (rich, Markdown: ours, the paper's in brackets) and for programs (CSV)."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from calibration._files import write_whole
from calibration.metrics import METRICS
from calibration.study.paper_table import Row

HEAD = (
    "law",
    "mixture",
    "G / kPa",
    "surface distance / mm",
    "HD95 / mm",
    "Dice",
    "volume difference / %",
    "from nodes: distance / mm",
    "from nodes: HD95 / mm",
    "core-s a beam",
    "core-s a candidate",
    "fit: core-s",
    "fit: wall s",
    "status",
)

# The columns that fit a terminal of 80 characters.
SCREEN_HEAD = HEAD[:7]

CSV_HEAD = (
    "law",
    "material",
    "mixture",
    "status",
    "message",
    "shear_modulus_kPa",
    "surface_distance_mm",
    "hd95_mm",
    "dice",
    "volume_difference_percent",
    "node_distance_mm",
    "node_hd95_mm",
    "beam_core_s",
    "candidate_core_s",
    "fit_core_s",
    "fit_wall_s",
    "paper_surface_distance_mm",
    "paper_hd95_mm",
    "paper_dice",
    "paper_volume_difference_percent",
    "paper_time_s",
)


def rich_table(rows: Sequence[Row]) -> Table:
    """Table for a terminal of 80 columns: the paper's value under ours."""
    table = Table(
        title="Calibration results, in brackets the paper's; all columns in table.md",
        box=None, padding=(0, 1, 0, 0), pad_edge=False, header_style="bold",
    )  # fmt: skip
    for name in SCREEN_HEAD:
        table.add_column(name.replace("difference", "diff."), no_wrap=name in ("law", "mixture"))
    table.add_column("status", min_width=len("converged"))
    for r in rows:
        table.add_row(*(c.replace(" (", "\n(") for c in _cells(r)[: len(SCREEN_HEAD)]), str(r.status))
    return table


AS_STATED = "beams as the lab states them, photographs as they lie"


def write_markdown(
    path: Path, rows: Sequence[Row], *, command: str, source: str, setup: str = AS_STATED
) -> None:
    """Write the table as a page, with the command that made it; setup : of beams and photographs."""
    further = _further_names(rows)
    head = (*HEAD, *(f"{METRICS[n].title} / {METRICS[n].unit}" if n in METRICS else n for n in further))
    lines = [
        "# Calibration results",
        "",
        f"`{command}`",
        "",
        f"{source} In brackets: the paper's printed row of the same law and mixture, its time that of one"
        " simulation. Means over the photographs of a beam, then over the beams. Simulated at the fitted"
        f" parameters against the section swept along the measured mid line; {setup}.",
        "",
        "| " + " | ".join(head) + " |",
        "| " + " | ".join(["---"] * len(head)) + " |",
        *(
            "| " + " | ".join(c.replace("|", "/") for c in (*_cells(r), *_further(r, further))) + " |"
            for r in rows
        ),
    ]
    write_whole(path, "\n".join(lines) + "\n")


def write_csv(path: Path, rows: Sequence[Row]) -> None:
    """Write the rows for programs; an empty cell where there is no figure."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    further = _further_names(rows)
    writer.writerow((*CSV_HEAD, *further))
    for r in rows:
        m, p = r.measures, r.paper
        ours = (
            ["" for _ in range(7)]
            if m is None
            else [
                f"{1e3 * m.surface_distance:.4f}",
                f"{1e3 * m.hd95:.4f}",
                f"{m.dice:.5f}",
                f"{100 * m.volume_difference:.4f}",
                f"{1e3 * m.node_distance:.4f}",
                f"{1e3 * m.node_hd95:.4f}",
                f"{m.beam_seconds:.4f}",
            ]
        )
        theirs = (
            ["" for _ in range(5)]
            if p is None
            else [p.surface_distance_mm, p.hd95_mm, p.dice, p.volume_difference_percent, p.time_s]
        )
        writer.writerow(
            [
                r.law,
                r.material,
                r.mixture,
                r.status,
                r.message,
                _number(r.shear_modulus / 1e3, ".4f"),
                *ours,
                _number(r.candidate_seconds, ".4f"),
                _number(r.fit_seconds, ".2f"),
                _number(r.wall_seconds, ".2f"),
                *(t if isinstance(t, str) else f"{t:.6g}" for t in theirs),
                *_further(r, further),
            ]
        )
    write_whole(path, text.getvalue())


def _further_names(rows: Sequence[Row]) -> list[str]:
    """Names of the metrics that were registered from outside."""
    return list(dict.fromkeys(n for r in rows if r.measures for n in r.measures.further))


def _further(r: Row, names: Sequence[str]) -> list[str]:
    """Their values in SI; empty where there is none."""
    known = r.measures.further if r.measures else {}
    return [f"{known[n]:.6g}" if n in known else "" for n in names]


def _cells(r: Row) -> list[str]:
    m, p = r.measures, r.paper
    ours = ["-"] * 5
    nodes = ["-", "-"]
    if m is not None:
        ours = [
            f"{1e3 * m.surface_distance:.3f}",
            f"{1e3 * m.hd95:.3f}",
            f"{m.dice:.4f}",
            f"{100 * m.volume_difference:.2f}",
            f"{m.beam_seconds:.2f}",
        ]
        nodes = [f"{1e3 * m.node_distance:.2f}", f"{1e3 * m.node_hd95:.2f}"]
    if p is not None:
        theirs = (
            f"{p.surface_distance_mm:.3f}",
            f"{p.hd95_mm:.3f}",
            f"{p.dice:.3f}",
            f"{p.volume_difference_percent:.2f}",
            f"{p.time_s:.1f}",
        )
        ours = [f"{a} ({b})" for a, b in zip(ours, theirs, strict=True)]
    return [
        r.law,
        r.mixture,
        _number(r.shear_modulus / 1e3, ".2f") or "-",
        *ours[:4],
        *nodes,
        ours[4],
        *(_number(v, ".2f") or "-" for v in (r.candidate_seconds, r.fit_seconds, r.wall_seconds)),
        r.status + (f": {r.message}" if r.message else ""),
    ]


def _number(value: float, form: str) -> str:
    return "" if math.isnan(value) else format(value, form)
