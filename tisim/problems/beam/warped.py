"""The factor of an earlier tangent, rotated with the body."""

from __future__ import annotations

from copy import copy
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from tisim.discretisation.body import Discretisation, DiscretisedBody

Array = NDArray[np.float64]


@lru_cache(maxsize=4)
def _gradient_operator(discretisation: Discretisation) -> tuple[Array, sparse.csr_array]:
    """Mean shape-function gradients of elements (m, a, 3) [1/m], and the averaging over a node's elements."""
    mesh, ref = discretisation.mesh, discretisation.reference
    volume = ref.weights.sum(axis=1)
    mean = np.einsum("mq,mqak->mak", ref.weights, ref.gradients) / volume[:, None, None]
    m, a = mesh.elements.shape
    rows, columns = mesh.elements.ravel(), np.repeat(np.arange(m), a)
    around = sparse.csr_array((volume[columns], (rows, columns)), shape=(mesh.n_nodes, m))
    around = around[discretisation.pattern.free]
    return mean, sparse.csr_array(sparse.diags_array(1.0 / around.sum(axis=1)) @ around)


class Warped:
    """The last factor of a beam's tangent K_0, rotated with the body: K = R K_0 R^T, R the nodal rotations.

    Factorising a tangent costs about as much as fifteen solves. In creep the stiffness of the material hardly
    changes from one step to the next, but parts of the beam rotate, and with them the directions in which the
    bulk modulus resists.

    A body on the same discretisation that differs by a factor of the stiffness has the same factor but for a
    scale (`of`). The factor is the discretisation's: it is lost when another tangent is factorised on it.
    """

    def __init__(self, body: DiscretisedBody, x: Array) -> None:
        self._discretisation = discretisation = body.discretisation
        self._modulus, self._softer = body.moduli.shear_modulus, 1.0
        self._mean, self._around = _gradient_operator(discretisation)
        self._at_factor = np.linalg.inv(self._gradients(x))
        self._turned = np.broadcast_to(np.eye(3), (len(discretisation.pattern.free), 3, 3))

    def _gradients(self, x: Array) -> Array:
        """Mean deformation gradient around each free node, shape (n_free, 3, 3)."""
        F = x[self._discretisation.mesh.elements].transpose(0, 2, 1) @ self._mean
        return np.asarray(self._around @ F.reshape(len(F), 9)).reshape(-1, 3, 3)

    def of(self, body: DiscretisedBody) -> Warped:
        """The factor scaled to another body's shear modulus."""
        it = copy(self)
        it._softer = self._modulus / body.moduli.shear_modulus
        return it

    def turn(self, x: Array) -> None:
        """Rotate the factor to positions x (n, 3) [m]."""
        moved = self._gradients(x) @ self._at_factor
        skew = 0.5 * (moved - moved.transpose(0, 2, 1))
        axis = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
        sine = np.minimum(np.linalg.norm(axis, axis=1), 1.0)[:, None, None]
        # Rodrigues: I + K + K^2 (1 - cos)/sin^2, K = skew
        self._turned = np.eye(3) + skew + skew @ skew / (1.0 + np.sqrt(1.0 - sine**2))

    def solve(self, rhs: Array) -> Array:
        """(R K_0 R^T)^-1 rhs, shapes (n_free, 3)."""
        R = self._turned
        back = np.einsum("nji,nj->ni", R, rhs)
        held = self._discretisation.held
        back[held] = 0.0
        found: Array = self._softer * np.einsum("nij,nj->ni", R, self._discretisation.solver.solve(back))
        found[held] = 0.0
        return found
