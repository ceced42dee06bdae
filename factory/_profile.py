"""What lies under each point of the top: stiffness profiles, and inclusions as point sets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import BoxInclusion, CylinderInclusion, Inclusion, SphereInclusion

LEVELS = 128
RIGID = 1.0


def inside(inclusion: Inclusion, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points [m], shape (..., 3), lie inside the inclusion (its surface included)."""
    local = points - np.asarray(inclusion.centre)
    if isinstance(inclusion, SphereInclusion):
        return np.asarray((local**2).sum(axis=-1) <= inclusion.radius**2)
    if isinstance(inclusion, CylinderInclusion):
        radial = (local[..., :2] ** 2).sum(axis=-1) <= inclusion.radius**2
        return np.asarray(radial & (np.abs(local[..., 2]) <= inclusion.height / 2))
    assert isinstance(inclusion, BoxInclusion)
    c, s = np.cos(inclusion.angle), np.sin(inclusion.angle)
    half = np.asarray(inclusion.size) / 2
    u = c * local[..., 0] + s * local[..., 1]
    v = -s * local[..., 0] + c * local[..., 1]
    return np.asarray((np.abs(u) <= half[0]) & (np.abs(v) <= half[1]) & (np.abs(local[..., 2]) <= half[2]))


def level_depths(height: float) -> NDArray[np.float64]:
    """Depths below the rest surface that the levels sample [m]: the middles of 128 equal layers."""
    return np.asarray((np.arange(LEVELS) + 0.5) * (height / LEVELS), dtype=np.float64)


def profiles(
    grid: NDArray[np.float64], height: float, inclusion: Inclusion, stiffness: float
) -> NDArray[np.uint8]:
    """Stiffness codes times 255 under each grid point, shape (rows, columns, 128), top level first.

    grid: rest positions of the grid points [m], shape (rows, columns, 3).
    stiffness: the silicone's code; the inclusion's is 1. A code is stored as round(255 code), which
    is exact for 1.0, 0.8, 0.4 and 0.0.
    """
    points = np.repeat(grid[:, :, None, :], LEVELS, axis=2)
    points[..., 2] -= level_depths(height)
    soft, rigid = round(255 * stiffness), round(255 * RIGID)
    return np.where(inside(inclusion, points), rigid, soft).astype(np.uint8)
