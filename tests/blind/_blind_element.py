"""Residual and tangent of the bricks: W = mu/2 [(I1bar - 3) + a (I1bar - 3)^2] + p (J - 1) - p^2 / (2 K).

Pressure p is a polynomial one degree lower, discontinuous from element to element, and condensed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from _blind_mesh import lagrange, lobatto
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

Array = NDArray[np.float64]
_EYE = np.eye(3)


@dataclass(frozen=True, eq=False)
class Bricks:
    """Elements with their rest shape. gradient (e, q, 3, a): of the shape functions; weight (e, q): rest
    volume [m3]; value (q, a); pressure (q, b): pressure polynomials; point (e, q, 3): where each quadrature
    point lies in the ideal prism [m]."""

    gradient: Array
    weight: Array
    value: Array
    pressure: Array
    point: Array


def bricks(degree: int, ideal: Array, rest: Array, layer: Callable[[float], float] | None = None) -> Bricks:
    """ideal, rest: (e, a, 3) nodes of the elements in the prism and stress-free; a: (plane, slow, fast).

    layer: the slow coordinate at which, for a fast one, another material begins: integrated on both sides.
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
    if (volume * volume[:, :1] <= 0).any():  # left- and right-handed elements are both welcome
        raise ValueError("blind mesh: an element is turned inside out")
    gradient = np.linalg.solve(jacobian, np.broadcast_to(local, (len(rest), *local.shape)))
    weight = np.abs(volume) * at[:, 3]
    along, slow, fast = at[:, 0], at[:, 1], at[:, 2]
    powers = [k for k in product(range(degree), repeat=3) if sum(k) < degree]
    pressure = np.stack([along**i * slow**j * fast**k for i, j, k in powers], axis=1)
    return Bricks(gradient, weight, value, pressure, np.einsum("qa,eai->eqi", value, ideal))


def smallest_volume(mesh: Bricks, x: Array) -> float:
    """The least det F over the quadrature points at positions x (e, a, 3)."""
    return float(np.linalg.det(np.matmul(mesh.gradient, x[:, None])).min())


@dataclass(frozen=True, eq=False)
class Stiffness:
    """force (e, a, 3), matrix (e, a, 3, b, 3) condensed; recover (e, b, 3a) and shift (e, b): the pressure's
    change is recover @ du + shift."""

    force: Array
    matrix: Array
    recover: Array
    shift: Array


def assemble(mesh: Bricks, x: Array, p: Array, mu: Array, stiffening: float, bulk_ratio: float) -> Stiffness:
    """x (e, a, 3): positions; p (e, b); mu (e, q): shear modulus at the quadrature points."""
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
