"""The 18 rows that the paper prints (its table of calibration results)."""

from __future__ import annotations

import csv
from dataclasses import dataclass, fields
from functools import cache
from importlib.resources import files


@dataclass(frozen=True, kw_only=True)
class Printed:
    """One printed row, in the paper's units: mm, ratio, percent, and seconds of one simulation."""

    surface_distance_mm: float
    hd95_mm: float
    dice: float
    volume_difference_percent: float
    time_s: float


@cache
def printed() -> dict[tuple[str, str], Printed]:
    """Rows by (law, mixture): six laws, mixtures S0, S0.5 and S1."""
    text = files("calibration.table_of_paper").joinpath("paper.csv").read_text(encoding="utf-8")
    return {
        (r["law"], r["mixture"]): Printed(**{f.name: float(r[f.name]) for f in fields(Printed)})
        for r in csv.DictReader(text.splitlines())
    }
