"""Sparsity of the stiffness matrix in 3 x 3 blocks over the nodes that may move (upper triangle)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Pattern:
    """Upper block triangle in BSR form.

    free: indices of the nodes that may move, shape (n,). index: node -> row of the matrix, or -1.
    indptr (n + 1), indices (nb): block columns in ascending order, the diagonal block first.
    slot (m, a, b): where element m's pair of nodes goes, see `tisim._kernels`.
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


def build(conn: Ints, n_nodes: int, fixed: Ints) -> Pattern:
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
    keys = np.unique(low * len(free) + high)
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
