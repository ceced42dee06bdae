"""Symmetric matrices of 3 x 3 blocks over the free nodes: sparsity, and matrices for products.

Only the upper triangle is stored. Products use the whole matrix, including an unsymmetric part.
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
    """Sparsity of an upper block triangle in BSR form.

    Attributes
    ----------
    free : indices of the free nodes, shape (n,).
    index : row of each node in the matrix, or -1, shape (n_nodes,).
    indptr, indices : BSR structure, shapes (n + 1,) and (nb,); columns ascend, the diagonal block is first.
    slot : position of each pair of an element's nodes, see `tisim.kernels.elements`, shape (m, a, a).
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
        """Slots of other node lists `conn` (f, a), such as contact facets, whose pairs are in the pattern."""
        return _slots(self.index, self.indptr, self.indices, conn)

    def diagonal(self, blocks: NDArray[np.float64]) -> NDArray[np.float64]:
        """Diagonal of the matrix of blocks (nb, 3, 3), shape (n, 3)."""
        return blocks[self.indptr[:-1]][:, [0, 1, 2], [0, 1, 2]]


def distinct(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """Distinct keys in ascending order; sorting takes a tenth of the time of the hashes of `np.unique`."""
    ordered = np.sort(keys)
    first = np.ones(len(ordered), dtype=bool)
    np.not_equal(ordered[1:], ordered[:-1], out=first[1:])
    return ordered[first]


def pattern_of(conn: Ints, n_nodes: int, fixed: Ints) -> Pattern:
    """Pattern of elements `conn` (m, a) without the nodes `fixed`."""
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
    # repeated nodes (wedges) are paired off the element's diagonal: add the block and its transpose
    diagonal = np.eye(conn.shape[1], dtype=bool)[None]
    mode = np.where(i > j, 1, np.where((i == j) & ~diagonal, 2, 0))
    return np.ascontiguousarray(np.where(low < 0, -1, 4 * block + mode), dtype=np.int32)


class FullMatrix:
    """Fills a sparse matrix over all blocks of a pattern, for products without a kernel launch.

    Parameters
    ----------
    pattern : Pattern
    conn : ndarray of int, shape (m, a)
        Node lists (contact facets) whose pairs may have additional unsymmetric blocks.
    """

    def __init__(self, pattern: Pattern, conn: Ints) -> None:
        n, nb = len(pattern.free), pattern.n_blocks
        rows = np.repeat(np.arange(n), np.diff(pattern.indptr))
        off = np.flatnonzero(rows != pattern.indices)
        row = np.concatenate([rows, pattern.indices[off]])
        col = np.concatenate([pattern.indices, rows[off]])
        order = np.lexsort((col, row))
        keys = row[order].astype(np.int64) * n + col[order]
        # rows of all blocks, followed by all of them transposed
        self._source = np.concatenate([np.arange(nb), nb + off])[order]
        self._both, self._data = np.empty((2 * nb, 3, 3)), np.empty((len(order), 3, 3))
        self._indptr = np.zeros(n + 1, dtype=np.int32)
        np.cumsum(np.bincount(row, minlength=n), out=self._indptr[1:])
        self._indices = col[order].astype(np.int32)
        self._shape = (3 * n, 3 * n)
        at = pattern.index[conn].astype(np.int64)
        i, j = at[:, :, None], at[:, None, :]
        there = (i >= 0) & (j >= 0)
        self._place = np.where(there, np.searchsorted(keys, np.where(there, i * n + j, 0)), -1)

    def filled(self, blocks: Array, more: Array | None = None) -> sparse.bsr_matrix:
        """Matrix of blocks (nb, 3, 3) of the upper triangle, plus `more` (m, a, a, 3, 3) by node pair.

        It is valid until the next call: new memory for each matrix costs more than the values in it.
        """
        nb = len(blocks)
        self._both[:nb], self._both[nb:] = blocks, blocks.transpose(0, 2, 1)
        data = self._data
        np.take(self._both, self._source, axis=0, out=data, mode="clip")
        if more is not None:
            some = (self._place >= 0) & more.any(axis=(3, 4))
            np.add.at(data, self._place[some], more[some])
        return sparse.bsr_matrix((data, self._indices, self._indptr), shape=self._shape)
