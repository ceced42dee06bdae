"""Rows of measurements (forces along all records, then those across): whose they are, and which may be left
out together, to be predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.records import distinct, fifths


def size_of(records: Sequence[Record]) -> int:
    """Rows of all measurements."""
    return sum(r.points * (1 if r.across is None else 3) for r in records)


def rows_of(records: Sequence[Record]) -> list[tuple[Record, NDArray[np.intp]]]:
    """Each record with its rows: along, then across (two a point)."""
    found = []
    first, after = 0, sum(r.points for r in records)
    for r in records:
        rows = np.arange(first, first + r.points)
        first += r.points
        if r.across is not None:
            rows = np.concatenate([rows, np.arange(after, after + 2 * r.points)])
            after += 2 * r.points
        found.append((r, rows))
    return found


def families_of(records: Sequence[Record]) -> Mapping[str, Sequence[tuple[str, object]]]:
    """By trial, by material, by phase of the same label, and in fifths of each record. A family of one group,
    or the same as another, is left out."""
    by: dict[str, dict[str, list[int]]] = {}
    for r, rows in rows_of(records):
        labels = {
            "leave-one-trial-out": [r.name] * r.points,
            "leave-one-material-out": [r.material] * r.points,
            "leave-one-phase-out": [r.labels[int(p)] for p in r.phase],
            "leave-one-fifth-out": fifths(r.points),
        }
        for family, names in labels.items():
            groups = by.setdefault(family, {})
            for k, name in enumerate(names):
                across = rows[r.points :][2 * k : 2 * k + 2]
                groups.setdefault(name, []).extend([int(rows[k]), *(int(n) for n in across)])
    return distinct(by)
