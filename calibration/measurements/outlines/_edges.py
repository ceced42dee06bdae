"""A simulated beam as the tracer sees it: its two edges as fine polylines, distances along their normals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim import Beam, Result
from tisim.mesh import outline

Array = NDArray[np.float64]

PIECES = (
    24  # straight pieces an element: the chord of a strongly bent one 7 mm long is off by 0.3 micrometres
)


@dataclass(frozen=True, eq=False)
class Feet:
    """Where measured points meet an edge: signed distance [m] (positive outside the edge's left, (k,)),
    unit normals (k, 2) and feet (k, 2) [m]."""

    distance: Array
    normal: Array
    foot: Array


def edges(result: Result) -> tuple[Array, Array]:
    """Upper and lower edge of the free part of a beam, (m, 2) each: x, z [m], from the clamp to the end."""
    scene = result.scene
    assert isinstance(scene, Beam)
    seen = outline(result.mesh, result.positions[-1])
    free = (seen.x >= -1e-9) & (seen.x <= scene.length + 1e-9)
    quadratic = result.mesh.kind == "tet10"
    upper, lower = (_fine(line[free]) if quadratic else line[free] for line in (seen.upper, seen.lower))
    return upper, lower


def _fine(nodes: Array) -> Array:
    """Parabolas through end, middle and end of each element, as a polyline."""
    a, b, c = nodes[0:-2:2, None], nodes[1:-1:2, None], nodes[2::2, None]
    t = (np.arange(PIECES) / PIECES)[None, :, None]
    line = a * (1 - t) * (1 - 2 * t) + b * 4 * t * (1 - t) + c * t * (2 * t - 1)
    return np.vstack([line.reshape(-1, 2), nodes[-1:]])


def feet(points: Array, edge: Array) -> Feet:
    """Feet of measured points (k, 2) on an edge (m, 2); past either end the last piece goes on straight."""
    pieces = np.diff(edge, axis=0)
    length = np.linalg.norm(pieces, axis=1)
    along = pieces / length[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    start = edge[:-1]
    t = points @ along.T - np.einsum("jk,jk->j", start, along)
    off = points @ across.T - np.einsum("jk,jk->j", start, across)
    high, low = length.copy(), np.zeros_like(length)
    high[-1], low[0] = np.inf, -np.inf
    past = t - np.clip(t, low, high)
    nearest = (off * off + past * past).argmin(axis=1)
    reached = np.clip(t[np.arange(len(points)), nearest], low[nearest], high[nearest])
    at = start[nearest] + reached[:, None] * along[nearest]
    normal = across[nearest]
    return Feet(np.einsum("ik,ik->i", points - at, normal), normal, at)
