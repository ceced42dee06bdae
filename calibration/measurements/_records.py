"""Records of all kinds: segmentation into strokes, thinning, display, names, what beams have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

from calibration.experiment._thinning import groups
from calibration.experiment.model import BeamTrial, specimen_of

Array = NDArray[np.float64]


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


def bins(
    points: slice, most: int, *, driven: Array | None = None, sd: float = 0.0
) -> tuple[NDArray[np.intp], Array]:
    """First index of each of at most `most` bins, relative to the slice's start, and their sizes.

    Bins have equal numbers of rows; with the driven quantity of the whole record, and its standard deviation,
    equal shares of rows and way (`calibration.experiment._thinning.groups`).
    """
    size = points.stop - points.start
    if driven is None:
        first = np.unique(np.linspace(0, size, min(size, most), endpoint=False).astype(np.intp))
    else:
        first = groups(driven[points], most, sd=sd)
    return first, np.diff(np.append(first, size)).astype(float)


class OfBeam:
    """Attributes of a record by the trial of its beam; see `calibration.measurements._model.Record`."""

    trial: BeamTrial

    @property
    def material(self) -> str:
        return self.trial.material

    @property
    def specimen(self) -> str:
        return specimen_of(self.trial)

    def _ranges(self, times: Sequence[float]) -> Mapping[str, tuple[float, float]]:
        """`ranges` of a record that has these times [s]."""
        length = 1e3 * self.trial.free_length
        return {"free_length_mm": (length, length), "time_s": (min(times), max(times))}


class Named(Protocol):
    @property
    def name(self) -> str: ...


def listed(records: Sequence[Named]) -> str:
    """Names of records, separated by commas; of more than six, the first five and the number of others."""
    names = [r.name for r in records]
    return ", ".join(names) if len(names) <= 6 else f"{', '.join(names[:5])} and {len(names) - 5} more"


HELD = 0.3  # fraction of steps without motion above which a record is shown over time
NO_MOTION = 1e-3  # fraction of the driven quantity's range below which a step counts as no motion


class Axis(TypedDict):
    """Abscissa of a record for display: label with unit, and values."""

    axis: str
    x: Array


def over_time(time: Array, driven: str, values: Array) -> Axis:
    """Abscissa of a record: time if it has a clock and many holds (HELD), else the driven quantity."""
    still = np.abs(np.diff(values)) < NO_MOTION * max(float(np.ptp(values)), 1e-300)
    if np.isfinite(time).all() and still.size and still.mean() > HELD:
        return {"axis": "time [s]", "x": time}
    return {"axis": driven, "x": values}
