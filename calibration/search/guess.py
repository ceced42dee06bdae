"""Where a search begins: the shear modulus by a scan, all other coordinates at their start."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.search.problem import Problem

Array = NDArray[np.float64]

LOWEST, HIGHEST = 1e3, 1e7  # of the coarse scan [Pa]


def guess(problem: Problem) -> Array | None:
    """Start u (n,) by two scans over the shear modulus, 9 values each; None where none has an answer.

    Give it a problem without mesh corrections: the guess need not be better than a few per cent.
    """
    p = problem.parametrisation
    shears = np.geomspace(LOWEST, HIGHEST, 9)
    best: Array | None = None
    for _ in range(2):
        starts = np.array([p.start(shear=g) for g in shears])
        # nuisances are taken at the stiffest: a small deflection always has an answer
        if not problem.linearise(starts[-1] if best is None else best):
            return None
        costs = problem.costs(starts)
        if not np.isfinite(costs).any():
            return None
        k = int(costs.argmin())
        best = starts[k]
        ratio = shears[1] / shears[0]
        shears = np.geomspace(shears[k] / ratio, shears[k] * ratio, 9)
    return best
