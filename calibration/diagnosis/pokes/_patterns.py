"""What a departure that no effect explains might look like: smooth in depth and in time, phase by phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._record import Record

Array = NDArray[np.float64]

BEND = 4  # highest degree


def patterns_of(records: Sequence[Record], forces: Sequence[Array]) -> Mapping[str, Array]:
    """Columns (points, k) [N], by name; forces [N]: simulated, since the noise of measured ones would be
    found again.

    trial bends: of each trial, degrees up to BEND in the depth, in parts of its force. phase bends: the same
    for each phase of it. drifts: of each trial, in its time. shared bends: as trial bends, one for all trials
    of a specimen.
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
        largest = float(np.abs(forces[k]).max(initial=0.0))
        size = np.abs(forces[k]) + 0.02 * largest
        phases = np.unique(r.phase)
        for degree in range(BEND + 1):
            add("trial bends", [(k, size * _legendre(r.depth, degree))])
            add("drifts", [(k, largest * _legendre(r.time, degree))])
            for p in phases if phases.size > 1 and degree < BEND else []:
                mine = r.phase == p
                # in a hold the depth stands still, and time goes on
                bend = _legendre(r.time if not r.kind[mine].any() else r.depth, degree, mine)
                add("phase bends", [(k, np.where(mine, size * bend, 0.0))])
    specimens = dict.fromkeys(r.specimen for r in records)
    if len(specimens) < len(records):
        for s in specimens:
            alike = [k for k, r in enumerate(records) if r.specimen == s]
            low = min(float(records[k].depth.min()) for k in alike)
            high = max(float(records[k].depth.max()) for k in alike)
            for degree in range(BEND + 1):
                add(
                    "shared bends",
                    [(k, np.abs(forces[k]) * _scaled(records[k].depth, low, high, degree)) for k in alike],
                )
    return {name: np.column_stack(columns) for name, columns in sets.items()}


def _legendre(x: Array, degree: int, among: NDArray[np.bool_] | None = None) -> Array:
    part = x if among is None else x[among]
    return _scaled(x, float(part.min()), float(part.max()), degree)


def _scaled(x: Array, low: float, high: float, degree: int) -> Array:
    unit = np.zeros(x.size) if not high > low else 2.0 * (np.clip(x, low, high) - low) / (high - low) - 1.0
    return np.asarray(np.polynomial.legendre.legval(unit, np.eye(degree + 1)[degree]))
