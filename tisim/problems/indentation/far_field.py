"""The near part of a block, the far tissue condensed on the interface to it, and a drag on its nodes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import DiscretisedBody
from tisim.linear.blocks import FullMatrix, Pattern, distinct
from tisim.linear.krylov import FactorGMRES

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Part:
    """A subset of a block's elements as a separate system.

    Attributes
    ----------
    body : the elements with the material.
    linear : linear solver.
    full : sparse matrix of the tangent.
    slot : positions of the facets' node pairs in the tangent, shape (f, a, a).
    """

    body: DiscretisedBody
    linear: FactorGMRES
    full: FullMatrix
    slot: NDArray[np.int32]


class FarField:
    """Far tissue, linearised about the positions at which it was placed.

    The stiffness couples all interface nodes, and the factorised matrix (`joined`, in the order of
    `factor_pattern`) has all of it: with neighbouring pairs alone, stable tissue would appear unstable and
    each step would be restricted.

    Parameters
    ----------
    nodes : ndarray of int, shape (n,)
        Nodes of the interface.
    pattern : Pattern
        Sparsity of the near tissue.
    """

    def __init__(self, nodes: Ints, pattern: Pattern) -> None:
        self.nodes = nodes
        self.rows = pattern.index[nodes]
        self.factor_pattern, self._of_near, self._of_pairs = _with_all_pairs(pattern, self.rows)
        self._pairs = np.triu_indices(len(nodes))
        self._alone = np.zeros((self.factor_pattern.n_blocks, 3, 3))
        self._joined = np.empty_like(self._alone)

    def set_stiffness(self, stiffness: Singles) -> None:
        """Set the symmetric stiffness (3 n, 3 n) [N/m]."""
        n = len(self.nodes)
        i, j = self._pairs
        self._stiffness = stiffness
        self._alone[self._of_pairs] = stiffness.reshape(n, 3, n, 3)[i, :, j]

    def joined(self, blocks: Array) -> Array:
        """Blocks of the near tangent plus those of the stiffness, in the order of `factor_pattern`.

        They are valid until the next call.
        """
        self._joined[:] = self._alone
        self._joined[self._of_near] += blocks
        return self._joined

    def place(self, x: Array, force: Array) -> None:
        """Linearise about x, where the far tissue exerts force (n, 3) [N] with its inner nodes at rest."""
        self._origin = x[self.nodes]
        self._force = force

    def add_to(self, force: Array, x: Array) -> float:
        """Add the far tissue's forces at x to force (nodes of the block, 3) [N]; return its energy [J]."""
        d = (x[self.nodes] - self._origin).ravel()
        elastic = (self._stiffness @ d.astype(np.float32)).astype(np.float64)
        force[self.nodes] += self._force + elastic.reshape(-1, 3)
        return float(d @ (self._force.ravel() + 0.5 * elastic))

    def add_product(self, v: Array, out: Array) -> None:
        """Add the stiffness times v to out, both of shape (3 n_free,) over the near tissue."""
        product = self._stiffness @ v.reshape(-1, 3)[self.rows].astype(np.float32).ravel()
        out.reshape(-1, 3)[self.rows] += product.reshape(-1, 3)


class Forces(NamedTuple):
    """Internal forces (n, 3) [N], energy [J] and smallest det F at some positions."""

    force: Array
    energy: float
    min_jacobian: float


class ElasticForces:
    """Internal forces of a body's elements and of the far tissue; those of the last two states are kept.

    An accepted trial is evaluated again, and a search returns to the second-last trial if the last is no
    better. States are compared by identity.
    """

    def __init__(self, body: DiscretisedBody, far: FarField | None = None) -> None:
        self._body, self._far = body, far
        self._known: list[tuple[Array, Forces, Forces]] = []

    def forget(self) -> None:
        """Forget the forces known: the material's history or the elements' weights have changed."""
        self._known = []

    def know(self, x: Array, elements: Forces) -> None:
        """Keep the forces of the elements at x (n, 3), computed elsewhere."""
        whole = elements
        if self._far is not None:
            force = elements.force.copy()
            whole = Forces(force, elements.energy + self._far.add_to(force, x), elements.min_jacobian)
        self._known = [(x, elements, whole), *self._known[:1]]

    def at(self, x: Array) -> Forces:
        """Forces at x (n, 3), with those of the far tissue."""
        return self._state(x)[2]

    def of_elements(self, x: Array) -> Forces:
        """Forces at x (n, 3) of the elements alone."""
        return self._state(x)[1]

    def _state(self, x: Array) -> tuple[Array, Forces, Forces]:
        for known in self._known:
            if known[0] is x:
                return known
        self.know(x, Forces(*self._body.forces_and_energy(x)))
        return self._known[0]


def _with_all_pairs(pattern: Pattern, rows: Ints) -> tuple[Pattern, Ints, Ints]:
    """Pattern with all pairs of `rows` added; positions in it of the pattern's blocks and of the pairs."""
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


@dataclass(frozen=True, eq=False)
class Drag:
    """Resistance to motion: one implicit step of a viscous motion, stiffness = viscosity / step length.

    Attributes
    ----------
    start : positions at the start of the step [m], shape (n, 3).
    stiffness : stiffness at each node [N/m], shape (n,).
    """

    start: Array
    stiffness: Array

    def energy(self, x: Array) -> float:
        return 0.5 * float(self.stiffness @ ((x - self.start) ** 2).sum(axis=1))

    def forces(self, x: Array) -> Array:
        found: Array = self.stiffness[:, None] * (x - self.start)
        return found
