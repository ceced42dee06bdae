"""Tetrahedra from columns of hexahedra and wedges, their diagonals matching from column to column."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.integer]


def tetrahedra(elements: Ints, column: Ints) -> NDArray[np.int32]:
    """Three tetrahedra for each wedge and six for each hexahedron, shape (t, 4).

    elements: hex8 that stand upright, shape (m, 8), a wedge with its third node repeated.
    column: per node, the rank of the column it belongs to; a diagonal starts in the column of lower rank,
    below, so that both elements at a facet cut it the same way.
    """
    c = column[elements[:, :4]]
    turn = (c.argmin(axis=1)[:, None] + np.arange(4)) % 4
    rows = np.arange(len(elements))[:, None]
    wedge = c[:, 2] == c[:, 3]
    quad, turn = elements[~wedge], turn[~wedge]
    rows = rows[: len(quad)]
    below, above = quad[:, :4][rows, turn], quad[:, 4:][rows, turn]
    bottom = np.concatenate([elements[wedge, :3], below[:, [0, 1, 2]], below[:, [0, 2, 3]]])
    top = np.concatenate([elements[wedge][:, 4:7], above[:, [0, 1, 2]], above[:, [0, 2, 3]]])

    c = column[bottom]
    turn = (c.argmin(axis=1)[:, None] + np.arange(3)) % 3
    rows = np.arange(len(bottom))[:, None]
    (p0, q0, r0), (p1, q1, r1), (_, cq, cr) = bottom[rows, turn].T, top[rows, turn].T, c[rows, turn].T
    first = cq < cr
    last = np.where(first[:, None], np.stack([p0, q0, r0, r1], axis=1), np.stack([p0, q0, r0, q1], axis=1))
    middle = np.where(first[:, None], np.stack([p0, q0, r1, q1], axis=1), np.stack([p0, r0, r1, q1], axis=1))
    return np.concatenate([np.stack([p1, r1, q1, p0], axis=1), middle, last]).astype(np.int32)
