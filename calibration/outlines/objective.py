"""Traced outlines of all beams of one material, as whitened residuals: the likelihood under the noise that
the lab states, with registration, radius, free length and density as nuisances."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, MaterialBelief, TracedOutline
from calibration.outlines._edges import Feet, edges, feet
from calibration.outlines._noise import Nuisances, contour_root, registration_columns, whiten
from tisim import Beam, Circle, Material, Result, Solver, simulate

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """How beams are simulated in a search: `tisim.Beam`'s element, layer [m], rings and solver."""

    element: str = "default"
    layer: float = 0.007
    rings: int = 2
    solver: Solver = field(default_factory=lambda: Solver(tolerance=1e-6))


# The beams that a search solves (14 core-ms each), and those that correct them where nuisances are taken.
# What the search's mesh gets wrong (0.5 % of the deflection, waves of 10 to 20 micrometres along a strongly
# bent edge) is small and hardly depends on the material, but the likelihood of nine photographs sees it.
COARSE = Fidelity(rings=1)
REFERENCE = Fidelity(layer=0.0025, rings=4, solver=Solver(max_iterations=12))


@dataclass(frozen=True, eq=False)
class Photograph:
    """One traced photograph of a trial; root: of its contour error's covariance."""

    name: str
    trial: int
    outline: TracedOutline
    root: Array


# Nearer to a clamp than this part of the section's half height, the edge is left out: its shape is that of a
# corner singularity, on which meshes that agree elsewhere to 0.02 mm differ by 0.1 mm and more.
CLAMP_ZONE = 0.5


def away_from_clamps(outline: TracedOutline, trial: BeamTrial) -> TracedOutline:
    """The outline without the points next to a clamp; InputError where fewer than 3 an edge are left."""
    section = trial.section
    half = section.radius if isinstance(section, Circle) else section.height / 2.0
    end = trial.free_length if trial.supports == "clamped-clamped" else np.inf

    def kept(edge: Array) -> Array:
        # where the far end is held, x of the free part at rest and bent agree there
        return edge[(edge[:, 0] > CLAMP_ZONE * half) & (edge[:, 0] < end - CLAMP_ZONE * half)]

    upper, lower = kept(outline.upper), kept(outline.lower)
    if min(len(upper), len(lower)) < 3:
        raise InputError(
            f"trial {trial.id}: outline: expected at least 3 points an edge that lie further than"
            f" {CLAMP_ZONE * half * 1e3:.1f} mm from the clamps"
        )
    return replace(outline, upper=upper, lower=lower)


class OutlineObjective:
    """All traced outlines of one material's beams. `residuals` needs `linearise` first: the nuisances'
    columns and the mesh's error are taken there, once, and hold while the material stays near.

    fidelity: of the beams that a search solves; reference: of those that correct them (None: no correction).
    uncorrected: why there is no correction, where the law has no equilibrium on the reference mesh.
    What the reference still misses is a nuisance, one amplitude a trial, of the size of the correction.
    """

    def __init__(
        self,
        trials: Sequence[BeamTrial],
        belief: MaterialBelief,
        *,
        fidelity: Fidelity = COARSE,
        reference: Fidelity | None = REFERENCE,
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
        self.workers = workers
        self.photographs = []
        for i, t in enumerate(self.trials):
            for c in t.captures:
                if c.outline is not None:
                    traced = away_from_clamps(c.outline, t)
                    name = f"{t.id} at {c.time:g} s"
                    self.photographs.append(Photograph(name, i, traced, contour_root(traced)))
        self.nuisances: Nuisances | None = None
        self.correction: Array = np.zeros(self.points)
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
        varied = list(self._varied())
        if self._frozen:
            return True
        scenes = [self._beam(t, material) for t in self.trials]
        scenes += [scene for _, _, group in varied for scene in group(material)]
        results = simulate(scenes, workers=self.workers)
        if not all(r.ok for r in results):
            return False
        fine = self._reference_beams(material)
        base, rest = results[: len(self.trials)], results[len(self.trials) :]
        columns, names = self._registrations(base)
        start = self._whitened(base)
        self.correction = np.zeros(self.points)
        if fine:
            self.correction = self._whitened(fine) - start
            for i, t in enumerate(self.trials):
                columns.append(np.where(self._of_trial(i), self.correction, 0.0))
                names.append(f"mesh of {t.id}")
        for name, sd, group in varied:
            moved = list(base)
            for i in group.trials:
                moved[i] = rest.pop(0)
            # residual = data - model: one sd more of the nuisance takes this much off
            columns.append(-(self._whitened(moved) - start) * (sd / group.step))
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
                found[k] = self.nuisances.profile(self._whitened(results) + self.correction)
        return found

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
        part.correction = self.correction[rows]
        part._frozen = True
        return part

    def summary(self, material: Material) -> tuple[float, dict[str, float]]:
        """rms distance [m] once registration and the other nuisances are taken out, and the nuisances' best
        values [in their sd] at a material that has an answer."""
        assert self.nuisances is not None, "linearise an OutlineObjective before use"
        whitened = self._whitened(self.simulate([material])[0]) + self.correction
        b = self.nuisances.estimate(whitened)
        left = self._unwhitened(whitened - self.nuisances.columns @ b)
        named = {n: float(x) for n, x in zip(self.nuisances.names, b, strict=True)}
        return float(np.sqrt(np.mean(left**2))), named

    def distances_rms(self, material: Material) -> tuple[float, float]:
        """rms distance [m] as measured, and once the nuisances are taken out."""
        whitened = self._whitened(self.simulate([material])[0]) + self.correction
        return float(np.sqrt(np.mean(self._unwhitened(whitened) ** 2))), self.summary(material)[0]

    def _unwhitened(self, whitened: Array) -> Array:
        parts = []
        first = 0
        for p in self.photographs:
            parts.append(p.root @ whitened[first : first + len(p.root)])
            first += len(p.root)
        return np.concatenate(parts)

    def simulate(self, materials: Sequence[Material]) -> list[list[Result]]:
        """Every trial with every material, as one batch of scenes."""
        # one trial after the other, so that neighbours in a batch share a mesh
        scenes = [self._beam(t, m) for t in self.trials for m in materials]
        results = simulate(scenes, workers=self.workers)
        n = len(materials)
        return [[results[i * n + k] for i in range(len(self.trials))] for k in range(n)]

    def distances(self, results: Sequence[Result], photograph: Photograph) -> list[Feet]:
        """Feet of a photograph's points, upper and lower edge, on the simulated beam."""
        upper, lower = edges(results[photograph.trial])
        return [feet(photograph.outline.upper, upper), feet(photograph.outline.lower, lower)]

    def _beam(self, trial: BeamTrial, material: Material, fidelity: Fidelity | None = None) -> Beam:
        f = fidelity or self.fidelity
        return Beam(
            material=replace(material, density=self.density),
            length=trial.free_length,
            section=trial.section,
            supports=trial.supports,
            grip_length=trial.grip_length,
            gravity=trial.gravity,
            tip_force=trial.tip_force,
            element=f.element,  # type: ignore[arg-type]
            layer=f.layer,
            rings=f.rings,
            solver=f.solver,
        )

    def _whitened(self, results: Sequence[Result]) -> Array:
        parts = []
        for p in self.photographs:
            distance = np.concatenate([f.distance for f in self.distances(results, p)])
            parts.append(whiten(p.root, distance))
        return np.concatenate(parts)

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

    def _varied(self) -> list[tuple[str, float, _Group]]:
        """Name, sd and varied scenes of each nuisance of specimen, trial and material that the lab admits."""
        found: list[tuple[str, float, _Group]] = []
        specimens: dict[str, list[int]] = {}
        for i, t in enumerate(self.trials):
            specimens.setdefault(t.specimen or t.id, []).append(i)
        for name, members in specimens.items():
            first = self.trials[members[0]]
            labels = ("radius",) if isinstance(first.section, Circle) else ("width", "height")
            for label, sd in zip(labels, first.section_sd, strict=False):
                if sd > 0.0:
                    group = _Group(self, tuple(members), label, 0.005 * getattr(first.section, label))
                    found.append((f"{label} of {name}", sd, group))
        for i, t in enumerate(self.trials):
            if t.free_length_sd > 0.0:
                found.append(
                    (
                        f"free length of {t.id}",
                        t.free_length_sd,
                        _Group(self, (i,), "length", 0.005 * t.free_length),
                    )
                )
        if self.belief.density_sd > 0.0:
            everything = tuple(range(len(self.trials)))
            group = _Group(self, everything, "density", 0.005 * self.density)
            found.append((f"density of {self.belief.name}", self.belief.density_sd, group))
        return found


@dataclass(frozen=True, eq=False)
class _Group:
    """Trials that one nuisance moves together, by a finite-difference step."""

    objective: OutlineObjective
    trials: tuple[int, ...]
    label: str
    step: float

    def __call__(self, material: Material) -> list[Beam]:
        return [self._moved(self.objective._beam(self.objective.trials[i], material)) for i in self.trials]

    def _moved(self, beam: Beam) -> Beam:
        if self.label == "length":
            return replace(beam, length=beam.length + self.step)
        if self.label == "density":
            return replace(beam, material=replace(beam.material, density=beam.material.density + self.step))
        section = replace(beam.section, **{self.label: getattr(beam.section, self.label) + self.step})
        return replace(beam, section=section)
