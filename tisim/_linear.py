"""Direct solution with a symmetric block matrix: PARDISO, or SciPy's SuperLU where MKL is absent."""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
HAVE_PARDISO = importlib.util.find_spec("pypardiso") is not None


class LinearSolveError(RuntimeError):
    """The linear system could not be factorised."""


class DirectSolver:
    """Factorises block matrices of one sparsity (upper triangle, BSR); analysis is done once.

    single: factorise in single precision, for use as a preconditioner (PARDISO only).
    positive: refuse matrices that are not positive definite (PARDISO only).
    negative: number of negative pivots of the last factor (0 where SuperLU cannot tell).
    """

    def __init__(
        self,
        indptr: NDArray[np.int32],
        indices: NDArray[np.int32],
        *,
        single: bool = False,
        positive: bool = False,
    ) -> None:
        self._indptr, self._indices = indptr, indices
        self._single, self._positive = single, positive
        self._pardiso: Any = None
        self._lu: Any = None
        self.negative = 0

    def factorise(self, blocks: Array) -> None:
        """blocks: (nb, 3, 3). Raises LinearSolveError."""
        if not HAVE_PARDISO:
            upper = sparse.bsr_matrix((blocks, self._indices, self._indptr)).tocsr()
            full = sparse.triu(upper) + sparse.triu(upper, 1).T
            try:
                self._lu = splu(full.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
            except RuntimeError as error:
                raise LinearSolveError(str(error)) from None
            return
        from tisim._pardiso import FactorisationError, Pardiso

        if self._pardiso is None:
            self._pardiso = Pardiso(self._indptr, self._indices, single=self._single, positive=self._positive)
        try:
            self._pardiso.factorise(blocks)
        except FactorisationError as error:
            raise LinearSolveError(str(error)) from None
        self.negative = self._pardiso.negative

    def solve(self, rhs: Array) -> Array:
        """rhs (n, 3) -> (n, 3), with the last factor."""
        if self._pardiso is not None:
            return np.asarray(self._pardiso.solve(rhs))
        return np.asarray(self._lu.solve(rhs.ravel())).reshape(-1, 3)
