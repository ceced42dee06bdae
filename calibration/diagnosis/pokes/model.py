"""Pokes of all materials together, with the catalogue's effects nested in them.

What is compared is the force along the rod (and across it, where the lab has vectors) at the recorded depths
of the whole record: loading, holds, unloading, later cycles. Whitened by the errors that the lab states (the
depth's through the slope) together with the nuisances of `_nuisances`, so that z is standard normal where the
model is right.

The simulated force is that of the loading at each depth: without an effect of history it is the same on the
way back, as long as nothing slides under the rod (a friction of 0.6: to 0.01 % in an independent simulation
that unloads).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.advice import all_parted
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Linear, State
from calibration.diagnosis.pokes._candidates import candidates_of, reaches
from calibration.diagnosis.pokes._curves import Curves
from calibration.diagnosis.pokes._families import families_of, rows_of, size_of
from calibration.diagnosis.pokes._noise import Noise, noise_of
from calibration.diagnosis.pokes._nuisances import TOUCH
from calibration.diagnosis.pokes._patterns import patterns_of
from calibration.diagnosis.pokes._record import Record, records_of
from calibration.diagnosis.pokes._remarks import remarks_on
from calibration.diagnosis.pokes._simulation import Simulation, reached
from calibration.diagnosis.pokes.advice import advise
from calibration.diagnosis.pokes.effects import EFFECTS, PokeEffect
from calibration.diagnosis.specimens import mean_moduli, scatter_patterns, scatter_rows
from calibration.errors import InputError
from calibration.experiment.model import Experiment, PokeTrial

Array = NDArray[np.float64]

STEP = 1e-4  # of ln G, in a finite difference


class PokeModel:
    """Baseline: neo-Hookean, nearly incompressible, one modulus a specimen (trials that name none share one a
    material). See `calibration.diagnosis.nested.Nested` and `heldout.Foldable`.

    names: of the specimens; coordinates are u = ln(G / 1 Pa) of each. without: effects taken out of the
    catalogue. workers: as in `tisim.simulate`. Each geometry is simulated once here, and once for each change
    of it that a search asks for. InputError where there is no poke, or one that cannot be simulated;
    ValueError where one has no answer.
    """

    most_causes = 3

    def __init__(
        self, experiment: Experiment, *, without: Sequence[str] = (), workers: int | None = None
    ) -> None:
        trials = [t for t in experiment.trials if isinstance(t, PokeTrial)]
        if not trials:
            raise InputError("experiment.yaml: trials: expected a poke")
        self.experiment = experiment
        self.effects: Mapping[str, PokeEffect] = {n: e for n, e in EFFECTS.items() if n not in without}
        self.curves = Curves(workers)
        self.records: Sequence[Record]
        self.records, self.left_out = reached(self.curves, records_of(trials))
        self.names = tuple(dict.fromkeys(r.specimen for r in self.records))
        owner = {r.specimen: r.material for r in self.records}
        self.materials = tuple(owner[n] for n in self.names)
        self._prior = scatter_rows(self.materials)
        self.candidates: tuple[Candidate, ...] = candidates_of(self.records, self.effects)
        self.simulation = Simulation(
            curves=self.curves,
            effects=self.effects,
            specimens=self.names,
            visible=self._visible(self.records),
        )
        self._kept = np.ones(size_of(self.records), dtype=bool)
        self._elastic: list[Array] = []
        self._noise: Noise | None = None  # before the first `retake`

    @property
    def points(self) -> int:
        return int(self._kept.sum())

    # -- what the search asks for --

    def start(self) -> Array:
        """The modulus of each specimen whose curve comes nearest to its first loadings. ValueError where a
        specimen pulls the rod in."""
        u = []
        for name in self.names:
            top = bottom = 0.0
            for r in (r for r in self.records if r.specimen == name):
                unit = self.simulation.base(r).at(r.depth)
                first = (r.cycle == 1) & (r.kind > 0)
                use = first if first.any() else np.ones(r.points, dtype=bool)
                top += float(unit[use] @ r.force[use])
                bottom += float(unit[use] @ unit[use])
            if not top > 0.0:
                raise ValueError(
                    f"specimen {name}: its force falls with the depth, no shear modulus gives that"
                )
            u.append(np.log(top / bottom))
        return np.array(u)

    def retake(self, state: State, *, rough: bool = False) -> None:
        """Errors and nuisances, which go with the simulated force, at a state."""
        del rough
        forces: list[Array] = []
        slopes = []
        curves = [self.simulation.base(r) for r in self.records]
        for r, curve in zip(self.records, curves, strict=True):
            shear = self.simulation.shear(r, state)
            forces.append(shear * curve.at(r.depth))
            slopes.append(shear * curve.slope(r.depth, max(TOUCH * r.depth_sd, 1e-6)))
        self._elastic = forces
        self._noise = noise_of(self.records, curves, forces, slopes, self._kept)

    def residuals(self, states: Sequence[State]) -> Array:
        self.simulation.prepare(states, self.records)
        found = np.empty((len(states), self.points + len(self._prior)))
        for row, state in zip(found, states, strict=True):
            row[:] = self._whole(state)
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        visible = self.simulation.visible
        steps = {c: self.simulation.step(c, state, self.records) for c in candidates if visible[c]}
        moved = {c: _with(state, c, state.amplitudes.get(c, 0.0) + s) for c, s in steps.items()}
        self.simulation.prepare([state, *moved.values()], self.records)
        base = self._raw(state)
        by_u = np.zeros((self.points + len(self._prior), len(self.names)))
        for k in range(len(self.names)):
            u = state.u.copy()
            u[k] += STEP
            change = self._raw(State(u=u, amplitudes=state.amplitudes)) - base
            by_u[: self.points, k] = self.noise.whiten(change / STEP)
        by_u[self.points :] = self._prior
        raw = np.zeros((len(self._kept), len(candidates)))
        for k, c in enumerate(candidates):
            if c in moved:
                raw[:, k] = (self._raw(moved[c]) - base) / steps[c]
        columns = np.vstack([self.noise.whiten(raw), np.zeros((len(self._prior), len(candidates)))])
        z = self._whole(state)
        if not np.isfinite(z).all():
            raise ValueError("a poke has no answer at this state")
        return Linear(state=state, z=z, by_u=by_u, columns=columns, candidates=tuple(candidates))

    def patterns(self) -> Mapping[str, Array]:
        found = {}
        for name, columns in patterns_of(self.records, self._elastic).items():
            more = len(self._kept) - len(columns)
            raw = np.vstack([columns, np.zeros((more, columns.shape[1]))])
            found[name] = np.vstack([self.noise.whiten(raw), np.zeros((len(self._prior), raw.shape[1]))])
        size = self.points + len(self._prior)
        return {**found, **scatter_patterns(size, self.points, len(self._prior))}

    # -- what folds ask for --

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]:
        """Rows by trial, by material, by phase and in fifths of each record."""
        return families_of(self.records)

    def rows(self, group: object) -> NDArray[np.bool_]:
        hit = np.zeros(self.points + len(self._prior), dtype=bool)
        hit[: self.points] = self._hit(group)[self._kept]
        return hit

    def part(self, group: object, *, others: bool) -> PokeModel:
        some = copy(self)
        some._kept = self._kept & (self._hit(group) != others)
        some._noise = self.noise.among(some._kept)
        return some

    def measuring(self, trials: Sequence[PokeTrial]) -> PokeModel:
        """The same specimens in other trials, seen beside those that there are: coordinates and candidates
        stay. Errors are still to be taken (`retake`)."""
        some = copy(self)
        some.records, _ = reached(self.curves, records_of(trials))
        visible = some._visible([*self.records, *some.records])
        some.simulation = replace(self.simulation, visible=visible)
        some._kept = np.ones(size_of(some.records), dtype=bool)
        some._noise = None
        return some

    def unseen(self, group: object) -> NDArray[np.bool_]:
        left = self._kept & ~self._hit(group)
        seen = {r.material for r, rows in rows_of(self.records) if left[rows].any()}
        return np.array([m not in seen for m in self.materials])

    def distance_rms(self, state: State) -> float:
        """rms of measured less simulated force [N], nuisances at their most likely values taken out."""
        left = self.noise.taken_out() @ self._raw(state)[self._kept]
        return float(np.sqrt(np.mean(left**2)))

    def noise_rms(self) -> float:
        """What `distance_rms` would be of the noise alone [N]."""
        taken, covariance = self.noise.taken_out(), self.noise.covariance()
        return float(np.sqrt(np.einsum("ij,jk,ik->", taken, covariance, taken) / len(taken)))

    # -- what reports ask for --

    @property
    def unit(self) -> tuple[str, float]:
        return "N", 1.0

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        return mean_moduli(self.materials, u)

    def advice(self, rivals: list[Explanation]) -> str:
        return all_parted(advise(self, rivals)[0], rivals)

    def remarks(self) -> list[str]:
        return remarks_on(self.records, self.left_out)

    def registered(self, state: State) -> list[Array]:
        """Simulated less measured force along the rod of each record [N], the most likely nuisances taken
        out."""
        self.simulation.prepare([state], self.records)
        left = np.full(len(self._kept), np.nan)
        left[self._kept] = self.noise.taken_out() @ self._raw(state)[self._kept]
        return self._by_record(left)

    def forces(self, state: State) -> list[Array]:
        """Force along the rod [N] of each record at its points, with the state's effects."""
        self.simulation.prepare([state], self.records)
        return [self.simulation.along(state, r) for r in self.records]

    def deviations(self) -> list[Array]:
        """Standard deviation of each point by itself [N], as taken last."""
        return self._by_record(self.noise.sd)

    # -- inside --

    @property
    def noise(self) -> Noise:
        """As taken last."""
        assert self._noise is not None, "retake a PokeModel before use"
        return self._noise

    def _visible(self, records: Sequence[Record]) -> dict[Candidate, bool]:
        """Which candidates these records can show."""
        found = {}
        for c in self.candidates:
            effect = self.effects[c.effect]
            touched = [r for r in records if reaches(c, r, effect)]
            found[c] = bool(touched) and effect.shows(touched, records)
        return found

    def _raw(self, state: State) -> Array:
        """Simulated less measured [N]."""
        along = [self.simulation.along(state, r) - r.force for r in self.records]
        across = [
            (self.simulation.across(state, r) - r.across).ravel()
            for r in self.records
            if r.across is not None
        ]
        return np.concatenate([*along, *across])

    def _whole(self, state: State) -> Array:
        return np.concatenate([self.noise.whiten(self._raw(state)), self._prior @ state.u])

    def _hit(self, group: object) -> NDArray[np.bool_]:
        assert isinstance(group, frozenset)
        hit = np.zeros(len(self._kept), dtype=bool)
        hit[list(group)] = True
        return hit

    def _by_record(self, values: Array) -> list[Array]:
        """Of values of all rows those along the rod."""
        ends = np.cumsum([r.points for r in self.records])
        return list(np.split(values[: ends[-1]], ends[:-1]))


def _with(state: State, candidate: Candidate, amplitude: float) -> State:
    return replace(state, amplitudes={**state.amplitudes, candidate: amplitude})
