"""Functions on records of all kinds: segmentation into strokes and holds, thinning, listing of names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LONG = 2.0  # least duration of a hold, over the time that the adjacent motion takes for 10 tolerances


@dataclass(frozen=True, kw_only=True)
class Stroke:
    """A monotone part of a driven quantity.

    Attributes
    ----------
    points : slice of the record, from the preceding turning point on.
    direction : +1 if it grows, -1 if it falls, 0 if it never moves by the tolerance.
    """

    points: slice
    direction: float


def strokes(driven: Array, tolerance: float) -> list[Stroke]:
    """Monotone parts of a driven quantity (a stretch, a depth) in the order of the record.

    A reversal by no more than `tolerance` counts as noise. Holds belong to the stroke before them.
    """
    turns, directions = [0], []
    top = bottom = 0  # indices of the extremes since the last turn
    direction = 0.0
    for i in range(1, driven.size):
        top = i if driven[i] > driven[top] else top
        bottom = i if driven[i] < driven[bottom] else bottom
        if direction >= 0.0 and driven[top] - driven[i] > tolerance:
            if direction > 0.0:
                turns.append(top)
            directions.append(-1.0)
            direction, bottom, top = -1.0, i, i
        elif direction <= 0.0 and driven[i] - driven[bottom] > tolerance:
            if direction < 0.0:
                turns.append(bottom)
            directions.append(1.0)
            direction, bottom, top = 1.0, i, i
    ends = [*turns, driven.size]
    return [
        Stroke(points=slice(a, b), direction=d)
        for (a, b), d in zip(pairwise(ends), directions or [0.0], strict=True)
    ]


def holds(time: Array, driven: Array, tolerance: float) -> list[slice]:
    """Rows of each hold of a driven quantity.

    In a hold the quantity stays within `tolerance` of its value in the first row, for at least LONG times the
    time in which the adjacent motion covers 10 tolerances.
    """
    found: list[slice] = []
    i = 0
    while i < driven.size - 1:
        away = np.abs(driven[i:] - driven[i]) > tolerance
        end = i + int(np.argmax(away)) if away.any() else driven.size
        far = 10.0 * tolerance
        later = np.flatnonzero(np.abs(driven[end:] - driven[i]) > far)
        earlier = np.flatnonzero(np.abs(driven[:i] - driven[i]) > far)
        beside = [time[end + later[0]] - time[end - 1]] if later.size else []
        beside += [time[i] - time[earlier[-1]]] if earlier.size else []
        if beside and end - i > 1 and time[end - 1] - time[i] >= LONG * min(beside):
            found.append(slice(i, end))
            i = end
        else:
            i += 1
    return found


BEGINNING = 4  # number of rows from which the speed of a first ramp is estimated, at least
NO_RAMP = 0.01  # fraction of the largest driven value below which a motion is none


def ramp_start(time: Array, driven: Array, stop: int) -> float | None:
    """Time at which the first ramp of a record left rest, extrapolated from its first rows.

    Parameters
    ----------
    time, driven : ndarray of float, shape (k,)
        Time [s], and the driven quantity less its value at rest.
    stop : int
        Row after the last one of the ramp.

    Returns
    -------
    float or None
        None if the record begins at rest or by a jump: the first rows are a hold or creep, not the end of a
        ramp of which more than half is missing.
    """
    last = min(stop, driven.size - 1)
    gone, travel = driven[0], driven[last] - driven[0]
    away = np.abs(driven[: last + 1] - gone) > NO_RAMP * float(np.abs(driven).max())
    if gone * travel <= 0.0 or abs(gone) > abs(travel) or not away.any():
        return None
    row = max(int(np.argmax(away)), min(BEGINNING, last))
    made = driven[row] - gone
    if gone * made <= 0.0 or time[row] <= time[0]:
        return None
    return float(time[0] - (time[row] - time[0]) * gone / made)


def bins(points: slice, most: int) -> tuple[NDArray[np.intp], Array]:
    """First index of each of at most `most` bins, relative to the slice's start, and their sizes."""
    size = points.stop - points.start
    first = np.unique(np.linspace(0, size, min(size, most), endpoint=False).astype(np.intp))
    return first, np.diff(np.append(first, size)).astype(float)


class Named(Protocol):
    @property
    def name(self) -> str: ...


def listed(records: Sequence[Named]) -> str:
    """Names of records, separated by commas; of more than six, the first five and the number of others."""
    names = [r.name for r in records]
    return ", ".join(names) if len(names) <= 6 else f"{', '.join(names[:5])} and {len(names) - 5} more"


HELD = 0.3  # fraction of steps without motion above which a record is shown over time
STILL = 1e-3  # fraction of the driven quantity's range below which a step counts as no motion


class Axis(TypedDict):
    """Abscissa of a record for display: label with unit, and values."""

    axis: str
    x: Array


def over_time(time: Array, driven: str, values: Array) -> Axis:
    """Abscissa of a record: time if it has a clock and many holds (HELD), else the driven quantity."""
    still = np.abs(np.diff(values)) < STILL * max(float(np.ptp(values)), 1e-300)
    if np.isfinite(time).all() and still.size and still.mean() > HELD:
        return {"axis": "time [s]", "x": time}
    return {"axis": driven, "x": values}
