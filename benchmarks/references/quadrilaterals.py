"""Meshes of 9-node quadrilaterals in a meridian plane, for FElupe: nodes on lines of constant z and r."""

from __future__ import annotations

from typing import Any

import felupe as fe
import numpy as np

Array = np.ndarray[Any, Any]


def with_middles(corners: Array) -> Array:
    """Corners (n,) of elements along a line, with the points halfway between them, shape (2 n - 1,)."""
    found = np.empty(2 * len(corners) - 1)
    found[::2], found[1::2] = corners, (corners[1:] + corners[:-1]) / 2
    return found


def quadrilaterals(axial: Array, radial: Array) -> fe.Mesh:
    """Mesh with nodes (z, r) at these positions (2 n - 1,), (2 m - 1,), every other one a corner."""
    grid = np.stack(np.meshgrid(axial, radial, indexing="ij"), -1)
    n, m = grid.shape[:2]
    number = np.arange(n * m).reshape(n, m)
    offsets = fe.BiQuadraticQuad().points.astype(int) + 1
    cells = np.stack([number[i : n - 2 + i : 2, j : m - 2 + j : 2].ravel() for i, j in offsets], -1)
    return fe.Mesh(grid.reshape(-1, 2), cells, "quad9")
