"""GMRES preconditioned by a factor, against dense solutions: other matrix, shift, unsymmetric part."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tisim.linear.blocks import pattern_of
from tisim.linear.krylov import SMALLEST_SHIFT, FactorGMRES

Array = NDArray[np.float64]
NODES = 6


def upper(matrix: Array) -> Array:
    """Blocks (nb, 3, 3) of the upper triangle of a full symmetric matrix, by rows."""
    blocks = matrix.reshape(NODES, 3, NODES, 3).transpose(0, 2, 1, 3)
    return np.ascontiguousarray(np.concatenate([blocks[i, i:] for i in range(NODES)]))


def positive(rng: np.random.Generator) -> Array:
    root = rng.standard_normal((3 * NODES, 3 * NODES))
    return np.asarray(root @ root.T + 3 * NODES * np.eye(3 * NODES))


@pytest.mark.parametrize("stiffened", [False, True])
def test_solution_is_that_of_the_dense_matrix(stiffened: bool) -> None:
    rng = np.random.default_rng(5)
    conn = np.arange(NODES, dtype=np.int32)[None]  # one element: every pair of nodes
    solver = FactorGMRES(pattern_of(conn, NODES, np.zeros(0, dtype=np.int32)))
    old, now = positive(rng), positive(rng)
    unsymmetric = rng.standard_normal((3 * NODES, 3 * NODES))
    rhs = rng.standard_normal((NODES, 3))

    first = solver.solve(upper(old), rhs, tolerance=1e-6, multiply=lambda v: old @ v)
    assert first.ravel() == pytest.approx(np.linalg.solve(old, rhs.ravel()), rel=1e-4, abs=1e-6)
    assert solver.iterations <= 2  # the factor is that of the matrix, in single precision

    def tangent(v: Array) -> Array:
        return np.asarray((now + unsymmetric) @ v)

    matrix = now + unsymmetric
    if stiffened:
        for _ in range(3):
            solver.stiffen()
        added = 64.0 * SMALLEST_SHIFT * np.abs(np.diag(now)).mean()
        matrix = matrix + np.eye(3 * NODES) * added
    took = [0]
    for tolerance in (3e-2, 1e-8):
        before = solver.iterations
        found = solver.solve(upper(now), rhs, tolerance=tolerance, multiply=tangent).ravel()
        left = np.linalg.norm(matrix @ found - rhs.ravel()) / np.linalg.norm(rhs)
        assert left < 1.01 * tolerance
        took.append(solver.iterations - before)
    assert 0 < took[1] < took[2]
    assert found == pytest.approx(np.linalg.solve(matrix, rhs.ravel()), rel=1e-5, abs=1e-7)
