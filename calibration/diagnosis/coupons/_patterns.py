"""What a departure that no effect explains might look like: smooth in the strain, shared in several ways."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons._record import Record

Array = NDArray[np.float64]

BEND = 4  # highest degree
JUMPS = 8


def patterns_of(records: Sequence[Record]) -> Mapping[str, Array]:
    """Columns (points, k), by name, in standard deviations of the points (so of the whitened residual).

    trial bends: of each trial, degrees up to BEND in the strain. mode bends: the same for trials of one mode
    and material. loops: as trial bends, opposite in loading and unloading. drifts: of each trial that turns,
    in its time (in the order of its points, where it has none). cycles: one shift a branch. jumps: steps of
    each trial, at eighths of its record.
    """
    sets: dict[str, list[Array]] = {}
    starts = np.cumsum([0, *(r.points for r in records)])
    rows = [slice(int(a), int(b)) for a, b in pairwise(starts)]

    def add(name: str, parts: Sequence[tuple[int, Array]]) -> None:
        column = np.zeros(int(starts[-1]))
        for k, values in parts:
            column[rows[k]] = values
        if column.any():
            sets.setdefault(name, []).append(column)

    for k, r in enumerate(records):
        back = np.where(np.isfinite(r.turn), -1.0, 1.0)
        turns = np.unique(r.branch)
        for degree in range(BEND + 1):
            bend = _legendre(np.log(r.stretch) if (r.stretch > 0).all() else r.stretch, degree)
            add("trial bends", [(k, bend)])
            if r.unloads:
                add("loops", [(k, back * bend)])
            if turns.size > 1:
                add("drifts", [(k, _legendre(_clock(r), degree))])
        for part in range(1, JUMPS):
            add("jumps", [(k, (np.arange(r.points) >= part * r.points / JUMPS).astype(float))])
        for b in turns if turns.size > 1 else []:
            add("cycles", [(k, (r.branch == b).astype(float))])
    kinds = dict.fromkeys((r.mode, r.material) for r in records)
    if len(kinds) < len(records):
        for kind in kinds:
            alike = [k for k, r in enumerate(records) if (r.mode, r.material) == kind]
            strains = np.concatenate([records[k].stretch for k in alike])
            for degree in range(BEND + 1):
                values = _legendre(strains, degree)
                ends = np.cumsum([records[k].points for k in alike])[:-1]
                add("mode bends", list(zip(alike, np.split(values, ends), strict=True)))
    return {name: np.column_stack(columns) for name, columns in sets.items()}


def _clock(r: Record) -> Array:
    return r.time if np.isfinite(r.time).all() else np.arange(float(r.points))


def _legendre(x: Array, degree: int) -> Array:
    low, high = float(x.min(initial=np.inf)), float(x.max(initial=-np.inf))
    unit = np.zeros(x.size) if not high > low else 2.0 * (x - low) / (high - low) - 1.0
    return np.asarray(np.polynomial.legendre.legval(unit, np.eye(degree + 1)[degree]))
