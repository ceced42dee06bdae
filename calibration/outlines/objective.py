"""Traced outlines of all beams of one material, as whitened residuals: the likelihood under the noise that
the lab states, with registration, radius, free length and density as nuisances."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, MaterialBelief, TracedOutline
from calibration.outlines._admitted import Admitted, admitted
from calibration.outlines._edges import Feet, edges, feet
from calibration.outlines._noise import (
    Nuisances,
    contour_root,
    registration_columns,
    smooth_basis,
    whiten,
)
from calibration.outlines.fidelity import COARSE, REFERENCE, Fidelity, beam_scene
from calibration.outlines.setup import Setup
from tisim import Beam, Circle, Material, Result, simulate

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Photograph:
    """One traced photograph of a trial; root: of its contour error's covariance; smooth: orthonormal basis
    of what a parameter can do to its distances, see `smooth_basis`."""

    name: str
    trial: int
    outline: TracedOutline
    root: Array
    smooth: Array


MESH_LEFT = 0.2

# Nearer to a clamp than this part of the section's half height, the edge is left out: its shape is that of a
# corner singularity, on which meshes that agree elsewhere to 0.02 mm differ by 0.1 mm and more.
CLAMP_ZONE = 0.5


def away_from_clamps(outline: TracedOutline, trial: BeamTrial, *, zone: float = CLAMP_ZONE) -> TracedOutline:
    """The outline without the points nearer to a clamp than `zone` half heights of the section; InputError
    where fewer than 3 an edge are left."""
    section = trial.section
    half = section.radius if isinstance(section, Circle) else section.height / 2.0
    end = trial.free_length if trial.supports == "clamped-clamped" else np.inf

    def kept(edge: Array) -> Array:
        # where the far end is held, x of the free part at rest and bent agree there
        return edge[(edge[:, 0] > zone * half) & (edge[:, 0] < end - zone * half)]

    upper, lower = kept(outline.upper), kept(outline.lower)
    if min(len(upper), len(lower)) < 3:
        raise InputError(
            f"trial {trial.id}: outline: expected at least 3 points an edge that lie further than"
            f" {zone * half * 1e3:.1f} mm from the clamps"
        )
    return replace(outline, upper=upper, lower=lower)


class OutlineObjective:
    """All traced outlines of one material's beams. `residuals` needs `linearise` first: the nuisances'
    columns and the mesh's error are taken there, once, and hold while the material stays near.

    fidelity: of the beams that a search solves; reference: of those that correct them (None: no correction).
    uncorrected: why there is no correction, where the law has no equilibrium on the reference mesh.
    What the reference still misses is a nuisance, one amplitude a trial, of MESH_LEFT times the correction.
    setup: what is known of rig and camera, applied to every scene and picture; its doubts are nuisances.
    """

    def __init__(
        self,
        trials: Sequence[BeamTrial],
        belief: MaterialBelief,
        *,
        fidelity: Fidelity = COARSE,
        reference: Fidelity | None = REFERENCE,
        setup: Setup | None = None,
        workers: int | None = None,
    ) -> None:
        self.trials = [t for t in trials if any(c.outline for c in t.captures)]
        if belief.density is None:
            raise InputError(
                f"experiment.yaml: materials.{belief.name}.density_kg_m3: expected, since a beam's shape"
                " tells only the ratio of weight to stiffness"
            )
        self.name = f"outlines of {belief.name}"
        self.belief = belief
        self.density = belief.density
        self.fidelity = fidelity
        self.reference = reference
        self.setup = setup
        self.workers = workers
        self.photographs = []
        for i, t in enumerate(self.trials):
            for c in t.captures:
                if c.outline is not None:
                    traced = away_from_clamps(c.outline, t)
                    name = f"{t.id} at {c.time:g} s"
                    self.photographs.append(
                        Photograph(name, i, traced, contour_root(traced), smooth_basis(traced))
                    )
        self.nuisances: Nuisances | None = None
        # distances [m] where the nuisances were taken: by the search's mesh, and by the reference
        self._base = self._fine = np.zeros(self.points)
        self.uncorrected = ""
        self._frozen = False

    @property
    def points(self) -> int:
        """Measured points: the count for a reduced chi-square."""
        return sum(len(p.root) for p in self.photographs)

    def size(self) -> int:
        if self.nuisances is None:
            raise RuntimeError("linearise an OutlineObjective before use")
        return self.points + len(self.nuisances.names)

    def linearise(self, material: Material) -> bool:
        """Take the nuisances' columns at a material; False where its beams have no equilibrium."""
        varied = list(admitted(self.trials, self.belief))
        if self._frozen:
            return True
        scenes = [self._beam(t, material) for t in self.trials]
        scenes += [scene for n in varied for scene in self._moved(n, material)]
        doubts = [] if self.setup is None else list(self.setup.doubts())
        scenes += [self._beam(t, material, setup=off) for _, off in doubts for t in self.trials]
        results = simulate(scenes, workers=self.workers)
        if not all(r.ok for r in results):
            return False
        fine = self._reference_beams(material)
        base, rest = results[: len(self.trials)], results[len(self.trials) :]
        columns, names = self._registrations(base)
        self._base = self._distances(base)
        self._fine = self._distances(fine) if fine else self._base
        if fine:
            left = MESH_LEFT * self._smooth(self._fine - self._base)
            for i, t in enumerate(self.trials):
                columns.append(self._whiten(np.where(self._of_trial(i), left, 0.0)))
                names.append(f"mesh of {t.id}")
        for n in varied:
            moved = list(base)
            for i in n.trials:
                moved[i] = rest.pop(0)
            # distance = data - model: one sd more of the nuisance takes this much off
            change = self._smooth(self._distances(moved) - self._base)
            columns.append(-self._whiten(change) * (n.sd / n.step))
            names.append(n.name)
        for name, off in doubts:
            moved = [rest.pop(0) for _ in self.trials]
            change = self._smooth(self._distances(moved, off) - self._base)
            if change.any():  # an effect may touch trials of one kind only
                columns.append(-self._whiten(change))
                names.append(name)
        self.nuisances = Nuisances(tuple(names), np.column_stack(columns))
        return True

    def residuals(self, materials: Sequence[Material]) -> Array:
        """(batch, size): whitened residuals with the nuisances at their best, NaN where a beam has no
        equilibrium. The sum of squares is chi-square under the whole covariance."""
        assert self.nuisances is not None, "linearise an OutlineObjective before use"
        found = np.full((len(materials), self.size()), np.nan)
        for k, results in enumerate(self.simulate(materials)):
            if all(r.ok for r in results):
                found[k] = self.nuisances.profile(self._whiten(self.corrected(results)))
        return found

    def corrected(self, results: Sequence[Result]) -> Array:
        """Distances of all points from simulated beams [m], (points,), the mesh's error taken out: those on
        the reference mesh where the nuisances were taken, and the smooth part of the change from there."""
        return self._fine + self._smooth(self._distances(results) - self._base)

    def subset(self, trials: Sequence[int]) -> OutlineObjective:
        """The same objective for some of the trials only; nuisances and mesh corrections stay as they were
        taken here, whatever is linearised later."""
        assert self.nuisances is not None, "linearise an OutlineObjective before use"
        part = copy(self)
        rows = np.concatenate([np.full(len(p.root), p.trial in trials) for p in self.photographs])
        part.trials = [self.trials[i] for i in trials]
        part.photographs = [
            replace(p, trial=list(trials).index(p.trial)) for p in self.photographs if p.trial in trials
        ]
        columns = self.nuisances.columns[rows]
        used = columns.any(axis=0)
        names = tuple(n for n, u in zip(self.nuisances.names, used, strict=True) if u)
        part.nuisances = Nuisances(names, columns[:, used])
        part._base, part._fine = self._base[rows], self._fine[rows]
        part._frozen = True
        return part

    def summary(self, material: Material) -> tuple[float, dict[str, float]]:
        """rms distance [m] once registration and the other nuisances are taken out, and the nuisances' best
        values [in their sd] at a material that has an answer."""
        left, named = self.registered(self.simulate([material])[0])
        return float(np.sqrt(np.mean(left**2))), named

    def distances_rms(self, material: Material) -> tuple[float, float]:
        """rms distance [m] as measured, and once the nuisances are taken out."""
        results = self.simulate([material])[0]
        raw, (left, _) = self.corrected(results), self.registered(results)
        return float(np.sqrt(np.mean(raw**2))), float(np.sqrt(np.mean(left**2)))

    def registered(self, results: Sequence[Result]) -> tuple[Array, dict[str, float]]:
        """Distances [m], (points,), with all nuisances taken out; their best values [in their sd]."""
        assert self.nuisances is not None, "linearise an OutlineObjective before use"
        whitened = self._whiten(self.corrected(results))
        b = self.nuisances.estimate(whitened)
        rest = whitened - self.nuisances.columns @ b
        left = np.concatenate([p.root @ part for p, part in self._by_photograph(rest)])
        return left, {n: float(x) for n, x in zip(self.nuisances.names, b, strict=True)}

    def simulate(self, materials: Sequence[Material]) -> list[list[Result]]:
        """Every trial with every material, as one batch of scenes."""
        # one trial after the other, so that neighbours in a batch share a mesh
        scenes = [self._beam(t, m) for t in self.trials for m in materials]
        results = simulate(scenes, workers=self.workers)
        n = len(materials)
        return [[results[i * n + k] for i in range(len(self.trials))] for k in range(n)]

    def distances(
        self, results: Sequence[Result], photograph: Photograph, setup: Setup | None = None
    ) -> list[Feet]:
        """Feet of a photograph's points, upper and lower edge, on the simulated beam as the camera shows it.

        setup: instead of the objective's own."""
        upper, lower = edges(results[photograph.trial])
        seen = setup or self.setup
        if seen is not None:
            trial = self.trials[photograph.trial]
            upper, lower = seen.image(upper, trial), seen.image(lower, trial)
        return [feet(photograph.outline.upper, upper), feet(photograph.outline.lower, lower)]

    def _beam(
        self,
        trial: BeamTrial,
        material: Material,
        fidelity: Fidelity | None = None,
        setup: Setup | None = None,
    ) -> Beam:
        beam = beam_scene(trial, material, density=self.density, fidelity=fidelity or self.fidelity)
        held = setup or self.setup
        return beam if held is None else held.bend(beam, trial)

    def _moved(self, nuisance: Admitted, material: Material) -> list[Beam]:
        return [nuisance.moved(self._beam(self.trials[i], material)) for i in nuisance.trials]

    def _distances(self, results: Sequence[Result], setup: Setup | None = None) -> Array:
        parts = [f.distance for p in self.photographs for f in self.distances(results, p, setup)]
        return np.concatenate(parts)

    def _by_photograph(self, values: Array) -> list[tuple[Photograph, Array]]:
        ends = np.cumsum([len(p.root) for p in self.photographs])[:-1]
        return list(zip(self.photographs, np.split(values, ends), strict=True))

    def _smooth(self, change: Array) -> Array:
        """The part of a change of distances that is smooth along each edge."""
        return np.concatenate([p.smooth @ (p.smooth.T @ part) for p, part in self._by_photograph(change)])

    def _whiten(self, distances: Array) -> Array:
        return np.concatenate([whiten(p.root, part) for p, part in self._by_photograph(distances)])

    def _reference_beams(self, material: Material) -> list[Result]:
        """The trials on the reference mesh, the longest first since that one fails if any; empty where one
        has no equilibrium there (`uncorrected` says so from then on: it is not tried again, since a beam
        without equilibrium costs a hundred times one that has it)."""
        if self.reference is None or self.uncorrected:
            return []
        order = sorted(range(len(self.trials)), key=lambda i: -self.trials[i].free_length)
        found: dict[int, Result] = {}
        for i in order if self.workers == 1 else [None]:
            some = [i] if i is not None else order
            beams = [self._beam(self.trials[k], material, self.reference) for k in some]
            found.update(zip(some, simulate(beams, workers=self.workers), strict=True))
            failed = [self.trials[k].id for k, r in found.items() if not r.ok]
            if failed:
                self.uncorrected = f"no equilibrium of {', '.join(failed)} on the finer mesh that corrects"
                return []
        return [found[i] for i in range(len(self.trials))]

    def _of_trial(self, trial: int) -> NDArray[np.bool_]:
        return np.concatenate([np.full(len(p.root), p.trial == trial) for p in self.photographs])

    def _registrations(self, results: Sequence[Result]) -> tuple[list[Array], list[str]]:
        columns: list[Array] = []
        names: list[str] = []
        first = 0
        for p in self.photographs:
            both = self.distances(results, p)
            block = np.vstack([registration_columns(f, p.outline.registration) for f in both])
            for column, what in zip(
                whiten(p.root, block).T, ("shift x", "shift z", "roll", "scale"), strict=True
            ):
                if column.any():
                    whole = np.zeros(self.points)
                    whole[first : first + len(column)] = column
                    columns.append(whole)
                    names.append(f"{what} of {p.name}")
            first += len(p.root)
        return columns, names
