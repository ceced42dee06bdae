"""Discrepancy basis: columns that represent a lack of fit which no effect of the catalogue causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Columns:
    """Named sets of columns (rows, k) over the rows of all records.

    Parameters
    ----------
    points : number of rows of each record.
    """

    def __init__(self, points: Sequence[int]) -> None:
        starts = np.cumsum([0, *points])
        self._size = int(starts[-1])
        self._rows = [slice(int(a), int(b)) for a, b in pairwise(starts)]
        self._sets: dict[str, list[Array]] = {}

    def add(self, name: str, parts: Sequence[tuple[int, Array]]) -> None:
        """Add a column to a set: values of some records (by index), zero elsewhere.

        A column of zeros is not added.
        """
        column = np.zeros(self._size)
        for k, values in parts:
            column[self._rows[k]] = values
        if column.any():
            self._sets.setdefault(name, []).append(column)

    def by_name(self) -> Mapping[str, Array]:
        return {name: np.column_stack(columns) for name, columns in self._sets.items()}


def legendre(x: Array, degree: int, span: tuple[float, float] | None = None) -> Array:
    """Legendre polynomial of x (k,), with `span` (default: the range of x) mapped to [-1, 1].

    It is constant beyond the span. On a span of zero length it is evaluated at 0.
    """
    low, high = span or (float(x.min(initial=np.inf)), float(x.max(initial=-np.inf)))
    unit = np.zeros(x.size) if not high > low else 2.0 * (np.clip(x, low, high) - low) / (high - low) - 1.0
    return np.asarray(np.polynomial.legendre.legval(unit, np.eye(degree + 1)[degree]))
