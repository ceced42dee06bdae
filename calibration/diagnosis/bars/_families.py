"""Rows of bars' measurements that may be left out together, to be predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._candidates import load_of
from calibration.diagnosis.bars._coordinates import Coordinates
from calibration.diagnosis.bars._record import LAST, Record, groups_of

Rows = NDArray[np.bool_]


def families_of(records: Sequence[Record]) -> Mapping[str, Sequence[tuple[str, object]]]:
    """Rows (by number) by load, by trial, and what swings against what has settled. A family of one group, or
    the same as another, is left out."""
    starts = np.cumsum([0, *(len(r.measured()) for r in records)])
    every = [np.arange(a, b) for a, b in pairwise(starts)]
    late = [r.labels()[2] > LAST * r.period for r in records]
    families = {
        "leave-one-load-out": {
            name: [every[k] for k in members] for name, members in groups_of(records).items()
        },
        "leave-one-trial-out": {r.name: [every[k]] for k, r in enumerate(records)},
        "swing-or-settled-out": {
            "the swing": [e[~x] for e, x in zip(every, late, strict=True)],
            "what has settled": [e[x] for e, x in zip(every, late, strict=True)],
        },
    }
    found: dict[str, Sequence[tuple[str, object]]] = {}
    known = []
    for family, groups in families.items():
        sets = {name: frozenset(np.concatenate(parts).tolist()) for name, parts in groups.items()}
        if len(sets) > 1 and all(sets.values()) and set(sets.values()) not in known:
            known.append(set(sets.values()))
            found[family] = list(sets.items())
    return found


def hit_by(group: object, size: int) -> Rows:
    """(size,): where a family's group stands among all rows."""
    assert isinstance(group, frozenset)
    hit = np.zeros(size, dtype=bool)
    hit[list(group)] = True
    return hit


def untold(records: Sequence[Record], coordinates: Coordinates, left: Rows) -> Rows:
    """Of which coordinates the rows that are left tell nothing, (n,): of moduli, of a trial's own. What only
    the swing tells (the release) is taken from it where the swing is left out."""
    found = np.zeros(len(coordinates.names), dtype=bool)
    start = 0
    told: set[str] = set()
    for r in records:
        rows = slice(start, start + len(r.measured()))
        start = rows.stop
        time = r.labels()[2]
        swinging = np.isfinite(time) & (time <= LAST * r.period)
        first = coordinates.of_trial(r)
        found[first : first + 2] = not (left[rows] & swinging).any()
        if left[rows].any():
            told |= {r.specimen, r.trial.material, load_of(r)}
    for k, name in enumerate((*coordinates.specimens, *coordinates.materials)):
        found[k] = name not in told
    for load in coordinates.loads[1:]:
        found[coordinates.of_load(load)] = load not in told
    return found
