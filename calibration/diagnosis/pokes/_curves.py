"""Simulated pokes, a simulation a geometry and change, on two meshes.

The material is neo-Hookean without gravity at a held K/G, so that the force is in exact proportion to its
shear modulus: one curve serves all moduli. Curves stay in memory for as long as the process runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._changes import changed, deepened
from calibration.diagnosis.pokes._curve import COARSE, FINE, LEAST, Curve, curve_of
from calibration.diagnosis.pokes._geometry import Geometry
from calibration.errors import InputError
from tisim import Mesh, Poke, simulate

Array = NDArray[np.float64]

BEYOND = 0.3e-3  # simulated further than the record's depth [m]
STEP = 0.5e-3  # depths are rounded up to this [m], so that more pokes share a simulation
TURN = 0.1e-3  # depths that a rod is drawn back from, likewise
HIGHEST = 0.05  # part of its depth to which it is drawn back
# How deep the finer mesh is followed, in radii of the rod. On flat rods of 2.5 to 4 mm and a ball the coarser
# one is 1 to 3 % off, in waves as cells come to touch, the finer 0.5 %.
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
        bases = [replace(w, name="", change=None, back=False) for w in wanted]
        finer = [w for w in wanted if w.finer]
        for some in (bases, finer):
            self._simulate([replace(w, depth=min(w.depth, finer_to(w.geometry))) for w in some], FINE)
        short = [w for w in wanted if not self._fine_suffices(w)]
        plain = [b for b, w in zip(bases, wanted, strict=True) if w in short or not self._fine_suffices(b)]
        self._simulate(plain, COARSE)
        self._simulate([w for w in short if w.name], COARSE)
        return [self._of(w) for w in wanted]

    def _fine_suffices(self, w: Wanted) -> bool:
        """Whether the finer mesh gives all that is wanted."""
        fine = self._fine(w)
        return fine is not None and fine.reached >= w.depth

    def _fine(self, w: Wanted) -> Curve | None:
        found = _KNOWN.get((w.geometry, w.name, FINE))
        return found if found is not None and len(found.depth) >= LEAST else None

    def _of(self, w: Wanted) -> Curve:
        plain = replace(w, name="", change=None, back=False)
        fine, coarse = self._fine(plain), _KNOWN.get((w.geometry, "", COARSE))
        if fine is not None and (coarse is None or self._fine_suffices(plain)):
            base = fine
        else:
            assert coarse is not None
            base = coarse if fine is None else deepened(fine, coarse)
        if not w.name:
            return base
        pairs: list[tuple[Curve, Curve, float]] = []
        own = self._fine(w)
        if own is not None and fine is not None:
            pairs.append((own, fine, FINE))
        if not (pairs and self._fine_suffices(w)):
            assert coarse is not None
            pairs.append((_KNOWN[(w.geometry, w.name, COARSE)], coarse, COARSE))
        return changed(base, pairs, w.geometry.rod.radius)

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
            _KNOWN[key] = curve_of(result, key[0])
            self.simulated += 1
            self.core_seconds += result.cost.core_seconds + result.cost.mesh_seconds


def finer_to(geometry: Geometry) -> float:
    """Depth [m] to which a poke is simulated on the finer mesh: further down more cells touch, and each new
    one matters less."""
    return FINER_TO * geometry.rod.radius
