"""Simulated pokes as curves: force over shear modulus against depth, one simulation a geometry and change.

The material is neo-Hookean without gravity at a held K/G, so that the force is in exact proportion to its
shear modulus: one curve serves all moduli. Curves stay in memory for as long as the process runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from calibration.diagnosis.pokes._geometry import SHEAR, Geometry
from calibration.errors import InputError
from tisim import Mesh, Poke, Result, simulate

Array = NDArray[np.float64]

BEYOND = 0.3e-3  # simulated further than the record's depth [m]
STEP = 0.5e-3  # depths are rounded up to this [m], so that more pokes share a simulation
# Powers of the depth that the force begins with: Hertz's under a round tip; under a flat one with a round
# edge, which the surface wraps as it goes down, what an axisymmetric reference gave between 0.03 and 0.2
# radii.
ROUND, FLAT = 1.5, 1.08
LEAST = 3  # frames that a curve needs

Change = Callable[[Poke, Mesh | None], Poke]


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A poke to simulate: a geometry, and a change of it by name ("" for none), to at least `depth` [m].

    change: of the scene, given the unchanged poke's mesh, so that no remeshing hides a small change.
    """

    geometry: Geometry
    depth: float
    name: str = ""
    change: Change | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """Force along the rod, and across it (2), over the shear modulus [m2], against depth [m]: none at or
    above the surface, straight on beyond `reached`. status: of the simulation."""

    depth: Array
    along: Array
    across: Array
    reached: float
    round_tip: bool
    status: str
    core_seconds: float
    mesh: Mesh | None = None

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


_KNOWN: dict[tuple[Geometry, str], Curve] = {}


class Curves:
    """Simulates what is asked for and not known yet. simulated: how many pokes; core_seconds: of these."""

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers
        self.simulated = 0
        self.core_seconds = 0.0

    def fetch(self, wanted: Sequence[Wanted]) -> list[Curve]:
        """Their curves. InputError where a poke cannot be set up; ValueError where one has no answer at
        all."""
        bases = [Wanted(geometry=w.geometry, depth=w.depth) for w in wanted]
        self._simulate(bases)
        self._simulate([w for w in wanted if w.name])
        return [_KNOWN[(w.geometry, w.name)] for w in wanted]

    def _simulate(self, wanted: Sequence[Wanted]) -> None:
        missing: dict[tuple[Geometry, str], tuple[Wanted, float]] = {}
        for w in wanted:
            key = (w.geometry, w.name)
            known = _KNOWN.get(key)
            if known is not None and (known.reached >= w.depth or known.status != "converged"):
                continue
            depth = max(w.depth, missing[key][1] if key in missing else 0.0)
            missing[key] = (w, depth)
        if not missing:
            return
        scenes = []
        for w, depth in missing.values():
            highest = 0.9 * w.geometry.block.size[2] / abs(float(w.geometry.axis[2]))
            scene = w.geometry.scene(min(STEP * np.ceil((depth + BEYOND) / STEP), highest))
            if w.change is not None:
                scene = w.change(scene, _KNOWN[(w.geometry, "")].mesh)
            scenes.append(scene)
        try:
            results = simulate(scenes, workers=self.workers)
        except ValueError as error:
            raise InputError(f"pokes: {error}") from error
        for key, result in zip(missing, results, strict=True):
            _KNOWN[key] = _curve(result, key[0])
            self.simulated += 1
            self.core_seconds += result.cost.core_seconds + result.cost.mesh_seconds


def _curve(result: Result, geometry: Geometry) -> Curve:
    scene = result.scene
    assert isinstance(scene, Poke)
    if len(result.load) < LEAST:
        raise ValueError(f"a poke at {geometry.site} has no equilibrium ({result.message})")
    push = np.asarray(scene.direction, dtype=float)
    own = push / np.linalg.norm(push)  # a load cell sits on the rod, and tilts with it
    return Curve(
        depth=result.load,
        along=-(result.rod_force @ own) / SHEAR,
        across=-(result.rod_force @ geometry.across.T) / SHEAR,
        reached=float(result.load[-1]),
        round_tip=scene.rod.tip == "hemisphere",
        status=str(result.status),
        core_seconds=result.cost.core_seconds + result.cost.mesh_seconds,
        mesh=result.mesh,
    )
