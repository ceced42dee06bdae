"""Volumes of closed surfaces and of what they share, by winding numbers along parallel lines."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import NDArray

Array = NDArray[np.float64]

# The lines are put off the round coordinates on which bodies have their edges.
_OFFSET = (0.381966, 0.276393)


def shared_volume(
    first: trimesh.Trimesh, second: trimesh.Trimesh, *, spacing: float
) -> tuple[float, float, float]:
    """Volumes [m3] of the intersection, of the first and of the second body.

    Lines along z on a square grid of `spacing` [m]; along each line the winding number of a body changes by
    one where it passes the surface, and space with a positive number is inside.
    """
    if not spacing > 0:
        raise ValueError(f"spacing: expected a positive length, got {spacing}")
    low = np.minimum(first.bounds[0], second.bounds[0])[:2]
    events = [_crossings(np.asarray(m.triangles), low, spacing) for m in (first, second)]
    column = np.concatenate([e[0] for e in events])
    z = np.concatenate([e[1] for e in events])
    change = np.zeros((len(z), 2))
    n = len(events[0][0])
    change[:n, 0], change[n:, 1] = events[0][2], events[1][2]
    order = np.lexsort((z, column))
    column, z, change = column[order], z[order], change[order]
    # the changes along a whole line sum to zero, so one running sum serves all lines
    inside = np.cumsum(change, axis=0)[:-1] > 0.5
    step = np.where(np.diff(column) == 0, np.diff(z), 0.0) * spacing**2
    return (
        float(step[inside.all(axis=1)].sum()),
        float(step[inside[:, 0]].sum()),
        float(step[inside[:, 1]].sum()),
    )


def _crossings(triangles: Array, low: Array, spacing: float) -> tuple[NDArray[np.int64], Array, Array]:
    """Where the grid's lines pass a surface: line number, z [m], and +1 on the way in, -1 on the way out."""
    flat = (triangles[:, :, :2] - low) / spacing - np.array(_OFFSET)
    lowest, highest = np.ceil(flat.min(axis=1)), np.floor(flat.max(axis=1))
    size = np.maximum(highest - lowest + 1, 0).astype(np.int64)
    count = size.prod(axis=1)
    which = np.repeat(np.arange(len(flat)), count)
    rank = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    i = lowest[which, 0] + rank // size[which, 1]
    j = lowest[which, 1] + rank % size[which, 1]
    a, b, c = (flat[which, m] for m in range(3))
    p = np.column_stack([i, j])
    area = _cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):  # triangles that stand upright meet no line
        u, v, w = (_cross(c - b, p - b) / area, _cross(a - c, p - c) / area, _cross(b - a, p - a) / area)
    hit = (area != 0) & (u > 0) & (v > 0) & (w > 0)
    weights = np.column_stack([u, v, w])[hit]
    z = (weights * triangles[which[hit], :, 2]).sum(axis=1)
    number = (i[hit] + 2**20).astype(np.int64) * 2**22 + (j[hit] + 2**20).astype(np.int64)
    # a face that looks upwards (area > 0) is where a line going up leaves the body
    return number, z, -np.sign(area[hit])


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
