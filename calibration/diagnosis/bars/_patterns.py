"""What a departure that no effect explains might look like: slow, swinging, or one marker's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._record import FIRST, LAST, Record

Array = NDArray[np.float64]


def patterns_of(records: Sequence[Record]) -> Mapping[str, Array]:
    """Columns (rows, k) [m], by name.

    sinking: of each trial's tip, polynomials in the logarithm of time. swings: of each trial's tip, at its
    frequency and twice that, growing and dying. markers: of each marker, a constant and a logarithm of time.
    """
    sets: dict[str, list[Array]] = {}
    starts = np.cumsum([0, *(len(r.measured()) for r in records)])

    def add(name: str, k: int, values: Array) -> None:
        column = np.zeros(int(starts[-1]))
        column[starts[k] : starts[k + 1]] = values
        if column.any():
            sets.setdefault(name, []).append(1e-3 * column)

    for k, r in enumerate(records):
        marker, axis, time = r.labels()
        after = np.isfinite(time)
        t = np.where(after, time, 1.0)
        log = np.log10(t / (FIRST * r.period)) - 1.0
        tips = r.tips[marker]
        for a in range(2):
            hit = after & tips & (axis == a)
            for degree in range(4):
                add("sinking", k, np.where(hit, log**degree, 0.0))
            for order in (1.0, 2.0):
                phase = 2.0 * np.pi * order * t / r.period
                dying = np.exp(-order * r.ratio * 2.0 * np.pi * t / r.period)
                early = hit & (t <= LAST * r.period)
                for power in range(3):
                    envelope = dying * (t / (LAST * r.period)) ** power
                    add("swings", k, np.where(early, envelope * np.cos(phase), 0.0))
                    add("swings", k, np.where(early, envelope * np.sin(phase), 0.0))
            for i in range(len(r.names)):
                mine = after & (marker == i) & (axis == a)
                add("markers", k, mine.astype(float))
                add("markers", k, np.where(mine, log, 0.0))
    return {name: np.column_stack(columns) for name, columns in sets.items()}
