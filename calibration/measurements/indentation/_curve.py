"""Force over shear modulus against depth of a simulated indentation, from two meshes, with changes.

Forces are those of the finer mesh up to its largest depth, continued by those of the coarser mesh in
proportion. A change (an effect of the scene) is a ratio of forces on one mesh.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from calibration.measurements.indentation._scene import SHEAR, Geometry
from tisim import Mesh, Poke, Result

Array = NDArray[np.float64]

# Exponents of the depth at small depth: Hertz's for a hemisphere; for a flat indenter with a round edge, that
# of an axisymmetric reference between 0.03 and 0.2 radii.
ROUND, FLAT = 1.5, 1.08
LEAST = 3  # least number of frames of a curve
# Refinements of the two meshes.
COARSE, FINE = 0.7, 1.0
# Bandwidth, in contact width over indenter radius, of the smoothing of a change at refinement 1: about a
# quarter of the period of the oscillations of the force as cells come into contact (0.2 under a hemisphere,
# 0.4 under a flat indenter).
SMOOTH = 0.08


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """Force-depth curve of a simulated indentation.

    The force is zero at and above the surface. Beyond `reached` its root of power ROUND or FLAT is
    extrapolated linearly, and so are the forces across.

    Attributes
    ----------
    depth : depth of the frames [m], shape (f,).
    along : force along the indenter over the shear modulus [m2], shape (f,).
    across : force across it over the shear modulus [m2], shape (f, 2).
    reached : largest simulated depth [m].
    finer : largest depth of the finer mesh [m].
    round_tip : True for a hemisphere.
    status : status of the simulation.
    core_seconds : cost of the simulation [core s].
    mesh : mesh of the simulation.
    retraction_loss : depth over the largest depth, increasing to 1, and the fraction of the loading force
        that is lost at this depth in retraction, shape (n, 2).
    """

    depth: Array
    along: Array
    across: Array
    reached: float
    finer: float
    round_tip: bool
    status: str
    core_seconds: float
    mesh: Mesh | None = None
    retraction_loss: Array = field(default_factory=lambda: np.array([[0.0, 0.0], [1.0, 0.0]]))

    def at(self, depth: Array) -> Array:
        """Force along the indenter in loading [m2], shape (k,)."""
        power = ROUND if self.round_tip else FLAT
        root = _interpolated(self.depth, np.maximum(self.along, 0.0) ** (1.0 / power), depth)
        return np.asarray(np.maximum(root, 0.0) ** power)

    def retracting(self, depth: Array, deepest: Array) -> Array:
        """Force along the indenter in retraction from `deepest` [m2], shape (k,).

        The lost fraction of the force depends on the fraction of the largest depth only.
        """
        fraction = np.clip(depth / np.maximum(deepest, 1e-9), 0.0, 1.0)
        return np.asarray(self.at(depth) * (1.0 - np.interp(fraction, *self.retraction_loss.T)))

    def slope(self, depth: Array, over: float = 1e-6) -> Array:
        """Central difference quotient of `at` over +-`over` [m], shape (k,); nonzero near first touch."""
        return np.asarray((self.at(depth + over) - self.at(depth - over)) / (2.0 * over))

    def sides(self, depth: Array) -> Array:
        """Force across the indenter [m2], shape (k, 2)."""
        parts = [_interpolated(self.depth, side, depth) for side in self.across.T]
        return np.column_stack(parts)


def _interpolated(depth: Array, values: Array, at: Array) -> Array:
    x, y = np.r_[0.0, depth], np.r_[0.0, values]
    curve = PchipInterpolator(x, y)
    inside = curve(np.clip(at, 0.0, x[-1]))
    slope = (y[-1] - y[-2]) / (x[-1] - x[-2])
    return np.asarray(inside + slope * np.maximum(at - x[-1], 0.0))


def curve_of(result: Result, geometry: Geometry) -> Curve:
    """Curve of a simulated scene of a geometry."""
    scene = result.scene
    assert isinstance(scene, Poke)
    push = np.asarray(scene.direction, dtype=float)
    own = push / np.linalg.norm(push)  # the load cell sits on the indenter, and tilts with it
    assert result.rod_force is not None  # every indentation has one
    along = -(result.rod_force @ own) / SHEAR
    loading = int(np.argmax(result.load)) + 1 if len(result.load) else 0
    reached = float(result.load[loading - 1]) if loading else 0.0
    found = Curve(
        depth=result.load[:loading],
        along=along[:loading],
        across=-(result.rod_force[:loading] @ geometry.across.T) / SHEAR,
        reached=reached,
        finer=reached if scene.refinement == FINE * geometry.refinement else 0.0,
        round_tip=scene.rod.tip == "hemisphere",
        status=str(result.status),
        core_seconds=result.cost.core_seconds + result.cost.mesh_seconds,
        mesh=result.mesh,
    )
    if len(result.load) - loading < LEAST:
        return found
    depth, force = result.load[loading:][::-1], along[loading:][::-1]
    missing = 1.0 - force / found.at(depth)
    loss = np.column_stack([np.r_[depth / reached, 1.0], np.r_[missing, 0.0]])
    return replace(found, retraction_loss=loss)


def deepened(fine: Curve, coarse: Curve) -> Curve:
    """Forces of the finer mesh, continued by those of the coarser mesh times their ratio at its end."""
    below = coarse.depth > fine.reached
    end = np.array([fine.reached])
    ratio = float((fine.at(end) / coarse.at(end))[0])
    # forces across the indenter can be zero: their difference is additive, not a ratio
    aside = fine.sides(end)[0] - ratio * coarse.sides(end)[0]
    return replace(
        coarse,
        depth=np.concatenate([fine.depth, coarse.depth[below]]),
        along=np.concatenate([fine.along, ratio * coarse.along[below]]),
        across=np.concatenate([fine.across, ratio * coarse.across[below] + aside]),
        finer=fine.reached,
    )


def changed(base: Curve, pairs: Sequence[tuple[Curve, Curve, float]], radius: float) -> Curve:
    """Curve with a change that was simulated on one mesh or several.

    The ratio of forces with and without the change is smoothed over the contact width, since cells come into
    contact at different depths in the two simulations.

    Parameters
    ----------
    base : curve without the change.
    pairs : curves with and without the change, and the refinement of their mesh; the finest first, each used
        beyond the largest depth of those before.
    radius : radius of the indenter [m].
    """
    depth, ratio, aside = np.zeros(0), np.zeros(0), np.zeros((0, 2))
    for with_it, plain, refinement in pairs:
        below = with_it.depth > (depth[-1] if depth.size else 0.0)
        at = with_it.depth[below]
        unit = plain.at(with_it.depth)
        width = np.sqrt(with_it.depth / radius)
        own_ratio = smoothed(width, with_it.along / unit, SMOOTH / refinement)
        moved = (with_it.across - plain.sides(with_it.depth)) / unit[:, None]
        depth, ratio = np.concatenate([depth, at]), np.concatenate([ratio, own_ratio[below]])
        aside = np.concatenate([aside, moved[below]])
    unit = base.at(depth)
    return replace(
        pairs[-1][0],
        depth=depth,
        along=ratio * unit,
        across=base.sides(depth) + aside * unit[:, None],
        reached=float(depth[-1]),
        finer=base.finer,
    )


def smoothed(x: Array, values: Array, width: float) -> Array:
    """Smooth values at x (k,) by local linear regression with Gaussian weights of sd `width`."""
    found = np.empty(x.size)
    for k in range(x.size):
        apart = x - x[k]
        weight = np.exp(-0.5 * (apart / width) ** 2)
        mean = weight @ apart / weight.sum()
        spread = weight @ (apart - mean) ** 2
        middle = weight @ values / weight.sum()
        slope = weight @ ((apart - mean) * values) / spread if spread > 1e-6 * width**2 else 0.0
        found[k] = middle - slope * mean
    return found
