"""Equilibrium of a heavy silicone beam with faults: Newton's method on positions, pressures and clamp angles.

The inner planes of each layer are condensed; the block tridiagonal matrix of the layers' faces is eliminated
from the clamp to the end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.elements import assemble, lagrange, lobatto, smallest_volume
from benchmarks.blind.beams.model import Beam, Model, Resolution, held_face, mesh

Array = NDArray[np.float64]


def newton_step(
    model: Model,
    force: Array,
    matrix: Array,
    factor: float,
    moves: Array,
    slopes: list[Array],
    loose: NDArray[np.intp],
    spring: Array,
    turned: Array,
) -> tuple[Array, Array]:
    """Newton step: changes of the positions (planes, n, 3) and of the clamps' angles.

    Parameters
    ----------
    model : Model
    force, matrix : array
        Of the elements, shapes (e, a, 3) and (e, a, 3, a, 3).
    factor : float
        Fraction of the load.
    moves : array, shape (planes, n, 3)
        Prescribed changes of the clamped faces.
    slopes : list of array, shape (n, 3)
        Derivatives of the clamped faces by the clamps' angles.
    loose : array of int
        Clamps that can rotate.
    spring : array
        Rotational stiffness of each clamp over mu, for the half beam.
    turned : array
        Rotation of each clamp from its unloaded angle [rad].
    """
    degree, quads = model.degree, model.section.quads
    n = 3 * len(model.section.nodes)
    layers, size = len(model.mu) // len(quads), (degree + 1) * n
    residual = (factor * model.load).ravel()
    right = residual.reshape(-1, n).copy()
    A = np.zeros((layers, size, size))
    R = np.zeros((layers, size))
    for m, quad in enumerate(quads):
        nodes = (np.arange(degree + 1)[:, None] * len(model.section.nodes) + quad).ravel()
        dof = (3 * nodes[:, None] + np.arange(3)).ravel()
        block = matrix[m :: len(quads)].reshape(layers, -1)
        A.reshape(layers, -1)[:, (dof[:, None] * size + dof).ravel()] += block
        R[:, dof] -= force[m :: len(quads)].reshape(layers, -1)
    plane = degree * np.arange(layers)[:, None] + np.arange(degree + 1)
    np.add.at(right, plane, R.reshape(layers, degree + 1, n))
    mirror = 3 * model.section.flat + 1  # y = 0 stays in the mirror plane
    held = (np.arange(degree + 1)[:, None] * n + mirror).ravel()
    A[:, held] = 0.0
    A[:, :, held] = 0.0
    A[:, held, held] = 1.0
    right[:, mirror] = 0.0
    # columns: the load's right-hand side with the prescribed faces, then one per rotating clamp
    columns = 1 + len(loose)
    inner, outer = slice(n, degree * n), np.r_[0:n, degree * n : size]
    G = A[:, inner, outer]
    b = right[:-1].reshape(layers, degree, n)[:, 1:].reshape(layers, -1, 1)
    solved = np.linalg.solve(A[:, inner, inner], np.concatenate([G, b], axis=2))
    S = A[:, outer[:, None], outer] - G.swapaxes(1, 2) @ solved[..., :-1]
    c = (G.swapaxes(1, 2) @ solved[..., -1:])[..., 0]
    f = right[::degree].copy()
    f[:-1] -= c[:, :n]
    f[1:] -= c[:, n:]
    given = np.zeros((layers + 1, n, columns))
    ends = (0, layers)[: len(slopes)]
    for k, end in enumerate(ends):
        given[end, :, 0] = moves[-1 if k else 0].ravel()
        if k in loose:
            given[end, :, 1 + list(loose).index(k)] = slopes[k].ravel()
    d = _tridiagonal(S, f, given, bridge=len(ends) == 2)
    dturn = np.zeros(len(slopes))
    if len(loose):
        work, pull = np.zeros((len(loose), columns)), np.zeros(len(loose))
        for row, k in enumerate(loose):
            end, layer = ends[k], (0, layers - 1)[k]
            half = slice(0, n) if k == 0 else slice(n, 2 * n)
            reaction = S[layer, half] @ np.concatenate([d[layer], d[layer + 1]])
            work[row] = slopes[k].ravel() @ reaction
            pull[row] = slopes[k].ravel() @ f[end]
            work[row, 1 + row] += spring[k]
            work[row, 0] += spring[k] * turned[k]
        dturn[loose] = np.linalg.solve(work[:, 1:], pull - work[:, 0])
    d = d[..., 0] + d[..., 1:] @ dturn[loose]
    dx = np.empty((layers * degree + 1, n))
    dx[::degree] = d
    both = np.concatenate([d[:-1], d[1:]], axis=1)[..., None]
    middle = solved[..., -1:] - solved[..., :-1] @ both
    dx[:-1].reshape(layers, degree, n)[:, 1:] = middle.reshape(layers, degree - 1, n)
    return dx.reshape(moves.shape), dturn


def _tridiagonal(S: Array, f: Array, given: Array, *, bridge: bool) -> Array:
    """Displacements of the faces, shape (faces, n, columns).

    They follow from the layers' matrices S (l, 2n, 2n) and the forces f (faces, n), which belong to the first
    column only; `given` holds the displacements of the clamped faces.
    """
    layers, n = len(S), S.shape[1] // 2
    last = layers - 1 if bridge else layers
    right = np.zeros_like(given)
    right[..., 0] = f
    right[1] -= S[0, n:, :n] @ given[0]
    if bridge:
        right[layers - 1] -= S[-1, :n, n:] @ given[-1]
    d = given.copy()
    up: list[Array] = []
    diagonal = S[0, n:, n:]
    for face in range(1, last + 1):
        if face < layers:
            diagonal = diagonal + S[face, :n, :n]
        if face == last:
            d[face] = np.linalg.solve(diagonal, right[face])
            break
        both = np.linalg.solve(diagonal, np.concatenate([S[face, :n, n:], right[face]], axis=1))
        up.append(both)
        lower = S[face, n:, :n]
        right[face + 1] -= lower @ both[:, n:]
        diagonal = S[face, n:, n:] - lower @ both[:, :n]
    for face in range(last - 1, 0, -1):
        both = up[face - 1]
        d[face] = both[:, n:] - both[:, :n] @ d[face + 1]
    return d


class NoEquilibriumError(RuntimeError):
    """No equilibrium was found."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A solved beam: positions (planes, n, 3) [m], clamp angles [rad] (positive: slope up), Newton steps."""

    model: Model
    x: Array
    turn: Array
    steps: int

    def edges(self, s: Array) -> Array:
        """Silhouette (2, len(s), 2): x, z [m] of the upper and lower edge at s in [0, 1].

        s is the x coordinate in the ideal prism over the free length.
        """
        planes = self.model.ideal[:, 0, 0]
        degree, at = self.model.degree, s * self.model.beam.length
        layer = np.clip(np.searchsorted(planes[::degree], at, side="right") - 1, 0, len(planes) // degree - 1)
        low, high = planes[layer * degree], planes[(layer + 1) * degree]
        value, _ = lagrange(lobatto(degree), 2 * (at - low) / (high - low) - 1)
        columns = layer[:, None] * degree + np.arange(degree + 1)
        ends = [self.model.section.top, self.model.section.bottom]
        edges = np.einsum("sk,skec->esc", value, self.x[columns][:, :, ends][..., [0, 2]])
        # a grip that extends over its face keeps the material inside straight
        for end, beyond in ((0, np.minimum(at - planes[0], 0)), (-1, np.maximum(at - planes[-1], 0))):
            turn = self.turn[end] if len(self.turn) == 2 or end == 0 else 0.0
            held = beyond != 0
            ray = beyond[held, None] * np.array([np.cos(turn), np.sin(turn)])
            edges[:, held] = self.x[end, ends][:, None, [0, 2]] + ray
        return edges


def solve(beam: Beam, *, start: Array | None = None, resolution: Resolution | None = None) -> Shape:
    """Equilibrium of a beam; NoEquilibriumError if none is found.

    `start` (k, 4) is an initial guess of the axis (`axis_of`): ideal x, x, z and slope angle. Without it, or
    if it fails, the load is raised in steps.
    """
    model = mesh(beam, resolution or Resolution())
    if start is not None:
        try:
            return _newton(model, _from_axis(model, start), 1.0)
        except NoEquilibriumError:
            pass
    x, factor, step = model.ideal.copy(), 0.0, 0.25
    x[0] = held_face(model, 0, beam.near_tilt)[0]
    shape: Shape | None = None
    while factor < 1.0:
        try:
            shape = _newton(model, x, min(1.0, factor + step))
        except NoEquilibriumError:
            step /= 2
            if step < 0.01:
                raise
            continue
        x, factor, step = shape.x, min(1.0, factor + step), 1.5 * step
    assert shape is not None
    return shape


def axis_of(shape: Shape) -> Array:
    """Axis of a solved beam, shape (planes, 4): ideal x, then x, z and slope angle."""
    flat = shape.model.section.flat
    x = shape.x[:, flat]
    up = x[:, shape.model.section.nodes[flat, 1].argmax()] - x[:, shape.model.section.nodes[flat, 1].argmin()]
    centre = x.mean(axis=1)
    return np.stack(
        [shape.model.ideal[:, 0, 0], centre[:, 0], centre[:, 2], np.arctan2(-up[:, 0], up[:, 2])], axis=1
    )


def _from_axis(model: Model, start: Array) -> Array:
    """Prism bent along an axis, with the tilt, curvature and gap of the beam added approximately."""
    ideal, beam = model.ideal, model.beam
    at = ideal[:, 0, 0]
    cx, cz, slope = (np.interp(at, start[:, 0], start[:, k]) for k in (1, 2, 3))
    cx += np.minimum(at - start[0, 0], 0) + np.maximum(at - start[-1, 0], 0)
    share = np.clip(at / beam.length, 0, 1)
    if beam.bridge:
        cz = cz + beam.near_tilt * beam.length * share * (1 - share) ** 2
        slope = slope + beam.near_tilt * (1 - share) * (1 - 3 * share)
        cx = cx - beam.gap * share
    else:
        turn = beam.near_tilt + beam.curvature * at * 0.5
        c, s = np.cos(turn), np.sin(turn)
        cx, cz, slope = c * cx - s * cz, s * cx + c * cz, slope + turn
    # bent, an incompressible section narrows where it is stretched: Newton starts near J = 1
    bend = np.gradient(slope, at)[:, None] - beam.curvature
    y = ideal[..., 1] * (1 + bend * ideal[..., 2] / 2)
    z = ideal[..., 2] + bend * (ideal[..., 2] ** 2 - ideal[..., 1] ** 2) / 4
    return np.stack(
        [cx[:, None] - z * np.sin(slope)[:, None], y, cz[:, None] + z * np.cos(slope)[:, None]], axis=-1
    )


def _newton(model: Model, x: Array, factor: float) -> Shape:
    """Newton's method at `factor` of the load, on positions, pressures and angles of rotating clamps."""
    beam, x = model.beam, x.copy()
    ends = (0, -1) if beam.bridge else (0,)
    base = np.array([beam.near_tilt, 0.0][: len(ends)])
    spring = np.full(len(ends), np.inf)  # rotational stiffness over mu, for the half beam
    if beam.compliance:
        spring[:] = 0.5 / (beam.compliance * beam.mu)
    if beam.far_pinned and beam.bridge:
        spring[1] = 0.0
    loose = np.flatnonzero(np.isfinite(spring))
    turn = base.copy()
    p = np.zeros((len(model.element), model.bricks.pressure.shape[1]))
    if smallest_volume(model.bricks, x.reshape(-1, 3)[model.element]) <= 0.0:
        raise NoEquilibriumError("the start is turned inside out")
    for step in range(1, 13):
        slopes = []
        moves = np.zeros_like(x)
        for k, end in enumerate(ends):
            face, slope = held_face(model, end, float(turn[k]))
            moves[end] = face - x[end]
            slopes.append(slope)
        parts = assemble(
            model.bricks, x.reshape(-1, 3)[model.element], p, model.mu, beam.stiffening, beam.bulk_ratio
        )
        dx, dturn = newton_step(
            model, parts.force, parts.matrix, factor, moves, slopes, loose, spring, turn - base
        )
        largest = np.abs(dx).max()
        if not np.isfinite(largest) or largest > 20 * beam.length:
            break
        part = _admissible(model, x, dx)
        x = x + part * dx
        turn = turn + part * dturn
        du = dx.reshape(-1, 3)[model.element].reshape(len(p), -1)
        p = p + part * (parts.shift + np.einsum("ebk,ek->eb", parts.recover, du))
        if largest < 2e-7 and part == 1.0:
            return Shape(model, x, turn, step)
    raise NoEquilibriumError(f"no equilibrium within {step} Newton steps: {beam}")


def _admissible(model: Model, x: Array, dx: Array) -> float:
    """Fraction of a step (a power of 1/2) after which no element is inverted."""
    part = 1.0
    while smallest_volume(model.bricks, (x + part * dx).reshape(-1, 3)[model.element]) <= 0.0:
        part /= 2
        if part < 1e-2:
            raise NoEquilibriumError("elements turn inside out")
    return part
