"""Cross-validation folds: rows that may be left out together, to be predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.bool_]

PARTS = 5  # of a record, for folds where there is nothing else to leave out


def fifths(points: int) -> list[str]:
    """The fifth of its record that each of its points is in."""
    parts = np.array_split(np.arange(points), PARTS)
    return [f"part {n + 1} of each record" for n, part in enumerate(parts) for _ in part]


def folds_of(labels: Mapping[str, Sequence[str]]) -> dict[str, list[tuple[str, Rows]]]:
    """Sets of folds from labels of all rows, by name and in the same order: the rows (rows,) of each label.

    A set of one fold, and a set that parts the rows as one before does, is left out.
    """
    found: dict[str, list[tuple[str, Rows]]] = {}
    known: list[set[bytes]] = []
    for name, owners in labels.items():
        own = np.array(owners, dtype=object)
        groups = [(str(label), np.asarray(own == label)) for label in dict.fromkeys(owners)]
        rows = {group.tobytes() for _, group in groups}
        if len(groups) > 1 and rows not in known:
            known.append(rows)
            found[name] = groups
    return found
