"""What the simulator itself may err by, and the touch: nuisances of the pokes, relative to force and slope.

Measured on flat and round rods to 5 mm (docs/pokes.md): at refinement 1 the force is too high by up to 3 %,
one sign at all depths, and on top wanders by about 1 %, more at depths below 0.4 rod radii, where few cells
touch. It wanders as more cells come to touch, so with the width of the contact, which grows as the square
root of rod radius times depth, up and down once a cell. Both fall with the cell's square.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Relative sd at refinement 1: of all pokes together, of what changes with depth, and of each point by itself
# (contact points that come and go, the curve between its frames).
TOGETHER, WANDERING, SCATTER = 0.025, 0.01, 0.002
# Over the rod's radius: the depth below which the last two grow, and the width of contact over which the
# wandering forgets itself (a quarter of a cell, at refinement 1).
SHALLOW, WIDTH = 0.4, 0.04
# Modes that hold less than this part of the largest one's variance are left out.
NEGLIGIBLE = 1e-6


def scatter(depth: Array, radius: float, refinement: float | Array) -> Array:
    """Relative sd of the simulated force at depths (k,), independent from point to point; refinement: one, or
    of each (k,)."""
    return np.asarray(SCATTER / refinement**2 * _shallow(depth, radius))


def wandering_modes(depth: Array, radius: float, refinement: float | Array) -> Array:
    """(k, m): what one sd of each of m independent modes adds to the force, relative, at depths (k,);
    refinement: one, or of each."""
    sd = WANDERING / refinement**2 * _shallow(depth, radius)
    width = refinement * np.sqrt(depth / radius)
    apart = (width[:, None] - width[None, :]) / WIDTH
    values, vectors = np.linalg.eigh(np.outer(sd, sd) * np.exp(-0.5 * apart**2))
    kept = values > NEGLIGIBLE * values[-1]
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))


def _shallow(depth: Array, radius: float) -> Array:
    """1 far down, 10 at most at the first touch."""
    shallow = SHALLOW * radius
    return np.asarray(np.sqrt(1.0 + (shallow / np.maximum(depth, 0.1 * shallow)) ** 2))
