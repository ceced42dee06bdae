"""Measurement model of photographed beams of all materials together, with effects in their FEM simulation.

It compares the smooth part of the distances between traced points and simulated edges: for each edge of each
photograph the coefficients of polynomials, whitened by the contour error that the lab states and all
nuisances (registration, radius, free length, density, remaining mesh error).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._baseline import Baseline
from calibration.measurements._effect import Candidate
from calibration.measurements._folds import joined
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._noisy_model import Shown
from calibration.measurements._state import State
from calibration.measurements.outlines._creep import CreepCurves, settled_by_moduli
from calibration.measurements.outlines._discrepancies import discrepancies
from calibration.measurements.outlines._edges import edges
from calibration.measurements.outlines._effect import OutlineEffect
from calibration.measurements.outlines._noise import sentence
from calibration.measurements.outlines._nuisances import beliefs, corners, doubts, registrations
from calibration.measurements.outlines._photographs import (
    SeenPhotograph,
    TracedPhotograph,
    coefficients,
    distances,
    photographs_of,
    projections_of,
    shown,
)
from calibration.measurements.outlines._predicted import photographed
from calibration.measurements.outlines._scenes import BULK_RATIO, Scenes
from calibration.measurements.outlines._solutions import SolutionCache
from calibration.measurements.outlines._start import scanned_moduli
from calibration.measurements.outlines.experiments import EXPERIMENTS, Photographs
from calibration.measurements.outlines.fidelity import Fidelity
from calibration.measurements.outlines.setup import Setup
from calibration.measurements.outlines.simulators import TISIM, Simulator
from tisim import Beam, Result

Array = NDArray[np.float64]

MESH_LEFT = 0.2  # of the mesh's correction: one sd of a nuisance, of each trial


class OutlineModel(MeasurementModel):
    """Measurement model of photographed beams.

    The baseline is neo-Hookean and nearly incompressible, with one modulus per specimen; trials of a material
    that name no specimen share one. Call `update_nuisances` before `residuals`.

    The misfit of this kind is measured minus simulated: the distance of traced points from simulated edges.

    Parameters
    ----------
    experiment : experiment with traced beams; other trials are ignored.
    effects : effects by name; see `calibration.diagnosis.effects.outlines`. Those that the simulator cannot
        have are left out.
    simulator : simulator of the beams, whose errors are diagnosed too.
    workers : number of processes, as in `tisim.simulate`.
    pose : see `Scenes`.
    baseline : baseline in place of the default: of another model of the same specimens, or of a fit.
    setup : known setup of rig and camera, applied to each scene and image; its uncertainties are nuisances.

    Attributes
    ----------
    uncorrected : reason why the mesh error is not corrected; "" if it is.

    Raises
    ------
    InputError
        If no beam was traced, or a density is missing.
    """

    kind = "outlines"
    unit = ("mm", 1e3)
    # three stand in for an axial gradient of 16 sigmas: a gap at the clamps, an image scale and a radius
    max_causes = 2
    coordinate_step = 0.003
    no_answer = "no equilibrium at this state"
    experiments: ClassVar[Sequence[Any]] = EXPERIMENTS

    records: Sequence[TracedPhotograph]
    effects: Mapping[str, OutlineEffect]

    def __init__(
        self,
        experiment: Experiment,
        *,
        effects: Mapping[str, OutlineEffect] | None = None,
        simulator: Simulator = TISIM,
        workers: int | None = None,
        pose: Callable[[Beam, BeamTrial], Beam] | None = None,
        baseline: Baseline | None = None,
        setup: Setup | None = None,
    ) -> None:
        self.trials = [t for t in experiment.trials if isinstance(t, BeamTrial) and t.traced]
        if not self.trials:
            raise InputError("experiment.yaml: trials: expected a beam with a traced outline")
        for name in dict.fromkeys(t.material for t in self.trials):
            if experiment.materials[name].density is None:
                raise InputError(
                    f"experiment.yaml: materials.{name}.density_kg_m3: expected, since a beam's shape"
                    " determines only the ratio of weight to stiffness"
                )
        self.experiment = experiment
        self.simulator, self.workers = simulator, workers
        self.effects = {n: e for n, e in (effects or {}).items() if e.faulty(simulator)}
        self.records = photographs_of(self.trials)
        sizes = [p.basis.shape[1] for p in self.records]
        self.row_record = np.repeat(np.arange(len(self.records)), sizes)
        self.noise = Noise.correlated(block_diag(*[p.covariance for p in self.records]))
        self.baseline = baseline or Baseline.per_specimen(self.records, bulk_ratio=BULK_RATIO)
        self._set_candidates()
        self.scenes = Scenes(
            experiment=experiment,
            trials=self.trials,
            baseline=self.baseline,
            effects=self.effects,
            pose=pose,
            setup=setup,
        )
        self.solutions = SolutionCache(
            scenes=self.scenes, photographs=self.records, simulator=simulator, workers=workers
        )
        # what a fit of a spectrum evaluates thousands of times; its correction comes with the mesh's
        self._creep = (
            CreepCurves(scenes=self.scenes, photographs=self.records, simulator=simulator, workers=workers)
            if settled_by_moduli(self.baseline)
            else None
        )
        self.uncorrected = "" if simulator.reference else f"simulated as they are: {simulator.sentence}"
        self._correction = np.zeros(len(self.row_record))
        self._updated = False

    def suggested_start(self) -> Array | None:
        return None if self._creep is None else self.start()

    def start(self) -> Array:
        """Start coordinates (n,): for each specimen the best modulus of a coarse scan (`scanned_moduli`).

        ValueError if a specimen has no equilibrium.
        """
        return self.baseline.start(scanned_moduli(self.baseline, self.records, self.solutions.surrogate))

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        """Update nuisances and the correction of the mesh error at a state.

        rough : if True, without the correction. ValueError if a beam has no equilibrium.
        """
        # effects that differ in time are left out: what is taken here hardly depends on the modulus
        lasting = {c: a for c, a in state.amplitudes.items() if not self.effects[c.effect].timed}
        calm = replace(state, amplitudes=lasting)
        results = self.solutions.answer(calm)
        base = self.solutions.values_of(results, calm)
        mesh = np.zeros(len(base))
        if self.simulator.reference is not None and not rough:
            mesh, self.uncorrected = self._corrected(calm, base, *self.simulator.reference)
        self._correction = mesh
        if self._creep is not None:
            self._correction = mesh + base - self._creep.values(self.records, [calm])[0]
        named = registrations(self.records, results, self.scenes, calm) + corners(self.records)
        for i, t in enumerate(self.trials):
            named.append((f"mesh of {t.id}", np.where(self.of_trial(i), MESH_LEFT * mesh, 0.0)))
        named += beliefs(self.solutions, base, results, calm) + doubts(self.solutions, base, calm)
        # what does nothing has no name: it is no nuisance of these photographs
        names = [name if column.any() else "" for name, column in named]
        self.noise = self.noise.with_nuisances([column for _, column in named], names)
        self._updated = True

    def _corrected(self, state: State, base: Array, coarser: Fidelity, finer: Fidelity) -> tuple[Array, str]:
        """Correction of the search's mesh error [m], shape (rows,), and "" or the reason why it is zero.

        It is a Richardson extrapolation of second order in the number of radial elements; zero if a reference
        has no equilibrium.
        """
        if self.baseline.whole and self.uncorrected:
            return np.zeros(len(base)), self.uncorrected  # a law that has none here is not tried again
        values = []
        alone = self.baseline.whole and self.workers == 1
        for reference in (coarser, finer):
            fine, problem = self.solutions.fine(state, reference, one_by_one=alone)
            if problem:
                return np.zeros(len(base)), problem
            values.append(self.solutions.values_of(fine, state))
        n, more = coarser.radial_elements**2, finer.radial_elements**2
        return values[1] + n / (more - n) * (values[1] - values[0]) - base, ""

    def _misfit(self, states: Sequence[State]) -> Array:
        return self._from(self._used(), states)

    def _from(self, solutions: SolutionCache, states: Sequence[State]) -> Array:
        """Misfit by given solutions, shape (batch, rows); NaN for photographs that they do not include."""
        if not self._updated:
            raise RuntimeError("call update_nuisances of an OutlineModel before use")
        found = np.full((len(states), len(self.row_record)), np.nan)
        rows = np.concatenate([np.arange(p.rows.start, p.rows.stop) for p in solutions.photographs])
        if self._creep is not None and solutions.simulator is self.simulator:
            whole = self._creep.values(solutions.photographs, states)
        else:
            whole = solutions.values(states)
        for row, values in zip(found, whole, strict=True):
            row[rows] = values + self._correction[rows]
        return found

    def _used(self) -> SolutionCache:
        """Solutions of the photographs that are compared."""
        used = [p for p in self.records if self.noise.used[p.rows].any()]
        return replace(self.solutions, photographs=used)

    def _beside(self, state: State) -> list[tuple[State, Mapping[int, NDArray[np.bool_]]]]:
        """As in the base class; all moduli are perturbed at once, as each photograph shows one specimen."""
        if self.baseline.whole:
            return super()._beside(state)
        owner = [self.baseline.specimens.index(p.specimen) for p in self.records]
        of_row = np.array(owner)[self.row_record]
        moved = replace(state, u=state.u + self.coordinate_step)
        return [(moved, {k: of_row == k for k in range(len(self.names))})]

    def _differences(self, state: State, candidates: Sequence[Candidate]) -> tuple[Array, Array, Array]:
        """As in the base class; if the simulator has a surrogate, derivatives are from the surrogate.

        Columns of simulator errors that are corrected by the simulator itself use the simulator.
        """
        solutions = self._used()
        surrogate = solutions.surrogate
        if surrogate is solutions:
            return super()._differences(state, candidates)
        ((moved, parts),) = self._beside(state)
        probes = self._probes(state, candidates)
        own = [p for p in probes if self._own(candidates[p[2][0]].effect)]
        others = [p for p in probes if p not in own]
        base, *by_own = self._from(solutions, [state, *(s for s, _, _ in own)])
        still, stiffer, *by_others = self._from(surrogate, [state, moved, *(s for s, _, _ in others)])
        used = self.noise.used
        if not (np.isfinite(base[used]).all() and np.isfinite(stiffer[used]).all()):
            raise ValueError(self.no_answer)
        by_u = np.zeros((len(base), len(self.names)))
        for k, mine in parts.items():
            by_u[:, k] = np.where(mine, (stiffer - still) / self.coordinate_step, 0.0)
        columns = np.zeros((len(base), len(candidates)))
        for some, rows, at in ((own, by_own, base), (others, by_others, still)):
            for (_, step, members), row in zip(some, rows, strict=True):
                for k in members:
                    hit = self.reached(candidates[k])[self.row_record]
                    columns[:, k] = np.where(hit, (row - at) / step, 0.0)
        return base, by_u, columns

    def _own(self, name: str) -> bool:
        """True if an effect is a simulator error whose correction is computed without the surrogate."""
        solutions = self.solutions
        return self.effects[name].instead is not None and solutions.corrected_by(name) is solutions

    def predicted_in(self, design: Photographs, state: State) -> Self | None:
        """Model of the same specimens in new photographs, as a state predicts them; None if not possible."""
        made = photographed(
            design,
            state,
            self.scenes,
            self.records,
            fidelity=self.simulator.fidelity,
            workers=self.workers,
        )
        if made is None:
            return None
        new = self.measuring(made, design.pose)
        new.update_nuisances(state)
        return new

    def measuring(self, experiment: Experiment, pose: Callable[[Beam, BeamTrial], Beam]) -> Self:
        """Model of the same specimens in other photographs, without mesh correction; coordinates stay."""
        return type(self)(
            experiment,
            effects=self.effects,
            simulator=replace(self.simulator, reference=None),
            workers=self.workers,
            pose=pose,
            baseline=self.baseline,
            setup=self.scenes.setup,
        )

    def registered(self, state: State) -> list[Array]:
        """Distances of each photograph's points without the most likely nuisances [m].

        NaN for photographs that are not compared. ValueError if a beam has no equilibrium.
        """
        return self.left_of(self.seen(state))

    def left_of(self, seen: Sequence[SeenPhotograph]) -> list[Array]:
        """As `registered`, from `seen`: distances of each photograph's points [m], NaN if not compared."""
        left = {id(s.photograph): s.left for s in seen}
        return [left.get(id(p), np.full(len(p.basis), np.nan)) for p in self.records]

    def seen(self, state: State) -> list[SeenPhotograph]:
        """The compared photographs with the beams of a state. ValueError if a beam has no equilibrium."""
        used = self._used()
        results = used.answer(state)
        smooth = np.full(len(self.row_record), np.nan)
        for p, r in zip(used.photographs, results, strict=True):
            smooth[p.rows] = coefficients(p, r, self.scenes.images(p.beam, state, time=p.time))
        smooth += self._correction
        known = smooth - self.noise.remove(smooth)
        found = []
        for p, r in zip(used.photographs, results, strict=True):
            images = self.scenes.images(p.beam, state, time=p.time)
            lines = [shown(line, images) for line in edges(r)]
            projections = projections_of(p, r, images)
            raw = distances(projections) + p.basis @ self._correction[p.rows]
            found.append(
                SeenPhotograph(
                    photograph=p,
                    projections=projections,
                    simulated=lines,
                    raw=raw,
                    left=raw - p.basis @ known[p.rows],
                    result=r,
                    images=images,
                )
            )
        return found

    def results(self, state: State) -> Sequence[Result]:
        """One result per photograph (`SolutionCache.answer`). ValueError if a beam has no equilibrium."""
        return self.solutions.answer(state)

    def _measured_points(self) -> int:
        """Number of traced points of the photographs that are compared."""
        return sum(len(p.basis) for p in self._used().photographs)

    def of_trial(self, trial: int) -> NDArray[np.bool_]:
        """Mask (rows,) of the rows of a trial's photographs; trial : index."""
        return np.array([p.beam == trial for p in self.records])[self.row_record]

    def shortcomings(self) -> list[str]:
        return [self.uncorrected] if self.uncorrected else []

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        """Fold labels by length and support, by material, and by the number of the photograph."""
        found = []
        for k, p in enumerate(self.records):
            nth = sum(q.beam == p.beam for q in self.records[:k])
            rows = p.basis.shape[1]
            found.append(
                {
                    "leave-one-length-out": [f"{p.trial.supports} {1e3 * p.trial.free_length:.0f} mm"] * rows,
                    "leave-one-material-out": [p.material] * rows,
                    "leave-one-photograph-out": [f"photograph {nth + 1} of each beam"] * rows,
                }
            )
        return joined(found)

    def _discrepancies(self) -> Mapping[str, Array]:
        return discrepancies(self.records, self.trials)

    def remarks(self) -> list[str]:
        return [f"the mesh's error is not corrected: {self.uncorrected}"] if self.uncorrected else []

    def noise_sentence(self) -> str:
        return sentence([p.outline for p in self.records], self.uncorrected)

    def shown(self, k: int) -> Shown:
        p = self.records[k]
        return Shown(
            axis="point of the outline",
            x=np.arange(float(len(p.basis))),
            quantity="measured less simulated, registered",
            unit=self.unit,
            measured=np.zeros(len(p.basis)),
            of_rows=p.basis,
        )
