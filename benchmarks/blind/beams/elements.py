"""Mesh and finite elements of a half beam (y >= 0).

A section is a half disc of curved quadrilaterals (half a hexagon inside, rings around it); the beam is the
section extruded along x, so that all layers share one connectivity. Elements are hexahedra of one polynomial
degree with the energy density

    W = mu/2 [(I1bar - 3) + a (I1bar - 3)^2] + p (J - 1) - p^2 / (2 K),

where the pressure p is a polynomial one degree lower, discontinuous between elements and statically
condensed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise, product

import numpy as np
from numpy.polynomial import legendre
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def lobatto(degree: int) -> Array:
    """Gauss-Lobatto points of a degree on [-1, 1], shape (degree + 1,)."""
    inner = legendre.legroots(legendre.legder([0.0] * degree + [1.0]))
    return np.concatenate([[-1.0], np.sort(inner), [1.0]])


def lagrange(nodes: Array, at: Array) -> tuple[Array, Array]:
    """Values and derivatives of the Lagrange polynomials through `nodes`, each (len(at), len(nodes))."""
    powers = np.vander(nodes, increasing=True)
    coefficients = np.linalg.inv(powers)
    k = np.arange(len(nodes))
    values = at[:, None] ** k
    slopes = np.zeros_like(values)
    slopes[:, 1:] = k[1:] * at[:, None] ** (k[1:] - 1)
    return values @ coefficients, slopes @ coefficients


@dataclass(frozen=True, eq=False)
class Section:
    """Mesh of the unit half disc.

    Attributes
    ----------
    nodes : coordinates y, z, shape (n, 2).
    quads : nodes of the quadrilaterals, shape (m, (p + 1)^2); the first local axis is the slow one.
    flat : nodes with y = 0.
    top, bottom : the nodes at (0, 1) and (0, -1).
    """

    nodes: Array
    quads: Indices
    flat: Indices
    top: int
    bottom: int


@lru_cache(maxsize=8)
def half_disc(degree: int, rings: tuple[float, ...], split: int = 1) -> Section:
    """Mesh of the unit half disc.

    `rings` are the radii of the circles between elements, ascending, the last one 1; the first is the
    circumradius of the hexagon. Each quadrilateral is split into split^2.
    """
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
    """Fraction of a uniformly distributed load on the section that each node carries, shape (n,)."""
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
    """Layer boundaries from `start` to `end` [m], graded towards the clamp at `start` (and at `end`)."""
    span = (end - start) / (2 if both_ends else 1)
    sizes = [first]
    while sum(sizes) < span:
        sizes.append(min(sizes[-1] * growth, longest))
    half = np.concatenate([[0.0], np.cumsum(sizes)]) * span / sum(sizes)
    if not both_ends:
        return start + half
    return np.concatenate([start + half, end - half[-2::-1]])


def with_breaks(breaks: Array, wanted: tuple[float, ...], *, near: float = 1.2e-3) -> Array:
    """`breaks` with further ones at `wanted`; inner ones closer than `near` [m] to these are removed."""
    for value in wanted:
        keep = np.abs(breaks - value) > near
        keep[[0, -1]] = True
        breaks = np.sort(np.append(breaks[keep], value))
    return breaks


_EYE = np.eye(3)


@dataclass(frozen=True, eq=False)
class Bricks:
    """Elements in their stress-free shape.

    Attributes
    ----------
    gradient : gradients of the shape functions [1/m], shape (e, q, 3, a).
    weight : volume of the quadrature points [m3], shape (e, q).
    value : shape functions, shape (q, a).
    pressure : pressure polynomials, shape (q, b).
    point : quadrature points in the ideal prism [m], shape (e, q, 3).
    """

    gradient: Array
    weight: Array
    value: Array
    pressure: Array
    point: Array


def bricks(degree: int, ideal: Array, rest: Array, layer: Callable[[float], float] | None = None) -> Bricks:
    """Elements with nodes `ideal` in the prism and `rest` stress-free, both (e, a, 3).

    The nodes a are numbered (plane, slow, fast). `layer` maps the fast coordinate to the slow coordinate of a
    material interface; the quadrature is split there. ValueError if an element is inverted.
    """
    grid, (abscissa, gauss) = lobatto(degree), leggauss(degree + 1)
    places = []
    for (u, wu), (w, ww) in product(zip(abscissa, gauss, strict=True), repeat=2):
        cuts = [-1.0, 1.0] if layer is None else [-1.0, layer(w), 1.0]
        for low, high in pairwise(cuts):
            half = (high - low) / 2
            places += [
                (u, low + half * (1 + v), w, wu * half * wv * ww)
                for v, wv in zip(abscissa, gauss, strict=True)
            ]
    at = np.array(places)
    both = [lagrange(grid, at[:, axis]) for axis in range(3)]
    value = np.einsum("qa,qb,qc->qabc", *(b[0] for b in both)).reshape(len(at), -1)
    local = np.stack(
        [
            np.einsum("qa,qb,qc->qabc", *(b[int(axis == k)] for axis, b in enumerate(both))).reshape(
                value.shape
            )
            for k in range(3)
        ],
        axis=1,
    )
    jacobian: Array = np.einsum("qka,eai->eqki", local, rest)
    volume = np.linalg.det(jacobian)
    if (volume * volume[:, :1] <= 0).any():  # left- and right-handed elements are both allowed
        raise ValueError("blind mesh: an element is turned inside out")
    gradient = np.linalg.solve(jacobian, np.broadcast_to(local, (len(rest), *local.shape)))
    weight = np.abs(volume) * at[:, 3]
    along, slow, fast = at[:, 0], at[:, 1], at[:, 2]
    powers = [k for k in product(range(degree), repeat=3) if sum(k) < degree]
    pressure = np.stack([along**i * slow**j * fast**k for i, j, k in powers], axis=1)
    return Bricks(gradient, weight, value, pressure, np.einsum("qa,eai->eqi", value, ideal))


def smallest_volume(mesh: Bricks, x: Array) -> float:
    """Minimum of det F over the quadrature points at positions x (e, a, 3)."""
    return float(np.linalg.det(np.matmul(mesh.gradient, x[:, None])).min())


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Forces and tangent of the elements, with the pressure condensed.

    Attributes
    ----------
    force : shape (e, a, 3).
    matrix : shape (e, a, 3, b, 3).
    recover, shift : shapes (e, b, 3a) and (e, b); the pressure changes by recover @ du + shift.
    """

    force: Array
    matrix: Array
    recover: Array
    shift: Array


def assemble(mesh: Bricks, x: Array, p: Array, mu: Array, stiffening: float, bulk_ratio: float) -> Stiffness:
    """Forces and tangent at positions x (e, a, 3) and pressures p (e, b).

    mu (e, q) is the shear modulus at the quadrature points; `stiffening` is a and `bulk_ratio` K / mu.
    """
    e, q, _, a = mesh.gradient.shape
    F = np.matmul(mesh.gradient, x[:, None]).swapaxes(-1, -2)
    J = np.linalg.det(F)
    H = np.linalg.inv(F).swapaxes(-1, -2)
    scale = J ** (-2 / 3)
    I1 = np.einsum("eqij,eqij->eq", F, F)
    excess = scale * I1 - 3
    w1, w2 = mu / 2 * (1 + 2 * stiffening * excess), mu * stiffening
    bar = scale[..., None, None] * (2 * F - (2 / 3) * I1[..., None, None] * H)
    pressure = p @ mesh.pressure.T
    P = w1[..., None, None] * bar + (pressure * J)[..., None, None] * H
    FH = np.einsum("eqij,eqkl->eqijkl", F, H)
    HH = np.einsum("eqij,eqkl->eqijkl", H, H)
    crossed = np.einsum("eqil,eqkj->eqijkl", H, H)
    s, i1 = (w1 * scale)[..., None, None, None, None], I1[..., None, None, None, None]
    pj = (pressure * J)[..., None, None, None, None]
    A = (-4 / 3) * s * (FH + FH.transpose(0, 1, 4, 5, 2, 3))
    A += (4 / 9 * s * i1 + pj) * HH + (2 / 3 * s * i1 - pj) * crossed
    A += 2 * s * np.einsum("ik,jl->ijkl", _EYE, _EYE)
    if stiffening:
        A += w2[..., None, None, None, None] * np.einsum("eqij,eqkl->eqijkl", bar, bar)
    A *= mesh.weight[..., None, None, None, None]
    force = np.einsum("eqja,eqij->eai", mesh.gradient, P * mesh.weight[..., None, None], optimize=True)
    matrix = np.empty((e, a, 3, a, 3))
    left = mesh.gradient.reshape(e, q * 3, a).swapaxes(-1, -2)
    for i in range(3):
        for k in range(i, 3):
            block = left @ np.matmul(A[:, :, i, :, k], mesh.gradient).reshape(e, q * 3, a)
            matrix[:, :, i, :, k] = block
            if k != i:
                matrix[:, :, k, :, i] = block.swapaxes(-1, -2)
    volume = (mesh.weight * J)[..., None, None] * H  # dJ/dF, weighted
    change = np.einsum("eqja,eqij->eqai", mesh.gradient, volume, optimize=True).reshape(e, q, a * 3)
    B = mesh.pressure.T @ change
    gap = (mesh.weight * (J - 1)) @ mesh.pressure
    C = np.einsum("qb,eq,qc->ebc", mesh.pressure, mesh.weight / (bulk_ratio * mu), mesh.pressure)
    gap = gap - np.einsum("ebc,ec->eb", C, p)
    solved = np.linalg.solve(C, np.concatenate([B, gap[..., None]], axis=2))
    recover, shift = solved[..., :-1], solved[..., -1]
    flat = matrix.reshape(e, 3 * a, 3 * a)
    flat += B.swapaxes(-1, -2) @ recover
    force += np.einsum("ebk,eb->ek", B, shift).reshape(e, a, 3)
    return Stiffness(force, matrix, recover, shift)
