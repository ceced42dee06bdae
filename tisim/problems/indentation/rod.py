"""Surface of the indenter, and its distance from the rigid base and inclusion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import Rod
from tisim.scene import Poke

Array = NDArray[np.float64]


def tissue_left(scene: Poke, tip: Array, axis: Array) -> tuple[float, str]:
    """Smallest distance [m] of the rod's surface from the nearest rigid body, and its name.

    Parameters
    ----------
    scene : Poke
    tip : ndarray of float, shape (3,)
        Centre of the rod's tip [m].
    axis : ndarray of float, shape (3,)
        Direction of the rod, towards its tip.

    Returns
    -------
    tuple of (float, str)
        The distance, at least 0, and "base" or "inclusion".
    """
    points = rod_surface(scene.rod, tip, axis).reshape(-1, 3)
    gaps = {"base": float(points[:, 2].min())}
    if scene.block.inclusion is not None:
        gaps["inclusion"] = float(scene.block.inclusion.signed_distance(points).min())
    nearest = min(gaps, key=lambda name: gaps[name])
    return max(gaps[nearest], 0.0), nearest


def rod_surface(rod: Rod, tip: Array, axis: Array, *, around: int = 40, piece: float = 1e-3) -> Array:
    """Outward quadrangles (k, 4, 3) [m] of a rod with its tip's centre at `tip`, pointing along `axis`.

    Parameters
    ----------
    rod : Rod
    tip, axis : ndarray of float, shape (3,)
        Centre of the tip [m] and direction towards it, of any length.
    around : int
        Number of quadrangles around the circumference.
    piece : float
        Largest length of a quadrangle along the shaft [m].
    """
    radius, height = _profile(rod, piece)
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


def _profile(rod: Rod, piece: float) -> tuple[Array, Array]:
    """Profile of the rod from the tip's centre to the far end: radius and height above the tip [m]."""
    edge = rod.edge
    angle = np.linspace(0.0, 0.5 * np.pi, 9)
    # short pieces along the shaft, so that sorting them by their centres (painter's algorithm) is correct
    shaft = np.linspace(edge, rod.length, max(2, int(np.ceil((rod.length - edge) / piece)) + 1))[1:]
    radius = np.concatenate([
        [0.0], rod.radius - edge + edge * np.sin(angle), np.full(len(shaft), rod.radius), [0.0],
    ])  # fmt: skip
    height = np.concatenate([[0.0], edge * (1.0 - np.cos(angle)), shaft, [rod.length]])
    return radius, height
