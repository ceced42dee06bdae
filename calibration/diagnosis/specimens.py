"""Moduli of specimens: one of each, those of one material near each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import helmert

Array = NDArray[np.float64]

SCATTER = 0.15  # of ln G from one specimen of a material to the next
LARGEST = 0.20  # the same in a lab that moulds them badly: more is no scatter
SPECIMENS = "specimens"  # the set of patterns in which specimens of one material differ
# by what the squares of a set of patterns are taken less before they are compared with noise
ALLOWED: Mapping[str, float] = {SPECIMENS: (SCATTER / LARGEST) ** 2}


def scatter_rows(materials: Sequence[str]) -> Array:
    """Prior rows (k, n) that hold the specimens of one material together, in sd of their scatter; materials:
    of the n specimens. One row fewer than each material has specimens: their mean is free."""
    rows = []
    for m in dict.fromkeys(materials):
        mine = [k for k, owner in enumerate(materials) if owner == m]
        for contrast in helmert(len(mine)):
            row = np.zeros(len(materials))
            row[mine] = contrast
            rows.append(row / SCATTER)
    return np.array(rows).reshape(len(rows), len(materials))


def scatter_patterns(size: int, first: int, held: int) -> Mapping[str, Array]:
    """The set of patterns in which specimens of one material differ: columns (size, held), where the rows
    of `scatter_rows` are those from `first`. None where no material has two specimens."""
    return {SPECIMENS: np.eye(size)[:, first : first + held]} if held else {}


def mean_moduli(materials: Sequence[str], u: Array) -> dict[str, float]:
    """Of each material [Pa]: the geometric mean over its specimens, whose ln(G / 1 Pa) are u (n,)."""
    found: dict[str, list[float]] = {}
    for m, value in zip(materials, u, strict=True):
        found.setdefault(m, []).append(float(value))
    return {m: float(np.exp(np.mean(v))) for m, v in found.items()}
