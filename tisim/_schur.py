"""Static condensation: what is left of a symmetric block matrix on a few of its nodes (Schur's complement).

PARDISO forms the complement as it factorises, for little more than the factorisation; SciPy, where MKL is
absent, by as many solves as there are columns.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from tisim._linear import HAVE_PARDISO, LinearSolveError

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class Condensation:
    """K over rows F and I, in blocks of 3 (upper triangle, BSR): the rows F eliminated.

    kept (n,): True for the rows I.
    """

    def __init__(self, indptr: Ints, indices: Ints, kept: NDArray[np.bool_]) -> None:
        n, nb = len(indptr) - 1, len(indices)
        self._kept = np.repeat(kept, 3)
        places = np.arange(1, 9 * nb + 1, dtype=np.float64).reshape(nb, 3, 3)
        scalar = sparse.triu(sparse.bsr_matrix((places, indices, indptr), shape=(3 * n, 3 * n))).tocsr()
        scalar.sort_indices()
        self._take = scalar.data.astype(np.int64) - 1
        self._shape = (3 * n, 3 * n)
        self._indptr, self._indices = scalar.indptr.astype(np.int32), scalar.indices.astype(np.int32)
        self._pardiso: Any = None
        self._lu: Any = None
        self._coupling: Any = None

    def factorise(self, blocks: Array) -> NDArray[np.float32]:
        """blocks (nb, 3, 3) -> S = K_II - K_IF K_FF^-1 K_FI, shape (3 ni, 3 ni). LinearSolveError."""
        values = blocks.ravel()[self._take]
        if not HAVE_PARDISO:
            return self._by_solves(values)
        from tisim._pardiso import FactorisationError, PardisoSchur

        if self._pardiso is None:
            self._pardiso = PardisoSchur(self._indptr, self._indices, self._kept)
        try:
            complement = self._pardiso.factorise(values)
        except FactorisationError as error:
            raise LinearSolveError(str(error)) from None
        return np.asarray(complement)

    def _by_solves(self, values: Array) -> NDArray[np.float32]:
        upper = sparse.csr_matrix((values, self._indices, self._indptr), shape=self._shape)
        full = (upper + sparse.triu(upper, 1).T).tocsr()
        inner, outer = np.flatnonzero(~self._kept), np.flatnonzero(self._kept)
        self._coupling = full[inner][:, outer].tocsr()
        try:
            self._lu = splu(
                full[inner][:, inner].tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise LinearSolveError(str(error)) from None
        eliminated = self._coupling.T @ self._lu.solve(self._coupling.toarray())
        return np.asarray(full[outer][:, outer].toarray() - eliminated, dtype=np.float32)

    def reduce(self, rhs: Array) -> Array:
        """K_IF K_FF^-1 rhs_F, shape (3 ni,); rhs (n, 3), of which the rows I are not looked at."""
        b = rhs.ravel().copy()
        b[self._kept] = 0.0
        if self._pardiso is not None:
            return -np.asarray(self._pardiso.forward(b))[self._kept]
        return np.asarray(self._coupling.T @ self._lu.solve(b[~self._kept]))

    def expand(self, rhs: Array, kept: Array) -> Array:
        """x (n, 3) with x_I = kept (3 ni,) and K_FF x_F = rhs_F - K_FI x_I."""
        b = rhs.ravel().copy()
        if self._pardiso is not None:
            b[self._kept] = 0.0
            b = self._pardiso.forward(b)
            b[self._kept] = kept
            return np.asarray(self._pardiso.backward(b)).reshape(-1, 3)
        x = np.empty_like(b)
        x[self._kept] = kept
        x[~self._kept] = self._lu.solve(b[~self._kept] - self._coupling @ kept)
        return x.reshape(-1, 3)
