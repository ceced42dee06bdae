"""Cache of simulated indentations, one per geometry and change, on two meshes.

The material is neo-Hookean without gravity at a fixed K/G, so that the force is exactly proportional to its
shear modulus: one curve is valid for all moduli. Curves stay in memory for the lifetime of the process.
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
from tisim import Mesh, Poke, Status, simulate

Array = NDArray[np.float64]

BEYOND = 0.3e-3  # margin of the simulated depth over the record's [m]
STEP = 0.5e-3  # depths are rounded up to multiples of this [m], so that more indentations share a simulation
TURN = 0.1e-3  # the same for depths from which an indenter is retracted
HIGHEST = 0.05  # end of the retraction, as a fraction of the depth
# Largest depth on the finer mesh, in radii of the indenter. For flat indenters of 2.5 to 4 mm and a
# hemisphere the error of the coarser mesh is 1 to 3 %, oscillating as cells come into contact, that of the
# finer 0.5 %.
FINER_TO = 1.5

Change = Callable[[Poke, Mesh | None], Poke]


@dataclass(frozen=True, kw_only=True)
class CurveRequest:
    """Request for a curve up to at least a depth.

    Attributes
    ----------
    geometry : geometry of the indentation.
    depth : least depth [m].
    name : name of a change of the scene; "" for none.
    change : function from the unchanged scene and its mesh to the scene with the change; the mesh is reused
        so that remeshing does not mask a small change.
    finer : True if the change is simulated on the finer mesh too.
    retracts : True if the indenter is retracted from that depth.
    """

    geometry: Geometry
    depth: float
    name: str = ""
    change: Change | None = None
    finer: bool = False
    retracts: bool = False

    def unchanged(self) -> CurveRequest:
        """Request without the change and the retraction."""
        return replace(self, name="", change=None, retracts=False)


_KNOWN: dict[tuple[Geometry, str, float], Curve] = {}


class CurveCache:
    """Cache of curves, shared by the process; simulates requested curves that are missing.

    Curves without a change use the finer mesh, since a record's misfit is compared with the mesh error.
    Changes are simulated on the coarser mesh and applied in proportion, unless requested on the finer mesh.

    Attributes
    ----------
    workers : number of processes, as in `tisim.simulate`.
    simulated : number of simulations by this object.
    core_seconds : cost of these simulations [core s].
    """

    def __init__(self, workers: int | None = None) -> None:
        self.workers = workers
        self.simulated = 0
        self.core_seconds = 0.0

    def fetch(self, requests: Sequence[CurveRequest]) -> list[Curve]:
        """Curves of these requests, in their order.

        Raises
        ------
        InputError
            If a scene cannot be set up.
        ValueError
            If a simulation on the coarser mesh finds fewer than LEAST equilibria.
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
            if result.status is Status.NOT_MESHED:
                raise InputError(f"indentation: {result.message}")
            # a finer mesh without a solution is replaced by the coarser one
            if refinement == COARSE and len(result.load) < LEAST:
                raise ValueError(f"an indentation at {key[0].site} has no equilibrium ({result.message})")
            _KNOWN[key] = curve_of(result, key[0])
            self.simulated += 1
            self.core_seconds += result.cost.core_seconds + result.cost.mesh_seconds


def _scene(r: CurveRequest, depth: float, refinement: float) -> Poke:
    highest = 0.9 * r.geometry.block.size[2] / abs(float(r.geometry.axis[2]))
    # the loss in retraction depends on the depth of reversal
    to = TURN * np.ceil(depth / TURN) if r.retracts else STEP * np.ceil((depth + BEYOND) / STEP)
    to = min(float(to), highest)
    scene = r.geometry.scene(to, refinement=refinement)
    if r.retracts:
        scene = replace(scene, retract_to=HIGHEST * to)
    if r.change is not None:
        scene = r.change(scene, _KNOWN[(r.geometry, "", refinement)].mesh)
    return scene


def finer_to(geometry: Geometry) -> float:
    """Largest depth of simulations on the finer mesh [m].

    At larger depth more cells are in contact, and each new one has a smaller effect.
    """
    return FINER_TO * geometry.rod.radius
