"""Cross-validation folds: groups of rows that are held out together and predicted from the others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.bool_]

PARTS = 5  # number of consecutive parts of a record, for folds if there is nothing else to hold out


def fifths(points: int) -> list[str]:
    """Fold label of each point of a record: the fifth of the record that it is in."""
    parts = np.array_split(np.arange(points), PARTS)
    return [f"part {n + 1} of each record" for n, part in enumerate(parts) for _ in part]


def joined(each: Iterable[Mapping[str, Sequence[str]]]) -> dict[str, list[str]]:
    """Fold labels of all rows by set of folds, from those of each block of rows, in their order."""
    found: dict[str, list[str]] = {}
    for block in each:
        for name, labels in block.items():
            found.setdefault(name, []).extend(labels)
    return found


def folds_of(labels: Mapping[str, Sequence[str]]) -> dict[str, list[tuple[str, Rows]]]:
    """Sets of folds by name, in the same order; a fold is a label with its mask of rows, shape (rows,).

    A set of one fold, and a set with the same partition of the rows as an earlier one, is left out.
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
