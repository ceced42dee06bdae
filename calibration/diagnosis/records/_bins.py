"""Thinning: neighbouring points of a branch are averaged where there are many."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def bins(points: slice, most: int) -> tuple[NDArray[np.intp], Array]:
    """First points of at most `most` bins, counted from the slice's first, and how many are in each."""
    size = points.stop - points.start
    first = np.unique(np.linspace(0, size, min(size, most), endpoint=False).astype(np.intp))
    return first, np.diff(np.append(first, size)).astype(float)
