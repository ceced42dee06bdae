"""Direction of the rod over time: it rotates about the point where its axis meets the surface."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tisim.scene import Poke

Array = NDArray[np.float64]

BETWEEN_TURNS = 4  # number of directions that sample a rotation in `axes`


def axis_at(scene: Poke, time: float) -> Array:
    """Unit vector along the rod towards its tip at a time [s], shape (3,)."""
    before, begin = _unit(scene.direction), 0.0
    for end, direction in scene.turns:
        axis = _unit(direction)
        if time < end:
            return _between(before, axis, (time - begin) / (end - begin))
        before, begin = axis, end
    return before


def axes(scene: Poke) -> Array:
    """Unit vectors (k, 3) that sample the rod's directions on its course."""
    times = [0.0, *(time for time, _ in scene.turns)]
    parts = np.arange(1, BETWEEN_TURNS + 1) / BETWEEN_TURNS
    between = [a + parts * (b - a) for a, b in pairwise(times)]
    return np.array([axis_at(scene, float(time)) for time in np.concatenate([[0.0], *between])])


def angle(a: Array, b: Array) -> float:
    """Angle between two unit vectors [rad]."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def rotation(a: Array, b: Array) -> Array:
    """Matrix (3, 3) of the shortest rotation that takes unit vector a to b, which must not be -a."""
    v = np.cross(a, b)
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    turned: Array = np.eye(3) + cross + cross @ cross / (1.0 + a @ b)
    return turned


def _unit(direction: tuple[float, float, float]) -> Array:
    vector = np.asarray(direction, dtype=float)
    return np.asarray(vector / np.linalg.norm(vector))


def _between(a: Array, b: Array, part: float) -> Array:
    """Unit vector at the fraction `part` of the shortest rotation from a to b."""
    whole = angle(a, b)
    if whole == 0.0:
        return a
    return np.asarray((np.sin((1.0 - part) * whole) * a + np.sin(part * whole) * b) / np.sin(whole))
