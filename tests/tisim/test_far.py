"""The far field as a spring: its force is its energy's slope, its parts make its stiffness."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import eigh

from tisim.linear.blocks import pattern_of
from tisim.problems.indentation.far_field import FarField

Array = NDArray[np.float64]
NODES = 12
FREE_ROWS = 9


def field(rng: np.random.Generator) -> tuple[FarField, Array, NDArray[np.int32]]:
    """On the last five nodes of a chain, its stiffness, and the rows of the five."""
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


def test_pairs_and_the_rest_make_the_stiffness() -> None:
    rng = np.random.default_rng(7)
    it, stiffness, rows = field(rng)
    paired = np.zeros((5, 3, 5, 3))
    for i, j, block in zip(it._i, it._j, it.paired, strict=True):
        paired[j, :, i] = block.T
        paired[i, :, j] = block
    near = paired.reshape(15, 15)
    out, v = np.zeros(3 * FREE_ROWS), rng.standard_normal(3 * FREE_ROWS)
    it.add_unpaired(v, out)
    at = (3 * rows[:, None] + np.arange(3)).ravel()
    assert near @ v[at] + out[at] == pytest.approx(stiffness @ v[at], rel=1e-5)
    others = np.setdiff1d(np.arange(3 * FREE_ROWS), at)
    assert not out[others].any()
    # neighbours along the chain are paired, others are not
    assert {(int(i), int(j)) for i, j in zip(it._i, it._j, strict=True)} == {
        *((k, k) for k in range(5)), *((k, k + 1) for k in range(4)),
    }  # fmt: skip


def test_the_factor_is_positive_where_distant_pairs_are_left_out() -> None:
    """A sheet whose points all drag each other along: neighbours alone are indefinite; with a share of the
    others on the diagonal they are positive, and the spectrum of one by the other is narrow."""
    line = np.linspace(0.0, 1.0, 40)
    conn = np.array([[k, k + 1] for k in range(39)], dtype=np.int32)
    pattern = pattern_of(conn, 40, np.zeros(0, dtype=np.int32))
    it = FarField(np.arange(40, dtype=np.int32), pattern)
    away = np.abs(line[:, None] - line)
    stiffness = np.kron(np.exp(-away / 0.1) + 0.1 * np.eye(40), np.eye(3))
    it.set_stiffness(stiffness.astype(np.float32))
    near = np.zeros((40, 3, 40, 3))
    for i, j, block in zip(it._i, it._j, it.paired, strict=True):
        near[j, :, i] = block.T
        near[i, :, j] = block
    spectrum = eigh(stiffness, near.reshape(120, 120), eigvals_only=True)
    assert spectrum[0] > 0.05
    assert spectrum[-1] < 1.6


def test_the_factor_is_positive_whatever_is_left_out() -> None:
    """A band of which the outer diagonals carry the balance, (1 + cos t)^2: three tenths of what is left out
    do not make up for it, and the share grows until it does."""
    conn = np.array([[k, k + 1] for k in range(39)], dtype=np.int32)
    it = FarField(np.arange(40, dtype=np.int32), pattern_of(conn, 40, np.zeros(0, dtype=np.int32)))
    band = sum(v * np.eye(40, k=k) for k, v in ((0, 1.51), (1, 1.0), (-1, 1.0), (2, 0.25), (-2, 0.25)))
    stiffness = np.kron(band, np.eye(3))
    it.set_stiffness(stiffness.astype(np.float32))
    near = np.zeros((40, 3, 40, 3))
    for i, j, block in zip(it._i, it._j, it.paired, strict=True):
        near[j, :, i] = block.T
        near[i, :, j] = block
    assert np.linalg.eigvalsh(near.reshape(120, 120))[0] > 0.0
    out, v = np.zeros(120), np.random.default_rng(8).standard_normal(120)
    it.add_unpaired(v, out)
    assert near.reshape(120, 120) @ v + out == pytest.approx(stiffness @ v, rel=1e-4, abs=1e-4)
