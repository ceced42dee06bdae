"""The surface of a rod as quadrangles, for pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import Rod

Array = NDArray[np.float64]


def rod_surface(rod: Rod, tip: Array, axis: Array, *, around: int = 40) -> Array:
    """Quadrangles (k, 4, 3) [m], outward, of a rod with its tip's centre at `tip`, pointing along `axis`."""
    radius, height = _profile(rod)
    axis = axis / np.linalg.norm(axis)
    u = np.cross(axis, [1.0, 0.0, 0.0] if abs(axis[0]) < 0.9 else [0.0, 1.0, 0.0])
    u /= np.linalg.norm(u)
    v = np.cross(-axis, u)
    turn = np.linspace(0.0, 2.0 * np.pi, around + 1)
    circle = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    rings = tip - height[:, None, None] * axis + radius[:, None, None] * circle
    low, high = rings[:-1], rings[1:]
    quads = np.stack([low[:, :-1], low[:, 1:], high[:, 1:], high[:, :-1]], axis=2)
    return quads.reshape(-1, 4, 3)


def _profile(rod: Rod) -> tuple[Array, Array]:
    """Radius of the rod and height above its tip, from the tip's centre to the far end and its axis."""
    edge = rod.radius if rod.tip == "hemisphere" else min(rod.edge_radius, rod.radius)
    angle = np.linspace(0.0, 0.5 * np.pi, 9)
    # short pieces along the shaft, so that a painter's order of their centres is right
    shaft = np.linspace(edge, rod.length, max(2, int(np.ceil((rod.length - edge) / 1e-3)) + 1))[1:]
    radius = np.concatenate([
        [0.0], rod.radius - edge + edge * np.sin(angle), np.full(len(shaft), rod.radius), [0.0],
    ])  # fmt: skip
    height = np.concatenate([[0.0], edge * (1.0 - np.cos(angle)), shaft, [rod.length]])
    return radius, height
