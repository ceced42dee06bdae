"""Force and stiffness of the tissue far from a rod on the nodes at which the near tissue ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tisim.linear.blocks import Pattern, distinct

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int32]


class FarField:
    """Far tissue, linear about where its nodes were when it was placed.

    nodes (n,): the interface. pattern: of the near tissue. The stiffness couples all interface nodes, and
    all of it is in what is factorised (`joined`, in the order of `factor_pattern`): with pairs of neighbours
    alone tissue looks unstable which is not, and each step is held back.
    """

    def __init__(self, nodes: Ints, pattern: Pattern) -> None:
        self.nodes = nodes
        self.rows = pattern.index[nodes]
        self.factor_pattern, self._of_near, self._of_pairs = _with_all_pairs(pattern, self.rows)
        self._pairs = np.triu_indices(len(nodes))

    def set_stiffness(self, stiffness: Singles) -> None:
        """stiffness (3 n, 3 n), symmetric [N/m]."""
        n = len(self.nodes)
        i, j = self._pairs
        self._stiffness, self._blocks = stiffness, stiffness.reshape(n, 3, n, 3)[i, :, j]

    def joined(self, blocks: Array) -> Array:
        """Blocks of the near tangent and of the stiffness, in the order of `factor_pattern`."""
        whole = np.zeros((self.factor_pattern.n_blocks, 3, 3))
        whole[self._of_near] = blocks
        whole[self._of_pairs] += self._blocks
        return whole

    def place(self, x: Array, force: Array) -> None:
        """force (n, 3) [N]: of the far tissue at positions x, its inner nodes at rest."""
        self._origin = x[self.nodes]
        self._force = force

    def add_to(self, force: Array, x: Array) -> float:
        """Add its forces at x to force (nodes of the block, 3) [N]; returns its energy [J]."""
        d = (x[self.nodes] - self._origin).ravel()
        elastic = (self._stiffness @ d.astype(np.float32)).astype(np.float64)
        force[self.nodes] += self._force + elastic.reshape(-1, 3)
        return float(d @ (self._force.ravel() + 0.5 * elastic))

    def add_product(self, v: Array, out: Array) -> None:
        """out += the stiffness times v, both (3 n_free,) over the near tissue."""
        product = self._stiffness @ v.reshape(-1, 3)[self.rows].astype(np.float32).ravel()
        out.reshape(-1, 3)[self.rows] += product.reshape(-1, 3)


def _with_all_pairs(pattern: Pattern, rows: Ints) -> tuple[Pattern, Ints, Ints]:
    """The pattern with all pairs of some rows besides; where its blocks are there, and those of the pairs."""
    n = len(pattern.free)
    row = np.repeat(np.arange(n, dtype=np.int64), np.diff(pattern.indptr))
    own = row * n + pattern.indices
    a, b = np.triu_indices(len(rows))
    pairs = rows[a].astype(np.int64) * n + rows[b]
    keys = distinct(np.concatenate([own, pairs]))
    indptr = np.zeros(n + 1, dtype=np.int32)
    np.cumsum(np.bincount(keys // n, minlength=n), out=indptr[1:])
    whole = replace(pattern, indptr=indptr, indices=(keys % n).astype(np.int32), slot=pattern.slot[:0])
    return whole, np.searchsorted(keys, own).astype(np.int32), np.searchsorted(keys, pairs).astype(np.int32)
