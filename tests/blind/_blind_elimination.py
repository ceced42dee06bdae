"""One Newton step of a meshed beam: layers condensed, then block elimination from clamp to end."""

from __future__ import annotations

import numpy as np
from _blind_model import Model
from numpy.typing import NDArray

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
    """Moves of the positions and turns of the clamps."""
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
    # columns: the load's right side with the faces moved as prescribed, then one for each loose clamp
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
    """Faces' moves (faces, n, columns) from the layers' matrices S (l, 2n, 2n) and forces f (faces, n) (first
    column only); `given` holds the moves of the held faces."""
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
