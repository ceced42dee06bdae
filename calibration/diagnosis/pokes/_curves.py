"""Simulated pokes as curves: force over shear modulus against depth, a simulation a geometry and change.

The material is neo-Hookean without gravity at a held K/G, so that the force is in exact proportion to its
shear modulus: one curve serves all moduli. Curves stay in memory for as long as the process runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from calibration.diagnosis.pokes._geometry import SHEAR, Geometry
from calibration.errors import InputError
from tisim import Mesh, Poke, Result, simulate

Array = NDArray[np.float64]

BEYOND = 0.3e-3  # simulated further than the record's depth [m]
STEP = 0.5e-3  # depths are rounded up to this [m], so that more pokes share a simulation
TURN = 0.1e-3  # depths that a rod is drawn back from, likewise
HIGHEST = 0.05  # part of its depth to which it is drawn back
# Powers of the depth that the force begins with: Hertz's under a round tip; under a flat one with a round
# edge, which the surface wraps as it goes down, what an axisymmetric reference gave between 0.03 and 0.2
# radii.
ROUND, FLAT = 1.5, 1.08
LEAST = 3  # frames that a curve needs
# Refinements of the two meshes, and how deep the finer one is followed, in radii of the rod. On flat rods of
# 2.5 to 4 mm and a ball the coarser one is 1 to 3 % off, in waves as cells come to touch, the finer 0.5 %.
COARSE, FINE = 1.0, 1.5
FINER_TO = 1.5

Change = Callable[[Poke, Mesh | None], Poke]


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A poke to simulate: a geometry, and a change of it by name ("" for none), to at least `depth` [m].

    change: of the scene, given the unchanged poke's mesh, so that no remeshing hides a small change. finer:
    the change is simulated on the finer mesh too. back: the rod is drawn back from that depth.
    """

    geometry: Geometry
    depth: float
    name: str = ""
    change: Change | None = None
    finer: bool = False
    back: bool = False


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


_KNOWN: dict[tuple[Geometry, str, float], Curve] = {}


class Curves:
    """Simulates what is asked for and not known yet. simulated: how many pokes; core_seconds: of these.

    Curves without a change are those of a finer mesh, since what a record departs by is compared with the
    mesh's error; changes are simulated on the coarser one, and count in proportion to it, unless asked for on
    the finer one.
    """

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers
        self.simulated = 0
        self.core_seconds = 0.0

    def fetch(self, wanted: Sequence[Wanted]) -> list[Curve]:
        """Their curves. InputError where a poke cannot be set up; ValueError where one has no answer at
        all."""
        bases = [replace(w, name="", change=None) for w in wanted]
        self._simulate([replace(w, depth=min(w.depth, finer_to(w.geometry))) for w in bases], FINE)
        finer = [w for w in wanted if w.finer]
        self._simulate([replace(w, depth=min(w.depth, finer_to(w.geometry))) for w in finer], FINE)
        short = [w for w in wanted if not self._fine_suffices(w)]
        self._simulate([replace(w, name="", change=None, back=False) for w in short], COARSE)
        self._simulate([w for w in short if w.name], COARSE)
        return [self._of(w) for w in wanted]

    def _fine_suffices(self, w: Wanted) -> bool:
        """Whether the finer mesh gives all that is wanted."""
        fine = _KNOWN.get((w.geometry, w.name, FINE))
        return fine is not None and fine.reached >= w.depth and len(fine.depth) >= LEAST

    def _of(self, w: Wanted) -> Curve:
        own = _KNOWN.get((w.geometry, w.name, FINE))
        if own is not None and len(own.depth) >= LEAST:
            return own if self._fine_suffices(w) else refined(own, _KNOWN[(w.geometry, w.name, COARSE)], None)
        fine = _KNOWN[(w.geometry, "", FINE)]
        coarse = _KNOWN[(w.geometry, "", COARSE)]
        change = _KNOWN[(w.geometry, w.name, COARSE)] if w.name else None
        return refined(fine, coarse, change) if len(fine.depth) >= LEAST else change or coarse

    def _simulate(self, wanted: Sequence[Wanted], refinement: float) -> None:
        missing: dict[tuple[Geometry, str, float], tuple[Wanted, float]] = {}
        for w in wanted:
            key = (w.geometry, w.name, refinement)
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
            # what is lost on the way back goes with the depth that the rod turns at
            to = TURN * np.ceil(depth / TURN) if w.back else STEP * np.ceil((depth + BEYOND) / STEP)
            to = min(float(to), highest)
            scene = w.geometry.scene(to, refinement=refinement)
            if w.back:
                scene = replace(scene, back=HIGHEST * to)
            if w.change is not None:
                scene = w.change(scene, _KNOWN[(w.geometry, "", refinement)].mesh)
            scenes.append(scene)
        try:
            results = simulate(scenes, workers=self.workers)
        except ValueError as error:
            raise InputError(f"pokes: {error}") from error
        for key, result in zip(missing, results, strict=True):
            # a finer mesh that has no answer is no obstacle: there is the coarser one
            if refinement == COARSE and len(result.load) < LEAST:
                raise ValueError(f"a poke at {key[0].site} has no equilibrium ({result.message})")
            _KNOWN[key] = _curve(result, key[0])
            self.simulated += 1
            self.core_seconds += result.cost.core_seconds + result.cost.mesh_seconds


def finer_to(geometry: Geometry) -> float:
    """Depth [m] to which a poke is simulated on the finer mesh: further down more cells touch, and each new
    one matters less."""
    return FINER_TO * geometry.rod.radius


def refined(fine: Curve, coarse: Curve, change: Curve | None) -> Curve:
    """What a change would be on the finer mesh, or without one what is deeper than it was followed: the
    coarser mesh's by the ratio of the forces of both meshes, at its end below that."""
    if change is None:
        below = coarse.depth > fine.reached
        depth = np.concatenate([fine.depth, coarse.depth[below]])
        source = coarse
    else:
        depth, source = change.depth, change
    inside = np.clip(depth, fine.depth[0], fine.reached)
    ratio = fine.at(inside) / coarse.at(inside)
    along, across = source.at(depth) * ratio, source.sides(depth) * ratio[:, None]
    # forces across the rod start from none where nothing tilts: what they are off by is no ratio
    across += fine.sides(inside) - coarse.sides(inside) * ratio[:, None]
    if change is None:
        above = len(fine.depth)
        along[:above], across[:above] = fine.along, fine.across
    return replace(source, depth=depth, along=along, across=across, finer=fine.reached)


def _curve(result: Result, geometry: Geometry) -> Curve:
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
