"""Hexahedral mesh (27 nodes) of the half cylinder y >= 0 along x; lengths in metres."""

from __future__ import annotations

from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.quadrilaterals import with_middles

Array = np.ndarray[Any, Any]


def graded(count: int, strength: float) -> Array:
    """Corners and middles of `count` intervals of [0, 1], small near 0."""
    corners = np.expm1(strength * np.linspace(0, 1, count + 1)) / np.expm1(strength)
    return with_middles(corners)


def half_disc(level: int) -> list[Array]:
    """Lattices (2i+1, 2j+1, yz) of the quadratic patches of the half disc y >= 0 of unit radius."""
    half = 0.45
    t = np.linspace(-1, 1, 4 * level + 1)
    core = np.stack(np.meshgrid(half * t[2 * level :], half * t, indexing="ij"), -1)
    side = np.linspace(0, 1, 2 * level + 1)
    right = np.stack([np.full_like(t, half), half * t], -1)
    bottom = np.stack([half * side, np.full_like(side, -half)], -1)
    top = np.stack([half * side[::-1], np.full_like(side, half)], -1)
    ring = 1 - graded(2 * level, 0.9)[::-1]  # 0 at the core, 1 at the surface
    patches = [core]
    for edge, start, stop in ((bottom, -0.5, -0.25), (right, -0.25, 0.25), (top, 0.25, 0.5)):
        angle = np.pi * np.linspace(start, stop, len(edge))
        arc = np.stack([np.cos(angle), np.sin(angle)], -1)
        patches.append(edge + ring[:, None, None] * (arc - edge))
    return patches


def lattice_cells(number: Array) -> Array:
    """27-node connectivity of a lattice of point numbers with odd sides."""
    reference = fe.TriQuadraticHexahedron().points.astype(int) + 1
    n = number.shape
    pick = [tuple(slice(o, n[k] - 2 + o, 2) for k, o in enumerate(offset)) for offset in reference]
    return np.stack([number[p].ravel() for p in pick], -1)


def half_cylinder(radius: float, length: float, layers: int, strength: float, level: int) -> fe.Mesh:
    """Half cylinder, section scaled to the circle's area; every element of level 1 cut into level^3."""
    x = length * graded(layers * level, strength)
    points, cells, start = [], [], 0
    for patch in half_disc(level):
        grid = np.empty((len(x), *patch.shape[:2], 3))
        grid[..., 0], grid[..., 1:] = x[:, None, None], radius * patch
        number = start + np.arange(grid[..., 0].size).reshape(grid.shape[:3])
        cells.append(lattice_cells(number))
        points.append(grid.reshape(-1, 3))
        start += number.size
    mesh = fe.Mesh(np.concatenate(points), np.concatenate(cells), "hexahedron27")
    mesh = mesh.merge_duplicate_points(decimals=9)
    area = fe.RegionTriQuadraticHexahedron(mesh).dV.sum() / length
    mesh.points[:, 1:] *= np.sqrt(np.pi * radius**2 / 2 / area)
    return mesh
