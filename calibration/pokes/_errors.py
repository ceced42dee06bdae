"""What the simulator itself may err by, and the touch: nuisances of the pokes, relative to force and slope.

Measured on flat and round rods to 5 mm (docs/pokes.md): at refinement 1 the force is too high by up to 3 %,
one sign at all depths, and on top wanders by about 1 %, more at depths below 0.4 rod radii, where few cells
touch. It wanders as more cells come to touch, so with the width of the contact, which grows as the square
root of rod radius times depth, up and down once a cell, and each geometry has a share of its own in what all
have. All fall with the cell's square.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Relative sd at refinement 1: of all pokes together, and of each point by itself (contact points that come
# and go, the curve between its frames).
TOGETHER, SCATTER = 0.025, 0.002
# (relative sd, width of contact over the rod's radius over which it forgets itself) at refinement 1: up and
# down once a cell, and what a geometry has of its own at nearly all depths.
WANDERING = ((0.008, 0.04), (0.006, 0.5))
SHALLOW = 0.4  # over the rod's radius: the depth below which scatter and wandering grow
# Modes that hold less than this part of the largest one's variance are left out.
NEGLIGIBLE = 1e-6


def scatter(depth: Array, radius: float, refinement: float | Array) -> Array:
    """Relative sd of the simulated force at depths (k,), independent from point to point; refinement: one, or
    of each (k,)."""
    return np.asarray(SCATTER / refinement**2 * _shallow(depth, radius))


def wandering_modes(depth: Array, radius: float, refinement: float | Array) -> Array:
    """(k, m): what one sd of each of m independent modes adds to the force, relative, at depths (k,);
    refinement: one, or of each."""
    size = _shallow(depth, radius) / refinement**2
    width = refinement * np.sqrt(depth / radius)
    apart = width[:, None] - width[None, :]
    alike = sum((sd**2 * np.exp(-0.5 * (apart / over) ** 2) for sd, over in WANDERING), np.zeros_like(apart))
    values, vectors = np.linalg.eigh(np.outer(size, size) * alike)
    kept = values > NEGLIGIBLE * values[-1]
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))


def _shallow(depth: Array, radius: float) -> Array:
    """1 far down, 10 at most at the first touch."""
    shallow = SHALLOW * radius
    return np.asarray(np.sqrt(1.0 + (shallow / np.maximum(depth, 0.1 * shallow)) ** 2))
