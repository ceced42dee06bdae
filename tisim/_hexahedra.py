"""How much of each hexahedron's energy its tetrahedra carry: more, the more they are out of shape.

`tisim._quadrature` gives every hexahedron one point with its mean gradient and the points of the
tetrahedra it is cut into. The tetrahedra keep it from folding and make it too stiff: few of them are right
where it keeps its shape, many where a rod's edge folds it. So their part rises with the worst of its
tetrahedra, at the last equilibrium, and falls only while the rod is drawn back: were it to stay, the way
back would be stiffer than the way there. Within a load step it is fixed, and the energy is one function.
Any part passes the patch test, and a finer mesh, whose elements keep their shape, ends at the small one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim._quadrature import TETRAHEDRAL_PART, Reference
from tisim.mesh import Mesh
from tisim.mesh._reference import HEX_CUTS

Array = NDArray[np.float64]

# The part of tetrahedra in hexahedra whose worst one keeps less than CRUSHED of its share of the volume.
LARGEST_PART = 1.0
# Where the part begins to rise, and where it is the largest. Rising earlier, from 0.5 to 0.15, a thin cover
# over an inclusion, squeezed to half, is 10 % too stiff at the default mesh and 7 % on one 2.6 times finer.
BENT, CRUSHED = 0.3, 0.05


class TetrahedralParts:
    """Weights of a reference (changed in place) by the distortion the hexahedra have had so far."""

    def __init__(self, mesh: Mesh, reference: Reference) -> None:
        self._elements = mesh.elements
        self._weights = reference.weights
        self._volume = reference.weights.sum(axis=1)
        # each cut fills the hexahedron, so that both count half; 0 where a tetrahedron of a wedge vanishes
        self._whole = reference.weights[:, 1:] / TETRAHEDRAL_PART
        self._there = self._whole > 0.0
        self._rest = np.where(self._there, 2.0 * self._whole, 1.0)
        self._worst = np.ones(mesh.n_elements)
        self.mends = False  # whether a part may fall again

    def update(self, x: Array) -> None:
        """Take positions x (n, 3) into account."""
        corners = x[self._elements][:, HEX_CUTS]
        a, b, c = (corners[:, :, k] - corners[:, :, 0] for k in (1, 2, 3))
        volume = (a * np.cross(b, c)).sum(axis=2) / 6.0
        mean = np.where(self._there, volume, 0.0).sum(axis=1) / (2.0 * self._volume)
        least = np.where(self._there, volume / self._rest, np.inf).min(axis=1)
        self._worst = least / mean if self.mends else np.minimum(self._worst, least / mean)
        t = np.clip((BENT - self._worst) / (BENT - CRUSHED), 0.0, 1.0)
        part = TETRAHEDRAL_PART + (LARGEST_PART - TETRAHEDRAL_PART) * t * t * (3.0 - 2.0 * t)
        self._weights[:, 1:] = part[:, None] * self._whole
        self._weights[:, 0] = (1.0 - part) * self._volume
