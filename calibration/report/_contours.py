"""Measured and simulated outlines of one material at one law's parameters, for drawing [m]."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.outlines import OutlineObjective
from calibration.study.calibration import Calibration
from tisim import Beam, Material, Result
from tisim.mesh import outline

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnEdge:
    """One edge of a photograph, k points: traced (k, 2); foot of each on the simulated edge (k, 2), with unit
    normal (k, 2); raw and left (k,): distance along it as traced and once nuisances are taken out, the mesh's
    error corrected in both; along (k,): distance from the clamp along the traced edge."""

    traced: Array
    foot: Array
    normal: Array
    raw: Array
    left: Array
    along: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnPhotograph:
    """sd: of the contour's error, as the lab states it."""

    name: str
    trial: str
    sd: float
    upper: DrawnEdge
    lower: DrawnEdge

    @property
    def edges(self) -> tuple[DrawnEdge, DrawnEdge]:
        return self.upper, self.lower

    @property
    def rms(self) -> tuple[float, float]:
        """rms distance as traced, and registered."""
        raw, left = (np.concatenate([getattr(e, n) for e in self.edges]) for n in ("raw", "left"))
        return float(np.sqrt(np.mean(raw**2))), float(np.sqrt(np.mean(left**2)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawn:
    """photographs of all trials; simulated: upper and lower edge by trial, free part, (m, 2) each.

    rms of all points once nuisances are taken out: what the fit calls rms.
    """

    photographs: tuple[DrawnPhotograph, ...]
    simulated: Mapping[str, tuple[Array, Array]]

    @property
    def rms(self) -> float:
        left = np.concatenate([e.left for p in self.photographs for e in p.edges])
        return float(np.sqrt(np.mean(left**2)))


def contours(outlines: OutlineObjective, chosen: Calibration) -> Drawn | None:
    """One simulation of each beam at the law's parameters; None where it has no equilibrium there.

    Nuisances are taken at these parameters, as the fit's last step takes them.
    """
    material = Material(law=chosen.law, parameters=dict(chosen.parameters), density=outlines.density)
    if not outlines.linearise(material):
        return None
    results = outlines.simulate([material])[0]
    if not all(r.ok for r in results):
        return None
    feet = [outlines.distances(results, p) for p in outlines.photographs]
    errors, _ = outlines.registered(results)
    ends = np.cumsum([len(p.root) for p in outlines.photographs])[:-1]
    left, raw = np.split(errors, ends), np.split(outlines.corrected(results), ends)
    photographs = []
    for i, p in enumerate(outlines.photographs):
        n = len(p.outline.upper)
        upper, lower = (
            DrawnEdge(
                traced=traced,
                foot=f.foot,
                normal=f.normal,
                raw=raw[i][part],
                left=left[i][part],
                along=_along(traced),
            )
            for traced, f, part in zip(
                (p.outline.upper, p.outline.lower), feet[i], (slice(n), slice(n, None)), strict=True
            )
        )
        trial = outlines.trials[p.trial].id
        photographs.append(
            DrawnPhotograph(name=p.name, trial=trial, sd=p.outline.sd, upper=upper, lower=lower)
        )
    return Drawn(photographs=tuple(photographs), simulated=_simulated(outlines, results))


def _along(edge: Array) -> Array:
    steps = np.linalg.norm(np.diff(edge, axis=0), axis=1)
    return edge[0, 0] + np.concatenate([[0.0], np.cumsum(steps)])


def _simulated(outlines: OutlineObjective, results: Sequence[Result]) -> dict[str, tuple[Array, Array]]:
    found = {}
    for trial, result in zip(outlines.trials, results, strict=True):
        seen = outline(result.mesh, result.positions[-1])
        scene = result.scene
        assert isinstance(scene, Beam)
        free = (seen.x >= -1e-9) & (seen.x <= scene.length + 1e-9)
        upper, lower = seen.upper[free], seen.lower[free]
        if outlines.setup is not None:  # drawn as the rig's camera shows it
            upper, lower = outlines.setup.image(upper, trial), outlines.setup.image(lower, trial)
        found[trial.id] = (upper, lower)
    return found
