"""The far field as a spring: its force is its energy's derivative, and the factor contains its stiffness."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import bsr_matrix

from tisim.linear.blocks import Pattern, pattern_of
from tisim.problems.indentation.far_field import FarField

Array = NDArray[np.float64]
NODES = 12
FREE_ROWS = 9


def field(rng: np.random.Generator) -> tuple[FarField, Array, NDArray[np.int32]]:
    """Far field on the last five nodes of a chain, its stiffness, and the rows of these nodes."""
    conn = np.array([[k, k + 1] for k in range(NODES - 1)], dtype=np.int32)
    pattern = pattern_of(conn, NODES, np.array([0, 1, 2], dtype=np.int32))
    nodes = np.arange(7, 12, dtype=np.int32)
    it = FarField(nodes, pattern)
    root = rng.standard_normal((15, 15))
    stiffness = (root @ root.T + np.eye(15)).astype(np.float32)
    it.set_stiffness(stiffness)
    return it, stiffness.astype(float), pattern.index[nodes]


def test_force_is_the_slope_of_the_energy() -> None:
    rng = np.random.default_rng(6)
    it, stiffness, _ = field(rng)
    x0, dead = rng.standard_normal((NODES, 3)), rng.standard_normal((5, 3))
    it.place(x0, dead)
    force = np.zeros((NODES, 3))
    assert it.add_to(force, x0) == 0.0
    assert force[7:] == pytest.approx(dead)
    assert not force[:7].any()
    x, way = x0 + rng.standard_normal((NODES, 3)), rng.standard_normal((NODES, 3))
    force = np.zeros((NODES, 3))
    it.add_to(force, x)
    assert force[7:] == pytest.approx(dead + (stiffness @ (x - x0)[7:].ravel()).reshape(-1, 3), rel=1e-5)
    step = 1e-2
    up, down = (it.add_to(np.zeros((NODES, 3)), x + sign * step * way) for sign in (1, -1))
    assert (up - down) / (2 * step) == pytest.approx(float(np.vdot(force, way)), rel=1e-3)


def _dense(pattern: Pattern, blocks: Array) -> Array:
    """Full symmetric matrix from the blocks of its upper triangle."""
    n = len(pattern.indptr) - 1
    upper = bsr_matrix((blocks, pattern.indices, pattern.indptr), shape=(3 * n, 3 * n)).toarray()
    triangle = np.triu(np.ones((n, n)), 1).repeat(3, axis=0).repeat(3, axis=1)
    whole: Array = upper + (upper * triangle).T
    return whole


def test_the_factor_has_near_and_far_tissue_and_so_have_products() -> None:
    rng = np.random.default_rng(7)
    it, stiffness, rows = field(rng)
    conn = np.array([[k, k + 1] for k in range(NODES - 1)], dtype=np.int32)
    pattern = pattern_of(conn, NODES, np.array([0, 1, 2], dtype=np.int32))
    blocks = rng.standard_normal((pattern.n_blocks, 3, 3))
    diagonal = pattern.indptr[:-1]
    blocks[diagonal] += blocks[diagonal].transpose(0, 2, 1)
    at = (3 * rows[:, None] + np.arange(3)).ravel()
    expected = _dense(pattern, blocks)
    expected[np.ix_(at, at)] += stiffness
    assert _dense(it.factor_pattern, it.joined(blocks)) == pytest.approx(expected, rel=1e-6, abs=1e-6)
    out, v = np.zeros(3 * FREE_ROWS), rng.standard_normal(3 * FREE_ROWS)
    it.add_product(v, out)
    assert _dense(pattern, blocks) @ v + out == pytest.approx(expected @ v, rel=1e-5)


def test_the_factors_pattern_keeps_what_the_pattern_says_of_the_diagonal() -> None:
    it, _, _ = field(np.random.default_rng(8))
    whole = it.factor_pattern
    assert np.array_equal(whole.indices[whole.indptr[:-1]], np.arange(FREE_ROWS))
    row = np.repeat(np.arange(FREE_ROWS), np.diff(whole.indptr))
    assert (np.diff(row * FREE_ROWS + whole.indices) > 0).all()
