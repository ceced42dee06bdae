"""What the tissue far from a rod does to the nodes at which the near tissue ends: a force and a stiffness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.linear.blocks import Pattern

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int32]

# The part of the norms of all blocks beyond the pattern that the factor has on its diagonal in their stead:
# the first with which what it has of the far tissue is positive, as all of the norms make any matrix
# (Gershgorin). Otherwise its inertia says that tissue is unstable which is not, and each step is held back.
# With 0.3 the spectrum of the one by the other lies within 0.03 to 1.2 (a poke at 7 mm; 0.003 to 5 where they
# are just left out).
SHARES = (0.3, 0.5, 0.7, 1.0)


class FarField:
    """Far tissue, linear about where its nodes were when it was placed.

    nodes (n,): the interface. pattern: of the near tissue, which holds pairs of neighbours among them only.
    The stiffness couples all of them: what is paired goes into the near tangent (`slots`, `paired`), the rest
    is applied in products (`add_unpaired`).
    """

    def __init__(self, nodes: Ints, pattern: Pattern) -> None:
        self.nodes = nodes
        self.rows = pattern.index[nodes]
        at = np.full(len(pattern.free), -1)
        at[self.rows] = np.arange(len(nodes))
        row = at[np.repeat(np.arange(len(pattern.free)), np.diff(pattern.indptr))]
        col = at[pattern.indices]
        self.slots = np.flatnonzero((row >= 0) & (col >= 0))
        self._i, self._j = row[self.slots], col[self.slots]

    def set_stiffness(self, stiffness: Singles) -> None:
        """stiffness (3 n, 3 n), symmetric [N/m]."""
        n = len(self.nodes)
        self._stiffness = stiffness
        rest = stiffness.copy()
        blocks = rest.reshape(n, 3, n, 3)  # a view
        i, j = self._i, self._j
        paired = blocks[i, :, j].astype(np.float64)
        blocks[i, :, j] = 0.0
        blocks[j, :, i] = 0.0
        size = np.sqrt(np.einsum("iajb,iajb->ij", blocks, blocks)).sum(axis=1, dtype=np.float64)
        own = np.arange(n)
        for share in SHARES:
            more = share * size[:, None, None] * np.eye(3)
            blocks[own, :, own] = -more
            if share == SHARES[-1] or _positive(stiffness - rest):
                break
        same = np.flatnonzero(i == j)
        paired[same] += more[i[same]]
        self.paired, self._rest = paired, rest

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

    def add_unpaired(self, v: Array, out: Array) -> None:
        """out += (the stiffness but what is `paired`) v, both (3 n_free,) over the near tissue."""
        product = self._rest @ v.reshape(-1, 3)[self.rows].astype(np.float32).ravel()
        out.reshape(-1, 3)[self.rows] += product.reshape(-1, 3)


def _positive(matrix: Singles) -> bool:
    """Whether a symmetric matrix is positive definite."""
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True
