"""Forward model with effects: candidates, residuals and derivatives, for all kinds of measurement."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._baseline import Baseline
from calibration.measurements._effect import Candidate, EffectModel, candidates_of, reaches
from calibration.measurements._noise import Noise
from calibration.measurements._state import Linearisation, State

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]


class ForwardModel(ABC):
    """Misfit of records of one kind, simulated with effects.

    Attributes
    ----------
    coordinate_step : finite-difference step of a coordinate u.
    alias_tolerance : see `Linearisation`.
    no_answer : message of the ValueError for a state at which the simulation has no solution.
    records : records in the order of the rows, as far as rows belong to one record each.
    row_record : index of the record of each row, shape (rows,).
    effects : models of the effects by name.
    candidates : candidates of all effects.
    visible : True for each candidate that the records identify.
    baseline : definition of the coordinates u.
    noise : noise of all rows, with the nuisances of the last update.
    """

    coordinate_step: ClassVar[float] = 1e-4
    alias_tolerance: ClassVar[float | None] = None
    no_answer: ClassVar[str] = "the simulation has no answer at this state"

    records: Sequence[Any]
    row_record: NDArray[np.intp]
    effects: Mapping[str, EffectModel]
    candidates: tuple[Candidate, ...]
    visible: Mapping[Candidate, bool]
    baseline: Baseline
    noise: Noise

    @abstractmethod
    def _misfit(self, states: Sequence[State]) -> Array:
        """Simulated minus measured [SI], shape (batch, rows); NaN for a state without a solution.

        Rows that the noise does not use may hold any value.
        """

    # -- residuals and derivatives --

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates u, (n,)."""
        return self.baseline.names

    @property
    def points(self) -> int:
        """Number of residuals that are measurements; the rows of the prior follow them."""
        return self.noise.points

    def residuals(self, states: Sequence[State]) -> Array:
        """Whitened residuals (batch, m), prior rows last; NaN for a state without a solution."""
        found = np.full((len(states), self.points + len(self.baseline.prior)), np.nan)
        for row, state, misfit in zip(found, states, self._misfit(states), strict=True):
            if np.isfinite(misfit[self.noise.used]).all():
                row[:] = self._whole(misfit, state)
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linearisation:
        """Whitened residuals and their derivatives at a state, by finite differences in one batch.

        Candidates of one form share a finite difference; each uses the rows of the records it applies to.
        A column is zero where the perturbed state has no solution. ValueError if the state has no solution.
        """
        misfit, by_u, columns = self._differences(state, candidates)
        prior = self.baseline.prior
        return Linearisation(
            state=state,
            z=self._whole(misfit, state),
            by_u=np.vstack([self.noise.whiten(by_u), prior]),
            columns=np.vstack([self.noise.whiten(columns), np.zeros((len(prior), len(candidates)))]),
            candidates=tuple(candidates),
            alias_tolerance=self.alias_tolerance,
        )

    def sensitivities(self, state: State, candidates: Sequence[Candidate]) -> tuple[Array, Array]:
        """Simulated minus measured (rows,), and its derivatives (rows, n + c) by u and by amplitudes [SI].

        Rows that the noise does not use may hold any value. ValueError if the state has no solution.
        """
        misfit, by_u, columns = self._differences(state, candidates)
        return misfit, np.column_stack([by_u, columns])

    def _differences(self, state: State, candidates: Sequence[Candidate]) -> tuple[Array, Array, Array]:
        """Misfit (rows,), its derivatives by u (rows, n) and by amplitudes (rows, c) [SI]."""
        moved = self._beside(state)
        probes = self._probes(state, candidates)
        rows = self._misfit([state, *(s for s, _ in moved), *(p for p, _, _ in probes)])
        base = rows[0]
        if not np.isfinite(base[self.noise.used]).all():
            raise ValueError(self.no_answer)
        by_u = np.zeros((len(base), len(self.names)))
        for row, (beside, parts) in zip(rows[1 : 1 + len(moved)], moved, strict=True):
            sides = [(self.coordinate_step, row)]
            for k, own in parts.items():
                step, change = sides[0]
                if not np.isfinite(change[own & self.noise.used]).all():
                    if len(sides) == 1:
                        back = self._misfit([replace(state, u=2.0 * state.u - beside.u)])[0]
                        sides.append((-self.coordinate_step, back))
                    step, change = sides[1]
                    if not np.isfinite(change[own & self.noise.used]).all():
                        continue  # neither side has a solution
                by_u[:, k] = np.where(own, (change - base) / step, 0.0)
        columns = np.zeros((len(base), len(candidates)))
        for row, (_, step, members) in zip(rows[1 + len(moved) :], probes, strict=True):
            change = (row - base) / step
            for k in members:
                columns[:, k] = np.where(self.reached(candidates[k])[self.row_record], change, 0.0)
        return base, by_u, columns

    def _beside(self, state: State) -> list[tuple[State, Mapping[int, Rows]]]:
        """States for the finite differences by u, each with the rows (rows,) that each coordinate changes.

        Coordinates that no record has in common are perturbed together.
        """
        depends = np.array([self._depends_on(r) for r in self.records])
        together: list[tuple[Rows, list[int]]] = []  # records that are changed, and by which coordinates
        for k, own in enumerate(depends.T):
            for changed, members in together:
                if not (changed & own).any():
                    changed |= own
                    members.append(k)
                    break
            else:
                together.append((own.copy(), [k]))
        found: list[tuple[State, Mapping[int, Rows]]] = []
        for _, members in together:
            u = state.u.copy()
            u[members] += self.coordinate_step
            found.append((replace(state, u=u), {k: depends[:, k][self.row_record] for k in members}))
        return found

    def _depends_on(self, record: Any) -> Rows:
        """Mask (n,) of the coordinates u on which the simulation of a record depends.

        These are the coordinates of its specimen and material, and all extras.
        """
        found = self.baseline.informed_by(record, whole_material=False)
        found[self.baseline.first_extra :] = True
        return found

    def _probes(self, state: State, candidates: Sequence[Candidate]) -> list[tuple[State, float, list[int]]]:
        """States with one perturbed effect, the step, and the candidates (by index) that share it."""
        groups: dict[object, list[int]] = {}
        for k, c in enumerate(candidates):
            # a candidate of an older experiment may apply to no record of this one
            if self.visible.get(c, True) and self.reached(c).any():
                groups.setdefault((c.form, self._step(c, state)), []).append(k)
        found = []
        for members in groups.values():
            first = candidates[members[0]]
            step = self._step(first, state)
            probe = first if len(members) == 1 else replace(first, at="all", alternatives=0)
            now = state.amplitudes.get(probe, 0.0)
            found.append((replace(state, amplitudes={**state.amplitudes, probe: now + step}), step, members))
        return found

    def _step(self, candidate: Candidate, state: State) -> float:
        """Finite-difference step of an amplitude [SI]; negative if a positive step leaves the bounds."""
        effect = self.effects[candidate.effect]
        now = max((a for c, a in state.amplitudes.items() if c.form == candidate.form), default=0.0)
        return effect.step if now + effect.step <= effect.bounds[1] else -effect.step

    def _whole(self, misfit: Array, state: State) -> Array:
        return np.concatenate([self.noise.whiten(misfit), self.baseline.prior_residuals(state.u)])

    # -- candidates --

    def _set_candidates(self) -> None:
        """All candidates of the records, and which of them the records identify."""
        self.candidates = candidates_of(self.records, self.effects)
        self.visible = self._visible(self.records)

    def _visible(self, records: Sequence[Any]) -> dict[Candidate, bool]:
        """True for each candidate that these records identify."""
        found = {}
        for c in self.candidates:
            model = self.effects[c.effect]
            touched = [r for r in records if reaches(c, r, model)]
            found[c] = bool(touched) and model.identifiable(touched, records)
        return found

    def reached(self, candidate: Candidate) -> Rows:
        """True for each record that a candidate applies to, shape (records,)."""
        model = self.effects[candidate.effect]
        return np.array([reaches(candidate, r, model) for r in self.records], dtype=bool)

    def acting(self, state: State, record: Any) -> dict[tuple[str, float | None, float | None], float]:
        """Amplitudes of the effects in a record, summed by form [SI]."""
        found: dict[tuple[str, float | None, float | None], float] = {}
        for c, a in state.amplitudes.items():
            if self.visible.get(c, True) and reaches(c, record, self.effects[c.effect]):
                found[c.form] = found.get(c.form, 0.0) + a
        return found
