"""Mesh of a half beam (y >= 0) for the blind data: bricks of one polynomial degree, layer upon layer.

A section is a half disc of curved quadrilaterals (half a hexagon inside, rings around it); the beam is that
section swept along x, so that all layers share one connectivity. No code of `tisim` is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def lobatto(degree: int) -> Array:
    """Gauss-Lobatto points of a degree on [-1, 1]."""
    inner = legendre.legroots(legendre.legder([0.0] * degree + [1.0]))
    return np.concatenate([[-1.0], np.sort(inner), [1.0]])


def lagrange(nodes: Array, at: Array) -> tuple[Array, Array]:
    """Values and slopes of the Lagrange polynomials through `nodes`, each (len(at), len(nodes))."""
    powers = np.vander(nodes, increasing=True)
    coefficients = np.linalg.inv(powers)
    k = np.arange(len(nodes))
    values = at[:, None] ** k
    slopes = np.zeros_like(values)
    slopes[:, 1:] = k[1:] * at[:, None] ** (k[1:] - 1)
    return values @ coefficients, slopes @ coefficients


@dataclass(frozen=True, eq=False)
class Section:
    """nodes (n, 2): y, z on the unit half disc; quads (m, (p+1)^2): first local axis slow; flat: nodes with
    y = 0; top, bottom: the nodes at (0, 1) and (0, -1)."""

    nodes: Array
    quads: Indices
    flat: Indices
    top: int
    bottom: int


@lru_cache(maxsize=8)
def half_disc(degree: int, rings: tuple[float, ...], split: int = 1) -> Section:
    """rings: radii (parts of 1) of the circles between elements, the last 1; the first bounds the hexagon."""
    grid = lobatto(degree)
    steps = np.concatenate([(k + (grid + 1) / 2) / split for k in range(split)])
    steps = steps.reshape(split, degree + 1)
    angle = np.pi * np.arange(4) / 3
    corner = rings[0] * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    corner[[0, 3], 0] = 0.0
    patches = []
    for row in steps:
        for column in steps:
            a, b = row[:, None, None], column[None, :, None]
            patches.append(
                (1 - a) * ((1 - b) * corner[0] + b * corner[1]) + a * ((1 - b) * corner[3] + b * corner[2])
            )
    for ring, outer in enumerate(rings[1:]):
        for sector in range(3):
            for row in steps:
                for column in steps:
                    turn = np.pi / 3 * (sector + column)
                    arc = np.stack([np.sin(turn), np.cos(turn)], axis=1)
                    chord = (1 - column[:, None]) * corner[sector] + column[:, None] * corner[sector + 1]
                    inner = chord if ring == 0 else rings[ring] * arc
                    patches.append(inner + row[:, None, None] * (outer * arc - inner))
    points = np.concatenate([p.reshape(-1, 2) for p in patches])
    _, first, inverse = np.unique(np.round(points, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    nodes = points[first]
    flat = np.flatnonzero(np.abs(nodes[:, 0]) < 1e-12)
    nodes[flat, 0] = 0.0
    quads = inverse.reshape(len(patches), -1)
    return Section(nodes, quads, flat, int(flat[nodes[flat, 1].argmax()]), int(flat[nodes[flat, 1].argmin()]))


def face_shares(section: Section, degree: int) -> Array:
    """Part of a load spread evenly over the section that each node carries (n,)."""
    points, gauss = legendre.leggauss(degree + 2)
    value, slope = lagrange(lobatto(degree), points)
    shares = np.zeros(len(section.nodes))
    for quad in section.quads:
        corner = section.nodes[quad].reshape(degree + 1, degree + 1, 2)
        slow = np.einsum("sa,tb,abi->sti", slope, value, corner)
        fast = np.einsum("sa,tb,abi->sti", value, slope, corner)
        area = np.abs(slow[..., 0] * fast[..., 1] - slow[..., 1] * fast[..., 0])
        area *= gauss[:, None] * gauss
        np.add.at(shares, quad, np.einsum("st,sa,tb->ab", area, value, value).ravel())
    return np.asarray(shares / shares.sum())


def axial_breaks(
    start: float, end: float, *, both_ends: bool, first: float, growth: float, longest: float
) -> Array:
    """Layer boundaries from `start` to `end` [m], graded towards the clamp at start (and at end)."""
    span = (end - start) / (2 if both_ends else 1)
    sizes = [first]
    while sum(sizes) < span:
        sizes.append(min(sizes[-1] * growth, longest))
    half = np.concatenate([[0.0], np.cumsum(sizes)]) * span / sum(sizes)
    if not both_ends:
        return start + half
    return np.concatenate([start + half, end - half[-2::-1]])


def with_breaks(breaks: Array, wanted: tuple[float, ...], *, near: float = 1.2e-3) -> Array:
    """`breaks` with further boundaries at `wanted`; inner ones nearer than `near` [m] to a wanted one go."""
    for value in wanted:
        keep = np.abs(breaks - value) > near
        keep[[0, -1]] = True
        breaks = np.sort(np.append(breaks[keep], value))
    return breaks
