"""Moduli of specimens: one of each, those of one material near each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SCATTER = 0.15  # of ln G from one specimen of a material to the next


def scatter_rows(materials: Sequence[str]) -> Array:
    """Prior rows (k, n) that hold the specimens of one material together, in sd of their scatter; materials:
    of the n specimens."""
    rows = []
    for m in dict.fromkeys(materials):
        mine = [k for k, owner in enumerate(materials) if owner == m]
        for k in mine if len(mine) > 1 else []:
            row = np.zeros(len(materials))
            row[mine] = -1.0 / len(mine)
            row[k] += 1.0
            rows.append(row / SCATTER)
    return np.array(rows).reshape(len(rows), len(materials))


def mean_moduli(materials: Sequence[str], u: Array) -> dict[str, float]:
    """Of each material [Pa]: the geometric mean over its specimens, whose ln(G / 1 Pa) are u (n,)."""
    found: dict[str, list[float]] = {}
    for m, value in zip(materials, u, strict=True):
        found.setdefault(m, []).append(float(value))
    return {m: float(np.exp(np.mean(v))) for m, v in found.items()}
