"""A simulated poke as a curve: force over shear modulus against depth, and what is lost on the way back."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from calibration.diagnosis.pokes._geometry import SHEAR, Geometry
from tisim import Mesh, Poke, Result

Array = NDArray[np.float64]

# Powers of the depth that the force begins with: Hertz's under a round tip; under a flat one with a round
# edge, which the surface wraps as it goes down, what an axisymmetric reference gave between 0.03 and 0.2
# radii.
ROUND, FLAT = 1.5, 1.08
LEAST = 3  # frames that a curve needs
# Refinements of the two meshes that pokes are simulated on.
COARSE, FINE = 1.0, 1.5


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """Force along the rod, and across it (2), over the shear modulus [m2], against depth [m]: none at or
    above the surface, straight on beyond `reached`; from the finer mesh to the depth `finer`. status: of the
    simulation. lost (n, 2): on the way back, parts of the deepest depth, from small to 1, and the part of the
    force that is missing there."""

    depth: Array
    along: Array
    across: Array
    reached: float
    finer: float
    round_tip: bool
    status: str
    core_seconds: float
    mesh: Mesh | None = None
    lost: Array = field(default_factory=lambda: np.array([[0.0, 0.0], [1.0, 0.0]]))

    def back(self, depth: Array, deepest: Array) -> Array:
        """Along the rod on the way back from a depth (k,): the same part of it is missing at the same part of
        the way, however deep it went."""
        part = np.clip(depth / np.maximum(deepest, 1e-9), 0.0, 1.0)
        return np.asarray(self.at(depth) * (1.0 - np.interp(part, *self.lost.T)))

    def at(self, depth: Array) -> Array:
        """Along the rod (k,)."""
        power = ROUND if self.round_tip else FLAT
        root = _interpolated(self.depth, np.maximum(self.along, 0.0) ** (1.0 / power), depth)
        return np.asarray(np.maximum(root, 0.0) ** power)

    def slope(self, depth: Array, over: float = 1e-6) -> Array:
        """[m] (k,): chord over a depth to either side, so that the touch is seen by points close to it."""
        return np.asarray((self.at(depth + over) - self.at(depth - over)) / (2.0 * over))

    def sides(self, depth: Array) -> Array:
        """Across it (k, 2)."""
        parts = [_interpolated(self.depth, side, depth) for side in self.across.T]
        return np.column_stack(parts)


def _interpolated(depth: Array, values: Array, wanted: Array) -> Array:
    x, y = np.r_[0.0, depth], np.r_[0.0, values]
    curve = PchipInterpolator(x, y)
    inside = curve(np.clip(wanted, 0.0, x[-1]))
    slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
    return np.asarray(inside + slope * np.maximum(wanted - x[-1], 0.0))


def curve_of(result: Result, geometry: Geometry) -> Curve:
    scene = result.scene
    assert isinstance(scene, Poke)
    push = np.asarray(scene.direction, dtype=float)
    own = push / np.linalg.norm(push)  # a load cell sits on the rod, and tilts with it
    along = -(result.rod_force @ own) / SHEAR
    there = int(np.argmax(result.load)) + 1 if len(result.load) else 0
    reached = float(result.load[there - 1]) if there else 0.0
    found = Curve(
        depth=result.load[:there],
        along=along[:there],
        across=-(result.rod_force[:there] @ geometry.across.T) / SHEAR,
        reached=reached,
        finer=reached if scene.refinement == FINE else 0.0,
        round_tip=scene.rod.tip == "hemisphere",
        status=str(result.status),
        core_seconds=result.cost.core_seconds + result.cost.mesh_seconds,
        mesh=result.mesh,
    )
    if len(result.load) - there < LEAST:
        return found
    depth, force = result.load[there:][::-1], along[there:][::-1]
    missing = 1.0 - force / found.at(depth)
    return replace(found, lost=np.column_stack([np.r_[depth / reached, 1.0], np.r_[missing, 0.0]]))
