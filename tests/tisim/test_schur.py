"""Static condensation against dense algebra, with PARDISO and with SuperLU."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tisim.linear import direct
from tisim.linear.blocks import pattern_of
from tisim.linear.direct import Condensation, LinearSolveError

Array = NDArray[np.float64]
NODES = 9
KEPT = np.array([1, 4, 8])


def chained(rng: np.random.Generator) -> tuple[Condensation, Array, Array]:
    """Condensation of a chain of elements, its blocks, and the same matrix as a dense array."""
    conn = np.array([[k, k + 1, k + 2] for k in range(NODES - 2)], dtype=np.int32)
    pattern = pattern_of(conn, NODES, np.zeros(0, dtype=np.int32))
    blocks = rng.standard_normal((pattern.n_blocks, 3, 3))
    rows = np.repeat(np.arange(NODES), np.diff(pattern.indptr))
    own = np.flatnonzero(rows == pattern.indices)
    blocks[own] = blocks[own] + blocks[own].transpose(0, 2, 1) + 15 * np.eye(3)
    dense = np.zeros((3 * NODES, 3 * NODES))
    for r, c, block in zip(rows, pattern.indices, blocks, strict=True):
        dense[3 * r : 3 * r + 3, 3 * c : 3 * c + 3] = block
        dense[3 * c : 3 * c + 3, 3 * r : 3 * r + 3] = block.T
    kept = np.zeros(NODES, dtype=bool)
    kept[KEPT] = True
    return Condensation(pattern.indptr, pattern.indices, kept), blocks, dense


@pytest.fixture(params=[True, False], ids=["PARDISO", "SuperLU"])
def solver(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Select the direct solver; the value is True for PARDISO."""
    if request.param and not direct.HAVE_PARDISO:
        pytest.skip("pypardiso is for x86-64")
    monkeypatch.setattr(direct, "HAVE_PARDISO", request.param)
    return bool(request.param)


@pytest.mark.usefixtures("solver")
def test_complement_and_both_halves_of_a_solve() -> None:
    rng = np.random.default_rng(2)
    it, blocks, dense = chained(rng)
    kept = (3 * KEPT[:, None] + np.arange(3)).ravel()
    gone = np.setdiff1d(np.arange(3 * NODES), kept)
    eliminated = np.linalg.solve(dense[np.ix_(gone, gone)], dense[np.ix_(gone, kept)])
    wanted = dense[np.ix_(kept, kept)] - dense[np.ix_(kept, gone)] @ eliminated
    for _ in range(2):  # the second time with the stored analysis
        assert it.factorise(blocks) == pytest.approx(wanted, rel=1e-5, abs=1e-5)
    rhs = rng.standard_normal((NODES, 3))
    passed_on = dense[np.ix_(kept, gone)] @ np.linalg.solve(dense[np.ix_(gone, gone)], rhs.ravel()[gone])
    eliminated = it.eliminate(rhs)
    assert it.passed_on(eliminated) == pytest.approx(passed_on, rel=1e-5, abs=1e-5)
    moved = rng.standard_normal(len(kept))
    x = it.expand(eliminated, moved).ravel()
    assert x[kept] == pytest.approx(moved, rel=1e-6)
    assert dense[gone] @ x == pytest.approx(rhs.ravel()[gone], rel=1e-4, abs=1e-5)


def test_a_singular_matrix_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(direct, "HAVE_PARDISO", False)
    it, blocks, _ = chained(np.random.default_rng(3))
    with pytest.raises(LinearSolveError):
        it.factorise(0.0 * blocks)
