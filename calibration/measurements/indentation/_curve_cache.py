"""Simulated indentations, one a geometry and change, on two meshes.

The material is neo-Hookean without gravity at a held K/G, so that the force is exactly proportional to its
shear modulus: one curve serves all moduli. Curves stay in memory for as long as the process runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.measurements.indentation._curve import (
    COARSE,
    FINE,
    LEAST,
    Curve,
    changed,
    curve_of,
    deepened,
)
from calibration.measurements.indentation._scene import Geometry
from tisim import Mesh, Poke, simulate

Array = NDArray[np.float64]

BEYOND = 0.3e-3  # simulated further than the record's depth [m]
STEP = 0.5e-3  # depths are rounded up to this [m], so that more indentations share a simulation
TURN = 0.1e-3  # likewise, depths from which an indenter is retracted
HIGHEST = 0.05  # fraction of its depth to which it is retracted
# How deep the finer mesh is followed, in radii of the indenter. On flat indenters of 2.5 to 4 mm and a ball
# the coarser one is 1 to 3 % off, in waves as cells come to touch, the finer 0.5 %.
FINER_TO = 1.5

Change = Callable[[Poke, Mesh | None], Poke]


@dataclass(frozen=True, kw_only=True)
class CurveRequest:
    """A curve to at least a depth.

    Attributes
    ----------
    depth : [m].
    name : of a change of the scene; "" for none.
    change : the scene with the change. It gets the unchanged scene and its mesh, so that no remeshing hides a
        small change.
    finer : the change is simulated on the finer mesh too.
    retracts : the indenter is retracted from that depth.
    """

    geometry: Geometry
    depth: float
    name: str = ""
    change: Change | None = None
    finer: bool = False
    retracts: bool = False

    def unchanged(self) -> CurveRequest:
        """The same without the change."""
        return replace(self, name="", change=None, retracts=False)


_KNOWN: dict[tuple[Geometry, str, float], Curve] = {}


class CurveCache:
    """Curves of this process; simulates those that are requested and not known yet.

    Curves without a change are those of the finer mesh, since a record's misfit is compared with the mesh
    error. Changes are simulated on the coarser one and count in proportion, unless they are requested on the
    finer one.

    Attributes
    ----------
    workers : processes, as in `tisim.simulate`.
    simulated : number of simulations.
    core_seconds : of these.
    """

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers
        self.simulated = 0
        self.core_seconds = 0.0

    def fetch(self, requests: Sequence[CurveRequest]) -> list[Curve]:
        """Their curves.

        Raises
        ------
        InputError : a scene cannot be set up.
        ValueError : a simulation has no equilibrium at all.
        """
        bases = [r.unchanged() for r in requests]
        finer = [r for r in requests if r.finer]
        for some in (bases, finer):
            self._simulate([replace(r, depth=min(r.depth, finer_to(r.geometry))) for r in some], FINE)
        short = [r for r in requests if not self._fine_suffices(r)]
        plain = [b for b, r in zip(bases, requests, strict=True) if r in short or not self._fine_suffices(b)]
        self._simulate(plain, COARSE)
        self._simulate([r for r in short if r.name], COARSE)
        return [self._of(r) for r in requests]

    def _fine_suffices(self, r: CurveRequest) -> bool:
        """True if the finer mesh reaches the requested depth."""
        fine = self._fine(r)
        return fine is not None and fine.reached >= r.depth

    def _fine(self, r: CurveRequest) -> Curve | None:
        found = _KNOWN.get((r.geometry, r.name, FINE))
        return found if found is not None and len(found.depth) >= LEAST else None

    def _of(self, r: CurveRequest) -> Curve:
        plain = r.unchanged()
        fine, coarse = self._fine(plain), _KNOWN.get((r.geometry, "", COARSE))
        base = fine
        if base is None or not (coarse is None or self._fine_suffices(plain)):
            assert coarse is not None
            base = coarse if base is None else deepened(base, coarse)
        if not r.name:
            return base
        pairs: list[tuple[Curve, Curve, float]] = []
        own = self._fine(r)
        if own is not None and fine is not None:
            pairs.append((own, fine, FINE * r.geometry.refinement))
        if not (pairs and self._fine_suffices(r)):
            assert coarse is not None
            own = _KNOWN[(r.geometry, r.name, COARSE)]
            pairs.append((own, coarse, COARSE * r.geometry.refinement))
        return changed(base, pairs, r.geometry.rod.radius)

    def _simulate(self, requests: Sequence[CurveRequest], refinement: float) -> None:
        missing: dict[tuple[Geometry, str, float], tuple[CurveRequest, float]] = {}
        for r in requests:
            key = (r.geometry, r.name, refinement)
            known = _KNOWN.get(key)
            if known is not None and (known.reached >= r.depth or known.status != "converged"):
                continue
            depth = max(r.depth, missing[key][1] if key in missing else 0.0)
            missing[key] = (r, depth)
        if not missing:
            return
        scenes = [_scene(r, depth, refinement) for r, depth in missing.values()]
        try:
            results = simulate(scenes, workers=self.workers)
        except ValueError as error:
            raise InputError(f"indentation: {error}") from error
        for key, result in zip(missing, results, strict=True):
            # a finer mesh without an answer is no obstacle: the coarser one remains
            if refinement == COARSE and len(result.load) < LEAST:
                raise ValueError(f"an indentation at {key[0].site} has no equilibrium ({result.message})")
            _KNOWN[key] = curve_of(result, key[0])
            self.simulated += 1
            self.core_seconds += result.cost.core_seconds + result.cost.mesh_seconds


def _scene(r: CurveRequest, depth: float, refinement: float) -> Poke:
    highest = 0.9 * r.geometry.block.size[2] / abs(float(r.geometry.axis[2]))
    # the loss in retraction goes with the depth that the indenter turns at
    to = TURN * np.ceil(depth / TURN) if r.retracts else STEP * np.ceil((depth + BEYOND) / STEP)
    to = min(float(to), highest)
    scene = r.geometry.scene(to, refinement=refinement)
    if r.retracts:
        scene = replace(scene, retract_to=HIGHEST * to)
    if r.change is not None:
        scene = r.change(scene, _KNOWN[(r.geometry, "", refinement)].mesh)
    return scene


def finer_to(geometry: Geometry) -> float:
    """Depth to which an indentation is simulated on the finer mesh [m]: further down more cells touch, and
    each new one matters less."""
    return FINER_TO * geometry.rod.radius
