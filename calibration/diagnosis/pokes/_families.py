"""Which measurements may be left out together, to be predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from calibration.diagnosis.pokes._record import Record

PARTS = 5  # of a record, where there is nothing else to leave out


def families_of(records: Sequence[Record], size: int) -> Mapping[str, Sequence[tuple[str, object]]]:
    """Rows (by index; forces along all records, then those across) by trial, by material, by phase of the
    same label, and in fifths of each record. A family of one group, or the same as another, is left out."""
    by: dict[str, dict[str, list[int]]] = {}
    first, after = 0, sum(r.points for r in records)
    for r in records:
        fifths = np.array_split(np.arange(r.points), PARTS)
        labels = {
            "leave-one-trial-out": [r.name] * r.points,
            "leave-one-material-out": [r.material] * r.points,
            "leave-one-phase-out": [r.labels[int(p)] for p in r.phase],
            "leave-one-fifth-out": [
                f"part {n + 1} of each record" for n, part in enumerate(fifths) for _ in part
            ],
        }
        for family, names in labels.items():
            groups = by.setdefault(family, {})
            for k, name in enumerate(names):
                rows = groups.setdefault(name, [])
                rows.append(first + k)
                if r.across is not None:
                    rows += [after + 2 * k, after + 2 * k + 1]
        first += r.points
        after += 0 if r.across is None else 2 * r.points
    assert after == size
    found: dict[str, Sequence[tuple[str, object]]] = {}
    known = []
    for family, groups in by.items():
        sets = {frozenset(rows) for rows in groups.values()}
        if len(groups) > 1 and sets not in known:
            known.append(sets)
            found[family] = [(name, frozenset(rows)) for name, rows in groups.items()]
    return found
