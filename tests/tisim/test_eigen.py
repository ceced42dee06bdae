"""Principal stretches: eigenvalues and eigenvectors of symmetric 3 x 3 matrices, also repeated ones."""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles the kernel; its annotations are meaningful to Taichi only)

import numpy as np
import pytest
from numpy.typing import NDArray

from tisim.kernels._taichi import ensure_runtime, f64, ti
from tisim.kernels.tensors import eigen_symmetric

Array = NDArray[np.float64]

# eigenvalues: distinct, two or three equal to within the given difference, small beside large
SPECTRA = [
    (0.2, 1.0, 3.0),
    (1.0, 1.0, 4.0),
    (1.0, 4.0, 4.0),
    (1.0, 1.0, 1.0),
    *((1.0, 1.0 + gap, 4.0) for gap in (1e-4, 1e-8, 1e-12, 1e-15)),
    *((1.0, 1.0 + gap, 1.0 + 2.0 * gap) for gap in (1e-4, 1e-8, 1e-12, 1e-15)),
    (1e-8, 1.0, 1e4),
    (1e-6, 2e-6, 1.0),
    (1.0, 1e4, 1e4 + 1e-6),
]


def decomposed(C: Array) -> tuple[Array, Array]:
    """Eigenvalues (n, 3) and eigenvectors (n, 3, 3), in columns, of matrices (n, 3, 3)."""
    ensure_runtime()
    _f3, _f2 = ti.types.ndarray(dtype=f64, ndim=3), ti.types.ndarray(dtype=f64, ndim=2)

    @ti.kernel
    def kernel(C: _f3, values: _f2, vectors: _f3):
        ti.loop_config(serialize=True)
        for n in range(C.shape[0]):
            M = ti.Matrix.zero(f64, 3, 3)
            for i in ti.static(range(3)):
                for k in ti.static(range(3)):
                    M[i, k] = C[n, i, k]
            lam, V = eigen_symmetric(M)
            for i in ti.static(range(3)):
                values[n, i] = lam[i]
                for k in ti.static(range(3)):
                    vectors[n, i, k] = V[i, k]

    values, vectors = np.empty(C.shape[:2]), np.empty(C.shape)
    kernel(np.ascontiguousarray(C), values, vectors)
    return values, vectors


def turned(spectrum: tuple[float, ...], n: int = 400) -> Array:
    """Matrices (n, 3, 3) of one spectrum: diagonal, with permuted axes, slightly and randomly rotated."""
    rng = np.random.default_rng(7)
    Q = np.linalg.qr(rng.standard_normal((n, 3, 3)))[0]
    Q[0] = np.eye(3)
    Q[1] = np.eye(3)[[2, 0, 1]]
    angle = 1e-9  # nearly along the axes
    Q[2] = [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    C: Array = np.einsum("nia,a,nka->nik", Q, spectrum, Q)
    return 0.5 * (C + C.transpose(0, 2, 1))


@pytest.mark.parametrize("spectrum", SPECTRA, ids=str)
def test_values_and_vectors_make_the_matrix_again(spectrum: tuple[float, ...]) -> None:
    C = turned(spectrum)
    values, vectors = decomposed(C)
    size = max(spectrum)
    again = np.einsum("nia,na,nka->nik", vectors, values, vectors)
    assert np.abs(again - C).max() < 5e-15 * size
    assert np.abs(vectors.transpose(0, 2, 1) @ vectors - np.eye(3)).max() < 5e-15
    assert np.abs(np.sort(values) - np.sort(spectrum)).max() < 5e-15 * size


def test_matrices_of_no_pattern() -> None:
    rng = np.random.default_rng(8)
    F = np.eye(3) + rng.standard_normal((20_000, 3, 3)) * rng.choice([1e-10, 1e-5, 1e-2, 1.0], (20_000, 1, 1))
    C = F.transpose(0, 2, 1) @ F
    values, vectors = decomposed(C)
    size = np.linalg.norm(C, axis=(1, 2))
    again = np.einsum("nia,na,nka->nik", vectors, values, vectors)
    assert (np.abs(again - C).max(axis=(1, 2)) < 4e-15 * size).all()
    assert np.abs(vectors.transpose(0, 2, 1) @ vectors - np.eye(3)).max() < 5e-15
    assert (np.abs(np.sort(values) - np.linalg.eigvalsh(C)).max(axis=1) < 4e-15 * size).all()
