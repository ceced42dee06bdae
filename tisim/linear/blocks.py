"""Symmetric matrices of 3 x 3 blocks over the nodes that may move: sparsity, and products.

Only the upper triangle is stored. Products are with the whole matrix, and with what makes it unsymmetric.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Ints = NDArray[np.int32]
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pattern:
    """Upper block triangle in BSR form.

    free: indices of the nodes that may move, shape (n,). index: node -> row of the matrix, or -1.
    indptr (n + 1), indices (nb): block columns in ascending order, the diagonal block first.
    slot (m, a, b): where element m's pair of nodes goes, see `tisim.kernels.elements`.
    """

    free: Ints
    index: Ints
    indptr: Ints
    indices: Ints
    slot: Ints

    @property
    def n_blocks(self) -> int:
        return len(self.indices)

    def slots(self, conn: Ints) -> Ints:
        """Slots of further element-like node lists (contact facets) whose pairs the pattern holds."""
        return _slots(self.index, self.indptr, self.indices, conn)


def distinct(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Keys (k,) in ascending order, each once; by sorting, in a tenth of the time of `np.unique`'s hashes."""
    ordered = np.sort(keys)
    first = np.ones(len(ordered), dtype=bool)
    np.not_equal(ordered[1:], ordered[:-1], out=first[1:])
    return ordered[first]


def pattern_of(conn: Ints, n_nodes: int, fixed: Ints) -> Pattern:
    """Pattern of elements `conn` (m, a) with the nodes `fixed` taken out."""
    moving = np.ones(n_nodes, dtype=bool)
    moving[fixed] = False
    used = np.zeros(n_nodes, dtype=bool)
    used[conn.ravel()] = True
    free = np.flatnonzero(moving & used).astype(np.int32)
    index = np.full(n_nodes, -1, dtype=np.int32)
    index[free] = np.arange(len(free), dtype=np.int32)
    rows = index[conn]
    a, b = np.triu_indices(conn.shape[1])
    i, j = rows[:, a].ravel(), rows[:, b].ravel()
    keep = (i >= 0) & (j >= 0)
    low, high = np.minimum(i, j)[keep].astype(np.int64), np.maximum(i, j)[keep].astype(np.int64)
    keys = distinct(low * len(free) + high)
    row, col = keys // len(free), keys % len(free)
    indptr = np.zeros(len(free) + 1, dtype=np.int32)
    np.cumsum(np.bincount(row, minlength=len(free)), out=indptr[1:])
    indices = col.astype(np.int32)
    return Pattern(free, index, indptr, indices, _slots(index, indptr, indices, conn))


def _slots(index: Ints, indptr: Ints, indices: Ints, conn: Ints) -> Ints:
    n = len(indptr) - 1
    rows = index[conn].astype(np.int64)
    i, j = rows[:, :, None], rows[:, None, :]
    low, high = np.minimum(i, j), np.maximum(i, j)
    keys = np.repeat(np.arange(n, dtype=np.int64), np.diff(indptr)) * n + indices
    block = np.searchsorted(keys, np.where(low < 0, 0, low * n + high))
    # repeated nodes (wedges) meet themselves off the element's diagonal: add the block and its transpose
    diagonal = np.eye(conn.shape[1], dtype=bool)[None]
    mode = np.where(i > j, 1, np.where((i == j) & ~diagonal, 2, 0))
    return np.ascontiguousarray(np.where(low < 0, -1, 4 * block + mode), dtype=np.int32)


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
