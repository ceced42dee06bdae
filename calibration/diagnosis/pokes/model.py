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
from scipy.linalg import cholesky, solve_triangular

from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Linear, State
from calibration.diagnosis.pokes._candidates import candidates_of, kind_of, reaches
from calibration.diagnosis.pokes._curves import Curve, Curves, Wanted
from calibration.diagnosis.pokes._families import families_of
from calibration.diagnosis.pokes._nuisances import TOUCH, columns_of, point_sd, side_sd
from calibration.diagnosis.pokes._patterns import patterns_of
from calibration.diagnosis.pokes._record import Record, records_of
from calibration.diagnosis.pokes._remarks import remarks_on
from calibration.diagnosis.pokes.effects import EFFECTS, PokeEffect
from calibration.errors import InputError
from calibration.experiment.model import Experiment, PokeTrial

Array = NDArray[np.float64]

SCATTER = 0.15  # of ln G from one specimen of a material to the next
STEP = 1e-4  # of ln G, in a finite difference


class PokeModel:
    """Baseline: neo-Hookean, nearly incompressible, one modulus a specimen (trials that name none share one a
        material). See `calibration.diagnosis.nested.Nested` and `heldout.Foldable`.

    names: of the specimens; coordinates are u = ln(G / 1 Pa) of each. without: effects taken out of the
    catalogue. workers: as in `tisim.simulate`. Each geometry is simulated once here, and once for each change
    of it that a search asks for. InputError where there is no poke, or one that cannot be simulated;
    ValueError where one has no answer.
    """

    def __init__(
        self, experiment: Experiment, *, without: Sequence[str] = (), workers: int | None = None
    ) -> None:
        trials = [t for t in experiment.trials if isinstance(t, PokeTrial)]
        if not trials:
            raise InputError("experiment.yaml: trials: expected a poke")
        self.experiment = experiment
        self.effects: Mapping[str, PokeEffect] = {n: e for n, e in EFFECTS.items() if n not in without}
        self.curves = Curves(workers)
        self.records: Sequence[Record] = records_of(trials)
        self.names = tuple(dict.fromkeys(r.specimen for r in self.records))
        owner = {r.specimen: r.material for r in self.records}
        self.materials = tuple(owner[n] for n in self.names)
        self._prior = _scatter(self.materials)
        self.left_out = self._reach()
        self.candidates: tuple[Candidate, ...] = candidates_of(self.records, self.effects)
        self._visible: dict[Candidate, bool] = {c: self._shown(c, self.records) for c in self.candidates}
        self._kept = np.ones(self._size, dtype=bool)
        self._sd = np.zeros(0)
        self._elastic: list[Array] = []
        self._known = np.zeros((0, 0))
        self._root: Array | None = None

    @property
    def _size(self) -> int:
        """Rows of all measurements: forces along, then forces across."""
        return sum(r.points * (1 if r.across is None else 3) for r in self.records)

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
                unit = self._base(r).at(r.depth)
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
        slopes, sds, sides = [], [], []
        for r in self.records:
            shear = self._shear(r, state)
            curve = self._base(r)
            forces.append(shear * curve.at(r.depth))
            slopes.append(shear * curve.slope(r.depth, max(TOUCH * r.depth_sd, 1e-6)))
            sds.append(point_sd(r, forces[-1], slopes[-1]))
            if r.across is not None:
                sides.append(np.repeat(side_sd(r, forces[-1]), 2))
        self._elastic = forces
        columns = columns_of(self.records, forces, slopes)
        more = self._size - len(columns)
        self._sd = np.concatenate([*sds, *sides])
        self._known = np.vstack([columns, np.zeros((more, columns.shape[1]))])
        self._whitened()

    def residuals(self, states: Sequence[State]) -> Array:
        self._prepare(states)
        found = np.empty((len(states), self.points + len(self._prior)))
        for row, state in zip(found, states, strict=True):
            row[:] = self._whole(state)
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        steps = {c: self._step(c, state) for c in candidates if self._visible[c]}
        moved = {c: _with(state, c, state.amplitudes.get(c, 0.0) + s) for c, s in steps.items()}
        self._prepare([state, *moved.values()])
        base = self._raw(state)
        by_u = np.zeros((self.points + len(self._prior), len(self.names)))
        for k in range(len(self.names)):
            u = state.u.copy()
            u[k] += STEP
            change = self._raw(State(u=u, amplitudes=state.amplitudes)) - base
            by_u[: self.points, k] = self._whiten(change / STEP)
        by_u[self.points :] = self._prior
        raw = np.zeros((self._size, len(candidates)))
        for k, c in enumerate(candidates):
            if c in moved:
                raw[:, k] = (self._raw(moved[c]) - base) / steps[c]
        columns = np.vstack([self._whiten(raw), np.zeros((len(self._prior), len(candidates)))])
        z = self._whole(state)
        if not np.isfinite(z).all():
            raise ValueError("a poke has no answer at this state")
        return Linear(state=state, z=z, by_u=by_u, columns=columns, candidates=tuple(candidates))

    def patterns(self) -> Mapping[str, Array]:
        found = {}
        for name, columns in patterns_of(self.records, self._elastic).items():
            more = self._size - len(columns)
            raw = np.vstack([columns, np.zeros((more, columns.shape[1]))])
            found[name] = np.vstack([self._whiten(raw), np.zeros((len(self._prior), raw.shape[1]))])
        return found

    # -- what folds ask for --

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]:
        """Rows by trial, by material, by phase and in fifths of each record."""
        return families_of(self.records, self._size)

    def rows(self, group: object) -> NDArray[np.bool_]:
        hit = np.zeros(self.points + len(self._prior), dtype=bool)
        hit[: self.points] = self._hit(group)[self._kept]
        return hit

    def part(self, group: object, *, others: bool) -> PokeModel:
        some = copy(self)
        some._kept = self._kept & (self._hit(group) != others)
        some._whitened()
        return some

    def measuring(self, trials: Sequence[PokeTrial]) -> PokeModel:
        """The same specimens in other trials, seen beside those that there are: coordinates and candidates
        stay. Errors are still to be taken (`retake`)."""
        some = copy(self)
        some.records = records_of(trials)
        some._reach()
        both = [*self.records, *some.records]
        some._visible = {c: self._shown(c, both) for c in self.candidates}
        some._kept = np.ones(some._size, dtype=bool)
        some._root = None
        return some

    def unseen(self, group: object) -> NDArray[np.bool_]:
        left = self._kept & ~self._hit(group)
        seen = {r.material for r, rows in self._rows() if left[rows].any()}
        return np.array([m not in seen for m in self.materials])

    def distance_rms(self, state: State) -> float:
        """rms of measured less simulated force [N], nuisances at their most likely values taken out."""
        left = self._taken_out() @ self._raw(state)[self._kept]
        return float(np.sqrt(np.mean(left**2)))

    def noise_rms(self) -> float:
        """What `distance_rms` would be of the noise alone [N]."""
        taken = self._taken_out()
        covariance = self._covariance()
        return float(np.sqrt(np.einsum("ij,jk,ik->", taken, covariance, taken) / len(taken)))

    # -- what reports ask for --

    @property
    def unit(self) -> tuple[str, float]:
        return "N", 1.0

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        found: dict[str, list[float]] = {}
        for m, value in zip(self.materials, u, strict=True):
            found.setdefault(m, []).append(float(value))
        return {m: float(np.exp(np.mean(v))) for m, v in found.items()}

    def advice(self, rivals: list[Explanation]) -> str:
        from calibration.diagnosis.pokes.advice import ENOUGH, advise

        best = advise(self, rivals)[0]
        names = ", ".join(" + ".join(e.names) for e in rivals)
        if best.separation < 1.0:
            return f"no experiment of the catalogue parts {names}"
        sure = "" if best.separation >= ENOUGH else ", which will help but may not settle it"
        apart = float(np.sqrt(best.separation))
        return f"{best.sentence}: {names} part there by {apart:.0f} standard deviations{sure}"

    def remarks(self) -> list[str]:
        return remarks_on(self.records, self.left_out)

    def registered(self, state: State) -> list[Array]:
        """Simulated less measured force along the rod of each record [N], the most likely nuisances taken
        out."""
        self._prepare([state])
        known = self._taken_out()
        left = np.full(self._size, np.nan)
        left[self._kept] = known @ self._raw(state)[self._kept]
        ends = np.cumsum([r.points for r in self.records])
        return list(np.split(left[: ends[-1]], ends[:-1]))

    def forces(self, state: State) -> list[Array]:
        """Force along the rod [N] of each record at its points, with the state's effects."""
        self._prepare([state])
        return [self._force(state, r) for r in self.records]

    def deviations(self) -> list[Array]:
        """Standard deviation of each point by itself [N], as taken last."""
        ends = np.cumsum([r.points for r in self.records])
        return list(np.split(self._sd[: ends[-1]], ends[:-1]))

    # -- inside --

    def _shear(self, record: Record, state: State) -> float:
        return float(np.exp(state.u[self.names.index(record.specimen)]))

    def _base(self, record: Record) -> Curve:
        return self.curves.fetch([Wanted(geometry=record.geometry, depth=_deepest(record))])[0]

    def _reach(self) -> tuple[str, ...]:
        """Simulate each geometry; points deeper than a simulation reached are left out: a sentence each."""
        self.curves.fetch([Wanted(geometry=r.geometry, depth=_deepest(r)) for r in self.records])
        said, shortened = [], []
        for r in self.records:
            curve = self._base(r)
            deep = r.depth > curve.reached
            if deep.any():
                first = int(np.argmax(deep))  # what came after depends on what is not there
                if first < 5:
                    raise ValueError(f"{r.name}: the simulated poke ends at {1e3 * curve.reached:.2g} mm")
                kept = np.arange(r.points) < first
                said.append(
                    f"{r.name}: from {1e3 * curve.reached:.2f} mm on not used, the simulation ended there"
                    f" ({curve.status})"
                )
                r = r.only(kept)
            shortened.append(r)
        self.records = shortened
        return tuple(said)

    def _force(self, state: State, record: Record) -> Array:
        acting = self._acting(state, record)
        depth = record.depth.copy()
        for (name, _), a in acting.items():
            shift = self.effects[name].shift
            if shift is not None:
                depth = depth + shift(a, record)
        unit = self._base(record).at(depth)
        for (name, kind), a in acting.items():
            if self.effects[name].scene is not None:
                unit = unit + self._changed(record, name, kind, a, depth, across=False)
        force = self._shear(record, state) * np.maximum(unit, 0.0)
        for (name, kind), a in sorted(acting.items(), key=lambda item: self.effects[item[0][0]].stage):
            apply = self.effects[name].force
            if apply is not None:
                force = apply(force, a, record, kind)
        return np.asarray(force)

    def _across(self, state: State, record: Record) -> Array:
        """(k, 2) [N]: what is simulated only; faults of the load cell are those along the rod."""
        unit = self._base(record).sides(record.depth)
        for (name, kind), a in self._acting(state, record).items():
            if self.effects[name].scene is not None:
                unit = unit + self._changed(record, name, kind, a, record.depth, across=True)
        return self._shear(record, state) * unit

    def _changed(
        self, record: Record, name: str, kind: float | None, a: float, depth: Array, *, across: bool
    ) -> Array:
        """What an effect of the scene adds, over the shear modulus: straight between its simulated
        amplitudes."""
        base = self._base(record)
        found = np.zeros((depth.size, 2) if across else depth.size)
        for node, part in _between(self._nodes(record, self.effects[name]), a):
            if node != 0.0 and part != 0.0:
                curve = self.curves.fetch([self._wanted(record, name, kind, node)])[0]
                change = (
                    curve.sides(depth) - base.sides(depth) if across else curve.at(depth) - base.at(depth)
                )
                found = found + part * change
        return found

    def _nodes(self, record: Record, effect: PokeEffect) -> tuple[float, ...]:
        scene = record.geometry.scene(1e-3)
        assert effect.scene is not None
        make, kinds = effect.scene, effect.kinds([record])
        return tuple(n for n in effect.nodes if n == 0.0 or effect.fits(make(scene, None, n, kinds[0])))

    def _wanted(self, record: Record, name: str, kind: float | None, node: float) -> Wanted:
        make = self.effects[name].scene
        assert make is not None
        return Wanted(
            geometry=record.geometry,
            depth=_deepest(record),
            name=f"{name} {kind} {node:.9g}",
            change=lambda poke, mesh: make(poke, mesh, node, kind),
        )

    def _prepare(self, states: Sequence[State]) -> None:
        """Simulate all that these states need, together."""
        wanted = []
        for state in states:
            for r in self.records:
                for (name, kind), a in self._acting(state, r).items():
                    effect = self.effects[name]
                    if effect.scene is None:
                        continue
                    for node, part in _between(self._nodes(r, effect), a):
                        if node != 0.0 and part != 0.0:
                            wanted.append(self._wanted(r, name, kind, node))
        if wanted:
            self.curves.fetch(wanted)

    def _step(self, candidate: Candidate, state: State) -> float:
        """Of a column's difference: for what is simulated, at none the way to the effect's chord, elsewhere
        one that stays between two simulated amplitudes."""
        effect = self.effects[candidate.effect]
        now = state.amplitudes.get(candidate, 0.0)
        if effect.scene is None:
            return effect.step if now + effect.step <= effect.bounds[1] else -effect.step
        if now == 0.0:
            nodes = self._nodes(next(r for r in self.records if reaches(candidate, r, effect)), effect)
            return effect.chord if effect.chord in nodes else min(nodes, key=lambda n: (n == 0.0, abs(n)))
        inside = [n for n in effect.nodes if n != 0.0 and np.sign(n) == np.sign(now)]
        further = max((abs(n) for n in inside), default=abs(now))
        step = effect.step * float(np.sign(now))
        return step if abs(now) + effect.step <= further else -step

    def _acting(self, state: State, record: Record) -> dict[tuple[str, float | None], float]:
        """Effects in a record by name and kind, with the sum of their amplitudes there."""
        total: dict[tuple[str, float | None], float] = {}
        for c, a in state.amplitudes.items():
            if self._visible[c] and reaches(c, record, self.effects[c.effect]):
                key = (c.effect, kind_of(c))
                total[key] = total.get(key, 0.0) + a
        return total

    def _shown(self, candidate: Candidate, records: Sequence[Record]) -> bool:
        effect = self.effects[candidate.effect]
        reached = [r for r in records if reaches(candidate, r, effect)]
        return bool(reached) and effect.shows(reached, records)

    def _raw(self, state: State) -> Array:
        """Simulated less measured [N]."""
        along = [self._force(state, r) - r.force for r in self.records]
        across = [(self._across(state, r) - r.across).ravel() for r in self.records if r.across is not None]
        return np.concatenate([*along, *across])

    def _whole(self, state: State) -> Array:
        return np.concatenate([self._whiten(self._raw(state)), self._prior @ state.u])

    def _covariance(self) -> Array:
        known = self._known[self._kept]
        return np.asarray(np.diag(self._sd[self._kept] ** 2) + known @ known.T)

    def _whitened(self) -> None:
        self._root = np.asarray(cholesky(self._covariance(), lower=True))

    def _whiten(self, raw: Array) -> Array:
        assert self._root is not None, "retake a PokeModel before use"
        return np.asarray(solve_triangular(self._root, raw[self._kept], lower=True))

    def _taken_out(self) -> Array:
        """(points, points): takes the most likely nuisances out of residuals."""
        sd, known = self._sd[self._kept], self._known[self._kept]
        inside = known / sd[:, None] ** 2
        estimate = np.linalg.solve(known.T @ inside + np.eye(known.shape[1]), inside.T)
        return np.asarray(np.eye(len(sd)) - known @ estimate)

    def _hit(self, group: object) -> NDArray[np.bool_]:
        assert isinstance(group, frozenset)
        hit = np.zeros(self._size, dtype=bool)
        hit[list(group)] = True
        return hit

    def _rows(self) -> list[tuple[Record, NDArray[np.intp]]]:
        """Each record with its rows: along, then across."""
        found = []
        first, after = 0, sum(r.points for r in self.records)
        for r in self.records:
            rows = np.arange(first, first + r.points)
            first += r.points
            if r.across is not None:
                rows = np.concatenate([rows, np.arange(after, after + 2 * r.points)])
                after += 2 * r.points
            found.append((r, rows))
        return found


def _deepest(record: Record) -> float:
    return max(float(record.depth.max()), 1e-4)


def _between(nodes: Sequence[float], a: float) -> list[tuple[float, float]]:
    """Nodes with their parts that make up an amplitude: between neighbours, straight on beyond the last."""
    ordered = sorted(nodes)
    if len(ordered) == 1:
        return [(ordered[0], 1.0)]
    upper = min(max(int(np.searchsorted(ordered, a)), 1), len(ordered) - 1)
    low, high = ordered[upper - 1], ordered[upper]
    part = (a - low) / (high - low)
    return [(low, 1.0 - part), (high, part)]


def _with(state: State, candidate: Candidate, amplitude: float) -> State:
    return replace(state, amplitudes={**state.amplitudes, candidate: amplitude})


def _scatter(materials: Sequence[str]) -> Array:
    """Prior rows: specimens of one material lie together within SCATTER."""
    rows = []
    for m in dict.fromkeys(materials):
        mine = [k for k, owner in enumerate(materials) if owner == m]
        for k in mine if len(mine) > 1 else []:
            row = np.zeros(len(materials))
            row[mine] = -1.0 / len(mine)
            row[k] += 1.0
            rows.append(row / SCATTER)
    return np.array(rows).reshape(len(rows), len(materials))
