"""A beam as a camera from the side sees it: its outline in the plane y = 0, and its centreline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._errors import MeshError
from tisim.mesh._mesh import Mesh


@dataclass(frozen=True, kw_only=True)
class Outline:
    """Polylines from the clamp to the other end, (x, z) [m]: upper and lower edge, and centreline, each
    (k, 2); x: where their points lie at rest [m], (k,)."""

    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    centreline: NDArray[np.float64]
    x: NDArray[np.float64]


def outline(mesh: Mesh, positions: NDArray[np.float64]) -> Outline:
    """Outline of a structured beam (`beam_mesh`) at nodal positions (n, 3) [m].

    The points are nodes of the plane y = 0, at every plane of nodes along x; between them the edge is a
    parabola (tet10) or a line.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.shape != mesh.nodes.shape:
        raise MeshError(
            f"positions must have shape {mesh.nodes.shape} as the mesh's nodes, got {positions.shape}"
        )
    x, y, z = mesh.nodes.T
    planes, place = np.unique(np.round(x, 12), return_inverse=True)
    lines = []
    for level in (z.max(), z.min(), 0.0):
        at = np.flatnonzero((y == 0) & (np.abs(z - level) < 1e-9))
        at = at[np.argsort(x[at])]
        if not np.array_equal(place[at], np.arange(len(planes))):
            raise MeshError("an outline needs a structured beam mesh, with nodes in line along x at y = 0")
        lines.append(positions[at][:, [0, 2]])
    return Outline(upper=lines[0], lower=lines[1], centreline=lines[2], x=planes)
