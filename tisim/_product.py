"""Products with a block matrix that is stored by its upper triangle, and with what makes it unsymmetric."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from tisim._pattern import Pattern

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class FullMatrix:
    """Fills a sparse matrix over all blocks of a pattern, for products without a kernel's launch.

    conn (m, a): node lists (contact facets) whose pairs may have blocks of their own, without symmetry.
    """

    def __init__(self, pattern: Pattern, conn: Ints) -> None:
        n, nb = len(pattern.free), pattern.n_blocks
        rows = np.repeat(np.arange(n), np.diff(pattern.indptr))
        off = np.flatnonzero(rows != pattern.indices)
        row = np.concatenate([rows, pattern.indices[off]])
        col = np.concatenate([pattern.indices, rows[off]])
        order = np.lexsort((col, row))
        keys = row[order].astype(np.int64) * n + col[order]
        self._source = np.concatenate([np.arange(nb), off])[order]
        self._turned = np.flatnonzero(order >= nb)
        self._indptr = np.zeros(n + 1, dtype=np.int32)
        np.cumsum(np.bincount(row, minlength=n), out=self._indptr[1:])
        self._indices = col[order].astype(np.int32)
        self._shape = (3 * n, 3 * n)
        at = pattern.index[conn].astype(np.int64)
        i, j = at[:, :, None], at[:, None, :]
        there = (i >= 0) & (j >= 0)
        self._place = np.where(there, np.searchsorted(keys, np.where(there, i * n + j, 0)), -1)

    def filled(self, blocks: Array, more: Array | None = None) -> sparse.bsr_matrix:
        """blocks (nb, 3, 3) of the upper triangle; more (m, a, a, 3, 3), added by node pair."""
        data = blocks[self._source]
        data[self._turned] = data[self._turned].transpose(0, 2, 1)
        if more is not None:
            some = (self._place >= 0) & more.any(axis=(3, 4))
            np.add.at(data, self._place[some], more[some])
        return sparse.bsr_matrix((data, self._indices, self._indptr), shape=self._shape)
