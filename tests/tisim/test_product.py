"""Products with the whole matrix of a pattern, against a dense one."""

from __future__ import annotations

import numpy as np
import pytest

from tisim.linear.blocks import FullMatrix, pattern_of


def test_triangle_and_unsymmetric_pairs_make_the_dense_matrix() -> None:
    rng = np.random.default_rng(1)
    nodes = 7
    conn = np.array([[0, 1, 2, 3], [2, 3, 4, 5], [4, 5, 6, 6]], dtype=np.int32)  # the last repeats a node
    pattern = pattern_of(conn, nodes, np.array([3], dtype=np.int32))
    n = len(pattern.free)
    blocks = rng.standard_normal((pattern.n_blocks, 3, 3))
    rows = np.repeat(np.arange(n), np.diff(pattern.indptr))
    own = np.flatnonzero(rows == pattern.indices)
    blocks[own] += blocks[own].transpose(0, 2, 1).copy()
    dense = np.zeros((n, 3, n, 3))
    for r, c, block in zip(rows, pattern.indices, blocks, strict=True):
        dense[c, :, r] = block.T
        dense[r, :, c] = block
    facets = np.array([[0, 1, 2, 3], [5, 4, 6, 6]], dtype=np.int32)
    more = rng.standard_normal((2, 4, 4, 3, 3))
    full = FullMatrix(pattern, facets)
    assert full.filled(blocks).toarray() == pytest.approx(dense.reshape(3 * n, 3 * n))
    for f, a, b in np.ndindex(2, 4, 4):
        i, j = pattern.index[facets[f, a]], pattern.index[facets[f, b]]
        if min(i, j) >= 0:
            dense[i, :, j] += more[f, a, b]
    assert full.filled(blocks, more).toarray() == pytest.approx(dense.reshape(3 * n, 3 * n))
