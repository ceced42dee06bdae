"""Graded meshes of boxes: 27-node hexahedra, and the 10-node tetrahedra they split into; metres."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.cylinder import graded, lattice_cells

Array = np.ndarray[Any, Any]


def two_sided(count: int, strength: float) -> Array:
    """Corners and middles of `count` (even) intervals of [0, 1], small near both ends."""
    half = graded(count // 2, strength) / 2
    return np.concatenate([half, 1 - half[-2::-1]])


def box(axes: Sequence[Array]) -> fe.Mesh:
    """27-node hexahedra on the lattice of three rising sequences of corners and middles."""
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    number = np.arange(grid[..., 0].size).reshape(grid.shape[:3])
    return fe.Mesh(grid.reshape(-1, 3), lattice_cells(number), "hexahedron27")


def tetrahedra(cells: Array) -> Array:
    """Each 27-node hexahedron of a lattice as six 10-node tetrahedra (Kuhn's split), order of VTK."""
    lattice = (fe.TriQuadraticHexahedron().points.astype(int) + 1).tolist()
    corner = {tuple(p): k for k, p in enumerate(lattice)}
    out = []
    for path in permutations(range(3)):
        walk = [np.zeros(3, dtype=int)]
        for axis in path:
            walk.append(walk[-1] + 2 * np.eye(3, dtype=int)[axis])
        if np.linalg.det(np.diff(walk, axis=0)) < 0:
            walk[1], walk[2] = walk[2], walk[1]
        pairs = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
        nodes = walk + [(walk[a] + walk[b]) // 2 for a, b in pairs]
        out.append(cells[:, [corner[tuple(n.tolist())] for n in nodes]])
    return np.concatenate(out)
