"""Photographed beams of all materials together, with the catalogue's effects nested in their FEM.

What is compared is the smooth part of the distances between traced points and simulated edges: for each edge
of each photograph the coefficients of polynomials, whitened by the contour's noise as the lab states it
together with all nuisances (registration, radius, free length, density, what the mesh's correction leaves).
So z is standard normal where the model is right.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky, solve_triangular

from calibration.diagnosis.advice import all_parted
from calibration.diagnosis.beams._bank import Bank
from calibration.diagnosis.beams._candidates import candidates_of, reaches
from calibration.diagnosis.beams._nuisances import beliefs, corners, registrations
from calibration.diagnosis.beams._patterns import patterns_of
from calibration.diagnosis.beams._pictures import distances, feet_of, pictures_of
from calibration.diagnosis.beams._scenes import Kind, Nudge, Scenes
from calibration.diagnosis.beams.advice import advise
from calibration.diagnosis.beams.effects import EFFECTS, BeamEffect
from calibration.diagnosis.beams.simulators import OURS, Simulator
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Linear, State
from calibration.diagnosis.specimens import mean_moduli, scatter_patterns, scatter_rows
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment
from calibration.outlines import Fidelity
from tisim import Beam, Result

Array = NDArray[np.float64]

MESH_LEFT = 0.2  # of the mesh's correction, as in calibration.outlines
STEP = 0.003  # of ln G, in a finite difference
SCAN = np.geomspace(3e5, 3e3, 9)  # shear moduli to begin from, stiff to soft [Pa]


class BeamModel:
    """Baseline: neo-Hookean and nearly incompressible, one modulus a specimen (trials that name no specimen
    share one a material). See `calibration.diagnosis.nested.Nested`.

    names: of the specimens; coordinates are u = ln(G / 1 Pa) of each.
    simulator: whose faults are looked for too; uncorrected: why there is no correction of its mesh's error.
    without: effects taken out of the catalogue. pose: see `Scenes`. names: specimens, where the coordinates
    of another model of the same ones are to be understood.
    InputError where no beam was traced, or where a density is missing.
    """

    # three stand in for an axial gradient of 16 sigmas: a gap at the clamps, an image scale and a radius
    most_causes = 2

    def __init__(
        self,
        experiment: Experiment,
        *,
        simulator: Simulator = OURS,
        without: Sequence[str] = (),
        workers: int | None = None,
        pose: Callable[[Beam, BeamTrial], Beam] | None = None,
        names: Sequence[str] = (),
    ) -> None:
        self.trials = [
            t for t in experiment.trials if isinstance(t, BeamTrial) and any(c.outline for c in t.captures)
        ]
        if not self.trials:
            raise InputError("experiment.yaml: trials: expected a beam with a traced outline")
        for name in dict.fromkeys(t.material for t in self.trials):
            if experiment.materials[name].density is None:
                raise InputError(
                    f"experiment.yaml: materials.{name}.density_kg_m3: expected, since a beam's shape tells"
                    " only the ratio of weight to stiffness"
                )
        self.experiment = experiment
        self.simulator, self.workers = simulator, workers
        self.effects: Mapping[str, BeamEffect] = {
            n: e for n, e in EFFECTS.items() if n not in without and e.faulty(simulator)
        }
        self.pictures = pictures_of(self.trials)
        self.points = self.pictures[-1].rows.stop
        of_trial = [t.specimen or t.material for t in self.trials]
        self.names = tuple(names) or tuple(dict.fromkeys(of_trial))
        self.specimen = [self.names.index(s) for s in of_trial]
        made_of = dict(zip(of_trial, (t.material for t in self.trials), strict=True))
        self.materials = tuple(made_of.get(name, "") for name in self.names)
        self.candidates = candidates_of(self.trials, self.effects)
        self.scenes = Scenes(
            experiment=experiment, trials=self.trials, specimen=self.specimen, effects=self.effects, pose=pose
        )
        self.bank = Bank(scenes=self.scenes, pictures=self.pictures, simulator=simulator, workers=workers)
        self.uncorrected = "" if simulator.reference else f"simulated as they are: {simulator.sentence}"
        self._prior = scatter_rows(self.materials)
        self._correction = np.zeros(self.points)
        self._known = np.zeros((self.points, 0))  # nuisances' columns
        self._root: Array | None = None

    # -- what the search asks for --

    def start(self) -> Array:
        """The modulus of each specimen, of a coarse scan, that comes nearest to its outlines. From stiff to
        soft, and no further than past the nearest: beams far too soft are dear, or have no equilibrium."""
        best = np.full(len(self.names), np.inf)
        u = np.zeros(len(self.names))
        for shear in SCAN:
            state = State(u=np.full(len(self.names), np.log(shear)))
            cost = np.zeros(len(self.names))
            for p, r in zip(self.pictures, self.bank.guide.solve([(state, None)])[0], strict=True):
                cost[self.specimen[p.trial]] += np.inf if r is None else np.sum(distances(feet_of(p, r)) ** 2)
            better = cost < best
            best, u = np.where(better, cost, best), np.where(better, state.u, u)
            if not better.any():
                break
        if not np.isfinite(best).all():
            raise ValueError("no shear modulus from 3 to 300 kPa gives every beam an equilibrium")
        return u

    def retake(self, state: State, *, rough: bool = False) -> None:
        """Nuisances' columns and the correction of the mesh's error, taken at a state; rough: without the
        correction, to find out where to take it."""
        # effects that differ in time are left out: what is taken here hardly depends on the modulus
        lasting = {c: a for c, a in state.amplitudes.items() if not self.effects[c.effect].timed}
        calm = replace(state, amplitudes=lasting)
        results = self.bank.answer(calm)
        base = self.bank.values_of(results, calm)
        self._correction = np.zeros(self.points)
        if self.simulator.reference is not None and not rough:
            self._correction, self.uncorrected = self._corrected(calm, base, *self.simulator.reference)
        columns = registrations(self.pictures, results, self.scenes, calm) + corners(self.pictures)
        for i, _ in enumerate(self.trials):
            columns.append(np.where(self._of_trial() == i, MESH_LEFT * self._correction, 0.0))
        columns += beliefs(self.bank, base, results, calm)
        self._known = np.column_stack(columns)
        self._whitened()

    def _corrected(self, state: State, base: Array, coarser: Fidelity, finer: Fidelity) -> tuple[Array, str]:
        """What the mesh of the search misses [m], (points,), by Richardson's extrapolation of second order in
        the number of rings; zero, and why, where a reference has no equilibrium."""
        values = []
        for reference in (coarser, finer):
            fine, problem = self.bank.fine(state, reference)
            if problem:
                return np.zeros(self.points), problem
            values.append(self.bank.values_of(fine, state))
        n, more = coarser.rings**2, finer.rings**2
        return values[1] + n / (more - n) * (values[1] - values[0]) - base, ""

    def _whitened(self) -> None:
        noise = block_diag(*[p.covariance for p in self.pictures])
        self._root = np.asarray(cholesky(noise + self._known @ self._known.T, lower=True))

    def residuals(self, states: Sequence[State]) -> Array:
        found = np.full((len(states), self.points + len(self._prior)), np.nan)
        values = self.bank.values([(s, None) for s in states])
        for row, state, at in zip(found, states, values, strict=True):
            if np.isfinite(at).all():
                row[:] = self._whole(at, state.u)
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        kinds = list(dict.fromkeys((c.effect, c.place) for c in candidates))
        nudges = [Nudge(kind=k, step=self._step(k, state)) for k in kinds]
        at, still, by_modulus, moved = self._beside(state, replace(state, u=state.u + STEP), nudges)
        if not (np.isfinite(at).all() and np.isfinite(by_modulus).all()):
            raise ValueError("no equilibrium at this state")
        slope = (by_modulus - still) / STEP
        of_trial, of_specimen = self._of_trial(), np.array(self.specimen)[self._of_trial()]
        by_u = np.zeros((self.points + len(self._prior), len(self.names)))
        for k in range(len(self.names)):
            by_u[: self.points, k] = self._whiten(np.where(of_specimen == k, slope, 0.0))
        by_u[self.points :] = self._prior
        change = {n.kind: moved[n.kind] / n.step for n in nudges}
        columns = np.zeros((len(by_u), len(candidates)))
        for k, c in enumerate(candidates):
            hit = np.array([reaches(c, t, self.effects[c.effect]) for t in self.trials])
            columns[: self.points, k] = self._whiten(
                np.where(hit[of_trial], change[(c.effect, c.place)], 0.0)
            )
        z = self._whole(at, state.u)
        return Linear(state=state, z=z, by_u=by_u, columns=columns, candidates=tuple(candidates))

    def _beside(
        self, state: State, stiffer: State, nudges: Sequence[Nudge]
    ) -> tuple[Array, Array, Array, dict[Kind, Array]]:
        """Values at a state, there and with stiffer beams by what guides, and the nudges' changes."""
        guide, ways = self.bank.guide, [(state, None), (stiffer, None)]
        if guide is self.bank:
            at, by_modulus, *moved = guide.values([*ways, *((state, n) for n in nudges)])
            return at, at, by_modulus, {n.kind: v - at for n, v in zip(nudges, moved, strict=True)}
        own = [n for n in nudges if self._own(n)]
        others = [n for n in nudges if n not in own]
        at, *moved = self.bank.values([(state, None), *((state, n) for n in own)])
        still, by_modulus, *rest = guide.values([*ways, *((state, n) for n in others)])
        change = {n.kind: v - at for n, v in zip(own, moved, strict=True)}
        return at, still, by_modulus, change | {n.kind: v - still for n, v in zip(others, rest, strict=True)}

    def _own(self, nudge: Nudge) -> bool:
        """Whether it mends what the simulator lacks beside the one that guides."""
        name = nudge.kind[0]
        return self.effects[name].instead is not None and self.bank.mends(name) is self.bank

    def patterns(self) -> Mapping[str, Array]:
        found = {}
        for name, raw in patterns_of(self.pictures, self.trials).items():
            none = np.zeros((len(self._prior), raw.shape[1]))
            found[name] = np.vstack([self._whiten(raw), none])
        size = self.points + len(self._prior)
        return {**found, **scatter_patterns(size, self.points, len(self._prior))}

    # -- what folds ask for (see `calibration.diagnosis.heldout.Foldable`) --

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]:
        """Photographs (by index) by length and support, by material, and by when they were taken."""
        lengths: dict[str, list[int]] = {}
        materials: dict[str, list[int]] = {}
        turns: dict[str, list[int]] = {}
        for k, p in enumerate(self.pictures):
            t = self.trials[p.trial]
            lengths.setdefault(f"{t.supports} {1e3 * t.free_length:.0f} mm", []).append(k)
            materials.setdefault(t.material, []).append(k)
            nth = sum(q.trial == p.trial for q in self.pictures[:k])
            turns.setdefault(f"photograph {nth + 1} of each beam", []).append(k)
        found = {
            "leave-one-length-out": lengths,
            "leave-one-material-out": materials,
            "leave-one-photograph-out": turns,
        }
        return {name: [(g, frozenset(ks)) for g, ks in groups.items()] for name, groups in found.items()}

    def rows(self, group: object) -> NDArray[np.bool_]:
        assert isinstance(group, frozenset)
        hit = np.zeros(self.points + len(self._prior), dtype=bool)
        for k in group:
            hit[self.pictures[k].rows] = True
        return hit

    def part(self, group: object, *, others: bool) -> BeamModel:
        assert isinstance(group, frozenset)
        assert self._root is not None, "retake a BeamModel before it is split"
        kept = [k for k in range(len(self.pictures)) if (k in group) != others]
        rows = np.concatenate([np.arange(self.points)[self.pictures[k].rows] for k in kept])
        some = copy(self)
        some.pictures = []
        first = 0
        for k in kept:
            size = self.pictures[k].basis.shape[1]
            some.pictures.append(replace(self.pictures[k], rows=slice(first, first + size)))
            first += size
        some.points = first
        some.bank = replace(self.bank, pictures=some.pictures)
        some._correction, some._known = self._correction[rows], self._known[rows]
        some._whitened()
        return some

    def measuring(self, experiment: Experiment, pose: Callable[[Beam, BeamTrial], Beam]) -> BeamModel:
        """The same specimens in other photographs, simulated as they are: coordinates stay."""
        plain = replace(self.simulator, reference=None)
        return BeamModel(experiment, simulator=plain, workers=self.workers, pose=pose, names=self.names)

    def unseen(self, group: object) -> NDArray[np.bool_]:
        assert isinstance(group, frozenset)
        seen = {self.materials[self.specimen[p.trial]] for k, p in enumerate(self.pictures) if k not in group}
        return np.array([m not in seen for m in self.materials])

    def distance_rms(self, state: State) -> float:
        """Of the smooth part of the distances [m], nuisances at their most likely values taken out."""
        (values,) = self.bank.values([(state, None)])
        if not np.isfinite(values).all():
            raise ValueError("no equilibrium at this state")
        left = self._taken_out() @ (values + self._correction)
        return float(np.sqrt(left @ left / self._traced))

    def noise_rms(self) -> float:
        """What `distance_rms` would be of the noise alone [m]."""
        taken = self._taken_out()
        covariance = block_diag(*[p.covariance for p in self.pictures]) + self._known @ self._known.T
        return float(np.sqrt(np.trace(taken @ covariance @ taken.T) / self._traced))

    @property
    def _traced(self) -> int:
        """Traced points of all photographs."""
        return sum(len(p.basis) for p in self.pictures)

    def _taken_out(self) -> Array:
        """(points, points): takes the most likely nuisances out of smooth coefficients."""
        noise = block_diag(*[p.covariance for p in self.pictures])
        inside = np.linalg.solve(noise, self._known)
        estimate = np.linalg.solve(self._known.T @ inside + np.eye(self._known.shape[1]), inside.T)
        return np.asarray(np.eye(self.points) - self._known @ estimate)

    # -- what verdicts and reports ask for --

    @property
    def unit(self) -> tuple[str, float]:
        return "mm", 1e3

    def advice(self, rivals: list[Explanation]) -> str:
        return all_parted(advise(self, rivals)[0], rivals)

    def remarks(self) -> list[str]:
        return [f"the mesh's error is not corrected: {self.uncorrected}"] if self.uncorrected else []

    def registered(self, state: State) -> list[Array]:
        """Distances of each photograph's points [m], the nuisances at their most likely values taken out.
        ValueError where a beam has no equilibrium."""
        results = self.results(state)
        smooth = self.bank.values_of(results, state) + self._correction
        known = smooth - self._taken_out() @ smooth
        found = []
        for p, r in zip(self.pictures, results, strict=True):
            raw = distances(feet_of(p, r, self.scenes.images(p.trial, state, time=p.time)))
            found.append(raw + p.basis @ (self._correction[p.rows] - known[p.rows]))
        return found

    def results(self, state: State) -> Sequence[Result]:
        """One result a photograph. ValueError where a beam has no equilibrium."""
        return self.bank.answer(state)

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        return mean_moduli(self.materials, u)

    # -- algebra --

    def _step(self, kind: Kind, state: State) -> float:
        """Of a finite difference, away from the bound that the effect is at."""
        effect = self.effects[kind[0]]
        now = [a for c, a in state.amplitudes.items() if (c.effect, c.place) == kind]
        return effect.step if max(now, default=0.0) + effect.step <= effect.bounds[1] else -effect.step

    def _whole(self, values: Array, u: Array) -> Array:
        return np.concatenate([self._whiten(values + self._correction), self._prior @ u])

    def _whiten(self, values: Array) -> Array:
        if self._root is None:
            raise RuntimeError("retake a BeamModel at a state before use")
        # a candidate that has no equilibrium one step on explains nothing
        sound = np.where(np.isfinite(values), values, 0.0)
        return np.asarray(solve_triangular(self._root, sound, lower=True, check_finite=False))

    def _of_trial(self) -> NDArray[np.int64]:
        return np.concatenate([np.full(p.basis.shape[1], p.trial) for p in self.pictures])
