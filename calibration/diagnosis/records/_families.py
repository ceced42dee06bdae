"""Which measurements may be left out together, to be predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

PARTS = 5  # of a record, for folds where there is nothing else to leave out


def fifths(points: int) -> list[str]:
    """What part of its record each of its points is in."""
    parts = np.array_split(np.arange(points), PARTS)
    return [f"part {n + 1} of each record" for n, part in enumerate(parts) for _ in part]


def distinct(families: Mapping[str, Mapping[str, Sequence[int]]]) -> dict[str, Sequence[tuple[str, object]]]:
    """Families of groups of rows (by index), as `calibration.diagnosis.heldout.Foldable` has them: without
    those of one group, and those that are the same as one before."""
    found: dict[str, Sequence[tuple[str, object]]] = {}
    known = []
    for family, groups in families.items():
        sets = {frozenset(rows) for rows in groups.values()}
        if len(groups) > 1 and sets not in known:
            known.append(sets)
            found[family] = [(name, frozenset(rows)) for name, rows in groups.items()]
    return found
