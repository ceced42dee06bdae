"""Where a triangle surface cuts through itself."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def crossing_faces(shell: Any) -> NDArray[np.int64]:
    """Pairs (k, 2) of faces of a trimesh.Trimesh of which an edge of one passes through the other.

    Pairs that share an edge count as neighbours, and faces that overlap in one plane are not found.
    """
    pairs = _near_pairs(np.asarray(shell.triangles))
    faces = np.asarray(shell.faces)
    shared = (faces[pairs[:, 0], :, None] == faces[pairs[:, 1], None, :]).sum(axis=(1, 2))
    pairs = pairs[shared < 2]
    hit = _edges_pass(shell, pairs[:, 0], pairs[:, 1]) | _edges_pass(shell, pairs[:, 1], pairs[:, 0])
    return pairs[hit]


def _near_pairs(triangles: NDArray[np.float64]) -> NDArray[np.int64]:
    """Pairs of triangles whose boxes overlap, first < second: a sweep along the longest axis."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    axis = int(np.argmax(high.max(axis=0) - low.min(axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    # in this order, the boxes that start before box i ends are i + 1 ... stop[i] - 1
    stop = np.searchsorted(low[order, axis], high[order, axis], side="right")
    found = []
    for start in range(0, len(order), 256):
        rows = np.arange(start, min(start + 256, len(order)))
        columns = np.arange(start, stop[rows].max())
        i, j = order[rows][:, None], order[columns][None]
        overlap = ((low[i] <= high[j]) & (low[j] <= high[i])).all(axis=2) & (columns[None] > rows[:, None])
        a, b = np.nonzero(overlap)
        found.append(np.sort(np.stack([order[rows[a]], order[columns[b]]], axis=1), axis=1))
    return np.concatenate(found)


def _edges_pass(shell: Any, first: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether an edge of face first[k] passes through the inside of face second[k]."""
    faces, vertices = np.asarray(shell.faces), np.asarray(shell.vertices)
    corner = vertices[faces[second]]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(normal, axis=1)
    unit = normal / np.where(area > 0, area, 1.0)[:, None]
    # nearer than this to a plane or an edge is touching, not crossing
    slack = 1e-9 * np.linalg.norm(np.ptp(vertices, axis=0))
    hit = np.zeros(len(first), dtype=bool)
    for m in range(3):
        ends = faces[first][:, [m, (m + 1) % 3]]
        p, q = vertices[ends[:, 0]], vertices[ends[:, 1]]
        above = ((p - corner[:, 0]) * unit).sum(axis=1)
        below = ((q - corner[:, 0]) * unit).sum(axis=1)
        crosses = (np.minimum(above, below) < -slack) & (np.maximum(above, below) > slack)
        gap = np.where(crosses, above - below, 1.0)
        point = p + (above / gap)[:, None] * (q - p)
        inside = np.ones(len(first), dtype=bool)
        for k in range(3):
            a, b = corner[:, k], corner[:, (k + 1) % 3]
            side = (np.cross(b - a, point - a) * unit).sum(axis=1)
            inside &= side > slack * np.linalg.norm(b - a, axis=1)
        hit |= crosses & inside
    return hit
