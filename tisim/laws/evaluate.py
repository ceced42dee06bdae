"""A law at given deformations, NumPy in and out: what the solver's kernels compute, for people and tests."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim import laws
from tisim._kernels import evaluation_kernel

Array = NDArray[np.float64]


def evaluate(law_name: str, parameters: laws.Parameters, F: ArrayLike) -> tuple[Array, Array, Array]:
    """Energy, stress and tangent of a law at deformation gradients F, shape (n, 3, 3).

    Returns psi (n,) [J/m3], zero at rest; first Piola-Kirchhoff stress P = dpsi/dF (n, 3, 3) [Pa]; tangent
    A_iKjL = d2psi / dF_iK dF_jL (n, 3, 3, 3, 3) [Pa], not projected. The whole law is meant, its volumetric
    part included.
    ValueError, in one sentence: unknown law, unsound parameters, wrong shape, or det F not positive.
    """
    law = laws.get(law_name)
    law.check(parameters)
    gradients = np.ascontiguousarray(F, dtype=np.float64)
    if gradients.ndim != 3 or gradients.shape[1:] != (3, 3):
        raise ValueError(f"F: expected shape (n, 3, 3), got {gradients.shape}")
    bad = ~(np.linalg.det(gradients) > 0.0)  # also where F is not finite
    if bad.any():
        raise ValueError(
            f"F: expected det F > 0, which fails for {int(bad.sum())} of {len(bad)},"
            f" first at index {bad.argmax()}"
        )
    n = len(gradients)
    psi, P, A = np.empty(n), np.empty((n, 3, 3)), np.empty((n, 9, 9))
    packed = np.ascontiguousarray(law.pack(parameters), dtype=np.float64)
    evaluation_kernel(law_name)(gradients, packed, law.kappa(parameters), psi, P, A)
    return psi, P, A.reshape(n, 3, 3, 3, 3)
