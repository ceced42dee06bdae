"""Direct solution and static condensation of symmetric block matrices.

The factorisation is PARDISO's if pypardiso is installed, else that of SciPy's SuperLU. A condensation results
in a Schur complement on a few nodes. PARDISO forms it during factorisation at little extra cost, SciPy by one
solve per column.
"""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
HAVE_PARDISO = importlib.util.find_spec("pypardiso") is not None
Ints = NDArray[np.int32]


class LinearSolveError(RuntimeError):
    """The linear system could not be factorised."""


class DirectSolver:
    """Factorises block matrices of one sparsity (upper triangle, BSR); the analysis is done once.

    Parameters
    ----------
    indptr, indices : ndarray of int
        BSR structure.
    single : bool
        Factorise in single precision, for use as a preconditioner (PARDISO only).

    Attributes
    ----------
    negative : int
        Number of negative pivots of the last factor; always 0 with SuperLU.
    """

    def __init__(
        self,
        indptr: NDArray[np.int32],
        indices: NDArray[np.int32],
        *,
        single: bool = False,
    ) -> None:
        self._indptr, self._indices = indptr, indices
        self._single = single
        self._pardiso: Any = None
        self._lu: Any = None
        self.negative = 0

    def factorise(self, blocks: Array) -> None:
        """Factorise blocks (nb, 3, 3); LinearSolveError if that fails."""
        if not HAVE_PARDISO:
            upper = sparse.bsr_matrix((blocks, self._indices, self._indptr)).tocsr()
            full = sparse.triu(upper) + sparse.triu(upper, 1).T
            try:
                self._lu = splu(full.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
            except RuntimeError as error:
                raise LinearSolveError(str(error)) from None
            return
        from tisim.linear.pardiso import FactorisationError, Pardiso

        if self._pardiso is None:
            self._pardiso = Pardiso(self._indptr, self._indices, single=self._single)
        try:
            self._pardiso.factorise(blocks)
        except FactorisationError as error:
            raise LinearSolveError(str(error)) from None
        self.negative = self._pardiso.negative

    def solve(self, rhs: Array) -> Array:
        """Solution (n, 3) for rhs (n, 3) with the last factor."""
        if self._pardiso is not None:
            return np.asarray(self._pardiso.solve(rhs))
        return np.asarray(self._lu.solve(rhs.ravel())).reshape(-1, 3)


class Condensation:
    """Static condensation: K over rows F and I, in blocks of 3 (upper triangle, BSR), with rows F eliminated.

    Parameters
    ----------
    indptr, indices : ndarray of int
        BSR structure.
    kept : ndarray of bool, shape (n,)
        True for the rows I.
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
        """S = K_II - K_IF K_FF^-1 K_FI, shape (3 ni, 3 ni), of blocks (nb, 3, 3); LinearSolveError."""
        values = blocks.ravel()[self._take]
        if not HAVE_PARDISO:
            return self._by_solves(values)
        from tisim.linear.pardiso import FactorisationError, PardisoSchur

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

    def eliminate(self, rhs: Array) -> Array:
        """The rows F of rhs (n, 3) eliminated, shape (3 n,), for `passed_on` and `expand`; linear in rhs."""
        b = rhs.ravel().copy()
        b[self._kept] = 0.0
        if self._pardiso is not None:
            return np.asarray(self._pardiso.forward(b))
        b[~self._kept] = self._lu.solve(b[~self._kept])
        b[self._kept] = -(self._coupling.T @ b[~self._kept])
        return b

    def passed_on(self, eliminated: Array) -> Array:
        """K_IF K_FF^-1 rhs_F, shape (3 ni,)."""
        return -eliminated[self._kept]

    def expand(self, eliminated: Array, kept: Array) -> Array:
        """x (n, 3) with x_I = kept (3 ni,) and K_FF x_F = rhs_F - K_FI x_I."""
        x = eliminated.copy()
        x[self._kept] = kept
        if self._pardiso is not None:
            x = np.asarray(self._pardiso.backward(x))
        else:
            x[~self._kept] -= self._lu.solve(self._coupling @ kept)
        return x.reshape(-1, 3)
