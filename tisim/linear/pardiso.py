"""MKL PARDISO on symmetric block matrices, with the library that pypardiso installs.

pypardiso's own interface takes scalar CSR matrices and one precision; blocks of three make the analysis
three times cheaper, and single precision halves the factorisation.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_ANALYSE, _FACTOR, _SOLVE, _RELEASE = 11, 22, 33, -1
_FORWARD, _BACKWARD = 331, 333
_TYPE = -2  # real and symmetric, indefinite: LDL^T


class FactorisationError(RuntimeError):
    """The matrix could not be factorised."""


def _library() -> Any:
    # Otherwise MKL may take different code paths for different memory alignments, and results would differ
    # in their bytes. MKL reads the variable at its first call.
    os.environ.setdefault("MKL_CBWR", "AUTO,STRICT")
    path = _file_of_mkl()
    if path is None:
        from pypardiso import PyPardisoSolver

        lib = PyPardisoSolver().libmkl
    else:
        lib = ctypes.CDLL(path)
    lib.MKL_Set_Num_Threads(ctypes.c_int(1))  # one core per scene, see tisim.kernels._taichi
    return lib["pardiso"]  # a separate function object: pypardiso has typed its own for CSR


def _file_of_mkl() -> str | None:
    """Path of MKL's library from its package's file list; None if there is none or the user specified one.

    pypardiso searches the whole environment for it, twice, which takes 0.8 s in each new process.
    """
    if "PYPARDISO_MKL_RT" in os.environ:
        return None
    try:
        files = metadata.files("mkl") or []
    except metadata.PackageNotFoundError:
        return None
    found = [f.locate() for f in files if "mkl_rt" in f.name]
    return next((str(path) for path in found if Path(path).is_file()), None)


class Pardiso:
    """A symmetric matrix of 3 x 3 blocks, upper triangle in BSR form: analysed once, factorised often.

    Parameters
    ----------
    indptr, indices : ndarray of int32
        BSR structure.
    single : bool
        Factorise in single precision (as a preconditioner).

    Attributes
    ----------
    negative : int
        Number of negative pivots of the last LDL^T.
    """

    _function: Any = None

    def __init__(
        self,
        indptr: NDArray[np.int32],
        indices: NDArray[np.int32],
        *,
        single: bool = False,
    ) -> None:
        if Pardiso._function is None:
            Pardiso._function = _library()
        self._dtype = np.float32 if single else np.float64
        self._n = len(indptr) - 1
        self._ia = np.ascontiguousarray(indptr, dtype=np.int32)
        self._ja = np.ascontiguousarray(indices, dtype=np.int32)
        self._pt = np.zeros(64, dtype=np.int64)
        self._iparm = np.zeros(64, dtype=np.int32)
        self._iparm[0] = 1  # no defaults
        self._iparm[1] = 2  # nested dissection
        self._iparm[7] = 0  # no refinement: the caller iterates in double precision
        self._iparm[9] = 8  # perturb pivots below 1e-8
        self._iparm[20] = 1  # Bunch-Kaufman pivots
        self._iparm[27] = int(single)
        self._iparm[34] = 1  # zero-based, so that blocks are row-major
        self._iparm[36] = 3  # block size
        self._values = np.zeros(len(indices) * 9, dtype=self._dtype)
        self._order = np.zeros(1, dtype=np.int32)
        self._analysed = False
        self.negative = 0

    def factorise(self, values: NDArray[np.float64]) -> None:
        """Factorise blocks (nb, 3, 3); FactorisationError if that fails."""
        self._values[:] = values.ravel()
        if not self._analysed:
            self._call(_ANALYSE)
            self._analysed = True
        self._call(_FACTOR)
        self.negative = int(self._iparm[22])

    def solve(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Solution (n, 3) for rhs (n, 3)."""
        b: NDArray[Any] = np.ascontiguousarray(rhs, dtype=self._dtype).ravel()
        x = np.zeros_like(b)
        self._call(_SOLVE, b, x)
        return x.astype(np.float64).reshape(-1, 3)

    def _call(self, phase: int, b: NDArray[Any] | None = None, x: NDArray[Any] | None = None) -> None:
        dummy: NDArray[Any] = np.zeros(1, dtype=self._dtype)
        error = ctypes.c_int(0)

        def integer(value: int) -> object:
            return ctypes.byref(ctypes.c_int(value))

        def pointer(array: NDArray[Any]) -> ctypes.c_void_p:
            return array.ctypes.data_as(ctypes.c_void_p)

        assert Pardiso._function is not None
        Pardiso._function(
            pointer(self._pt), integer(1), integer(1), integer(_TYPE), integer(phase),
            integer(self._n), pointer(self._values), pointer(self._ia), pointer(self._ja),
            pointer(self._order), integer(1), pointer(self._iparm), integer(0),
            pointer(dummy if b is None else b), pointer(dummy if x is None else x), ctypes.byref(error),
        )  # fmt: skip
        if error.value != 0:
            raise FactorisationError(f"PARDISO phase {phase} returned error {error.value}")

    def __del__(self, finalizing: Callable[[], bool] = sys.is_finalizing) -> None:
        # when the interpreter ends, the process frees the memory, and modules (sys, ctypes) may be gone
        if getattr(self, "_analysed", False) and not finalizing():
            self._call(_RELEASE)


class PardisoSchur(Pardiso):
    """Schur complement of a symmetric matrix, in single precision.

    A solve consists of `forward` and `backward`; the caller solves for the kept rows in between.

    Parameters
    ----------
    indptr, indices : ndarray of int32
        Scalar CSR structure, upper triangle (PARDISO has no Schur complements of block matrices).
    kept : ndarray of bool
        Rows that are kept.
    """

    def __init__(
        self, indptr: NDArray[np.int32], indices: NDArray[np.int32], kept: NDArray[np.bool_]
    ) -> None:
        super().__init__(indptr, indices, single=True)
        self._iparm[35] = 2  # the complement, and factors for partial solves
        self._iparm[36] = 0
        self._values = np.zeros(len(indices), dtype=self._dtype)
        self._order = np.ascontiguousarray(kept, dtype=np.int32)
        self._left = int(kept.sum())

    def factorise(self, values: NDArray[np.float64]) -> NDArray[np.float32]:  # type: ignore[override]
        """Schur complement, shape (kept, kept), of the matrix with values (nnz,)."""
        self._values[:] = values
        if not self._analysed:
            self._call(_ANALYSE)
            self._analysed = True
        complement = np.zeros((self._left, self._left), dtype=self._dtype)
        self._call(_FACTOR, None, complement)
        return complement

    def forward(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forward substitution L^-1 rhs (n,); its kept rows are rhs_I - K_IF K_FF^-1 rhs_F."""
        return self._half(_FORWARD, rhs)

    def backward(self, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Backward substitution (n,), with the kept rows unchanged."""
        return self._half(_BACKWARD, rhs)

    def _half(self, phase: int, rhs: NDArray[np.float64]) -> NDArray[np.float64]:
        b: NDArray[Any] = np.ascontiguousarray(rhs, dtype=self._dtype)
        x = np.zeros_like(b)
        self._call(phase, b, x)
        return x.astype(np.float64)
