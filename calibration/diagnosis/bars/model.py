"""Bars that are let go, of all trials together, with the catalogue's effects nested in a reduced bar.

What is compared are displacements of markers in the plane of the swing: held, swinging (from one period
after the release on, since no hand lets go in an instant) and settled, in means of neighbouring samples.
Their noise is the lab's marker error; nuisances are marginalised: the cameras' frame, markers' places and
zeros, a twist, what FEM adds to the reduced bar.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.advice import most_parted
from calibration.diagnosis.bars._bar import Swing, carried, clamp_motion, swing
from calibration.diagnosis.bars._candidates import candidates_of, kind_of, load_of, reaches
from calibration.diagnosis.bars._fem import Correction, corrections, uncorrected
from calibration.diagnosis.bars._nuisances import columns_of
from calibration.diagnosis.bars._patterns import patterns_of
from calibration.diagnosis.bars._record import LAST, Record, further, groups_of, records_of
from calibration.diagnosis.bars._remarks import remarks_on
from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.advice import advise
from calibration.diagnosis.bars.effects import EFFECTS, BarEffect
from calibration.diagnosis.bars.experiments import Release, as_it_is
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Linear, State
from calibration.diagnosis.specimens import mean_moduli, scatter_rows
from calibration.errors import InputError
from calibration.experiment.model import Experiment

Array = NDArray[np.float64]

RELEASE = 0.01  # seconds, and
START = 0.1  # part of the settled pose, that one unit of a trial's own coordinates is
RELEASE_SD, START_SD = 0.03, 0.2  # what is known of them beforehand [s], [-]
VISCOUS, VISCOUS_SD = 2e-3, 3.0  # [s] and sd of its logarithm
SHARED, SHARED_SD = 0.5, 0.5  # of markers next to a clamp: part by which they go with it
# Of ln G from one load to another: by how much the reduced bar may err there (its frequency against FEM's:
# 0.1 to 0.3 %), and one unit of the coordinate. It moves the phase of the last swings by so much that it is
# no linear nuisance.
LOAD, LOAD_SD = 0.02, 0.003
SLIPPED = 0.4  # periods by which a swing may get out of step until its end; further out, the way back is lost
# What changes a frequency has a long column, of which a modulus takes nearly all; the closed forms of the
# reduced bar leave nothing else to finite differences.
UNSEEN = 1e-4
STEP = 1e-5  # of a coordinate u, in a finite difference
MOVED = 0.05  # of ln G, after which FEM is asked anew
REMEMBERED = 400
Own = tuple[float, float, float]  # release [s], start, share


class BarModel:
    """Baseline: neo-Hookean, nearly incompressible, one modulus a specimen and one relaxation time a material
    (damping in proportion to stiffness). See `calibration.diagnosis.nested.Nested` and `heldout.Foldable`.

    names: ln(G / 1 Pa) of each specimen (trials that name none share one a material); ln of each material's
    relaxation time / 1 s; of each trial its release (in 10 ms after the first guess) and where it was let go
    (in tenths of the way to where it settles); the reduced bar's error at each load but the first (in 2 % of
    the modulus); of each specimen with markers next to the clamp the part by which these go with the clamp.
    without: effects taken out of the catalogue. fem: False leaves plain beam theory.
    InputError where there is no bar with markers, or where one lacks something.
    """

    def __init__(
        self,
        experiment: Experiment,
        *,
        without: Sequence[str] = (),
        workers: int | None = None,
        fem: bool = True,
    ) -> None:
        self.records: Sequence[Record] = records_of(experiment)
        if not self.records:
            raise InputError("experiment.yaml: trials: expected a beam with markers")
        self.experiment = experiment
        self.workers, self.fem = workers, fem
        self.effects: Mapping[str, BarEffect] = {n: e for n, e in EFFECTS.items() if n not in without}
        self.specimens = tuple(dict.fromkeys(r.specimen for r in self.records))
        owner = {r.specimen: r.trial.material for r in self.records}
        self.owners = tuple(owner[s] for s in self.specimens)
        self.materials = tuple(dict.fromkeys(self.owners))
        trials = [r.name for r in self.records]
        self.loads = tuple(groups_of(self.records))
        self.near = tuple(dict.fromkeys(r.specimen for r in self.records if (r.near & ~r.inside).any()))
        self.names = (
            self.specimens
            + tuple(f"{m} relaxation time" for m in self.materials)
            + tuple(f"{t} {what}" for t in trials for what in ("release", "start"))
            + tuple(f"error with {load}" for load in self.loads[1:])
            + tuple(f"{s} share of the clamp" for s in self.near)
        )
        self.trials = tuple(trials)
        periods = [r.period for r in self.records]
        self.reference = float(np.exp(np.mean(np.log(periods)))) / (2.0 * np.pi)
        self.candidates = candidates_of(self.records, self.effects)
        self.fixes: list[Correction] = [uncorrected(r, usual=fem) for r in self.records]
        self.wrong: list[str] = []
        self._asked: Array | None = None
        self._prior, self._centre = self._priors()
        self._rows = np.ones(sum(len(r.measured()) for r in self.records), dtype=bool)
        self._known = np.zeros((len(self._rows), 0))
        self._whitener: tuple[Array, Array] | None = None
        self._seen: dict[object, Array] = {}
        self._pose: Callable[[Setting], Setting] = as_it_is

    @property
    def points(self) -> int:
        return int(np.count_nonzero(self._rows & self._there()))

    # -- what the search asks for --

    def start(self) -> Array:
        """The modulus whose swing is as fast as the measured one, the damping of its ratio, and the release
        nearest to the data. ValueError where the bar has no equilibrium."""
        u = self._centre_of_u()
        for n, name in enumerate(self.specimens):
            mine = [r for r in self.records if r.specimen == name]
            u[n] = np.mean([np.log(_modulus(r, self.fixes[0].stiff_root)) for r in mine])
        for n, name in enumerate(self.materials):
            mine = [r for r in self.records if r.trial.material == name]
            u[len(self.specimens) + n] = np.mean([np.log(r.ratio * r.period / np.pi) for r in mine])
        for k, r in enumerate(self.records):
            state = State(u=u)
            setting, (_, start, share) = self.setting(k, state), self._own(k, state)
            there = np.isfinite(r.deviations())
            tries = np.linspace(-RELEASE_SD, RELEASE_SD, 61)
            costs = [
                float(np.sum(((self._predicted(k, setting, (t, start, share)) - r.measured())[there]) ** 2))
                for t in r.released + tries
            ]
            u[self._of_trial(r)] = tries[int(np.argmin(costs))] / RELEASE
        return u

    def retake(self, state: State, *, rough: bool = False) -> None:
        """Nuisances' columns and the correction by FEM, taken at a state; rough: without asking FEM."""
        moduli = np.array([state.u[self.specimens.index(r.specimen)] for r in self.records])
        if self.fem and not rough and (self._asked is None or np.abs(moduli - self._asked).max() > MOVED):
            bars = [self.setting(k, state) for k in range(len(self.records))]
            self.fixes, self.wrong = corrections(
                self.records, [b.shear for b in bars], [b.viscous for b in bars], workers=self.workers
            )
            self._asked = moduli
        self._seen.clear()
        own = [self._own(k, state) for k in range(len(self.records))]
        self._known = columns_of(
            self.records,
            [self.setting(k, state) for k in range(len(self.records))],
            [o[0] for o in own],
            self.fixes,
            lambda k, setting: self._predicted(k, setting, own[k]),
        )
        self._whitener = None

    def residuals(self, states: Sequence[State]) -> Array:
        size = self.points + len(self._prior)
        found = np.full((len(states), size), np.nan)
        for row, state in zip(found, states, strict=True):
            whole = self._whole(state)
            if whole is not None:
                row[:] = whole
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        z = self._whole(state)
        if z is None:
            raise ValueError("the bar has no equilibrium at this state")
        by_u = np.zeros((z.size, len(self.names)))
        for k in range(len(self.names)):
            for step in (STEP, -STEP):
                u = state.u.copy()
                u[k] += step
                moved = self._whole(replace(state, u=u))
                if moved is not None:
                    by_u[:, k] = (moved - z) / step
                    break
        columns = np.zeros((z.size, len(candidates)))
        for k, c in enumerate(candidates):
            now = state.amplitudes.get(c, 0.0)
            effect = self.effects[c.effect]
            step = effect.step if now + effect.step <= effect.bounds[1] else -effect.step
            moved = self._whole(replace(state, amplitudes={**state.amplitudes, c: now + step}))
            if moved is not None:  # a candidate without an equilibrium one step on explains nothing
                columns[:, k] = (moved - z) / step
        return Linear(
            state=state,
            z=z,
            by_u=by_u,
            columns=columns,
            candidates=tuple(candidates),
            unseen=UNSEEN,
        )

    def patterns(self) -> Mapping[str, Array]:
        found = {}
        for name, raw in patterns_of(self.records).items():
            none = np.zeros((len(self._prior), raw.shape[1]))
            found[name] = np.vstack([self._whiten(raw), none])
        return found

    # -- what folds ask for --

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]:
        """Rows (by number) by load, by trial, and what swings against what has settled."""
        starts = np.cumsum([0, *(len(r.measured()) for r in self.records)])
        every = [np.arange(a, b) for a, b in pairwise(starts)]
        late = [r.labels()[2] > LAST * r.period for r in self.records]
        families = {
            "leave-one-load-out": {
                name: [every[k] for k in members] for name, members in groups_of(self.records).items()
            },
            "leave-one-trial-out": {r.name: [every[k]] for k, r in enumerate(self.records)},
            "swing-or-settled-out": {
                "the swing": [e[~x] for e, x in zip(every, late, strict=True)],
                "what has settled": [e[x] for e, x in zip(every, late, strict=True)],
            },
        }
        found: dict[str, Sequence[tuple[str, object]]] = {}
        known = []
        for family, groups in families.items():
            sets = {name: frozenset(np.concatenate(parts).tolist()) for name, parts in groups.items()}
            if len(sets) > 1 and all(sets.values()) and set(sets.values()) not in known:
                known.append(set(sets.values()))
                found[family] = list(sets.items())
        return found

    def rows(self, group: object) -> NDArray[np.bool_]:
        hit = self._hit(group)[self._rows & self._there()]
        return np.concatenate([hit, np.zeros(len(self._prior), dtype=bool)])

    def part(self, group: object, *, others: bool) -> BarModel:
        some = copy(self)
        some._rows = self._rows & (self._hit(group) != others)
        some._whitener = None
        return some

    def released_anew(self, release: Release, state: State) -> Self | None:
        """The same bars in another experiment, as a state predicts it, nuisances drawn anew; None where it
        cannot be done."""
        some = copy(self)
        some.records = [further(r, release.stretch) for r in self.records]
        some._pose = release.pose
        some._seen = {}
        some._rows = np.ones(sum(len(r.measured()) for r in some.records), dtype=bool)
        some._whitener = None
        try:
            some.retake(state, rough=True)
            predicted = some.predicted(state)
        except ValueError:
            return None
        some.records = [r.measuring(p) for r, p in zip(some.records, predicted, strict=True)]
        return some

    def unseen(self, group: object) -> NDArray[np.bool_]:
        """A modulus and a trial's own coordinates that no other rows tell of. What only the swing tells (the
        release) is taken from it where the swing is left out."""
        left = self._rows & self._there() & ~self._hit(group)
        found = np.zeros(len(self.names), dtype=bool)
        start = 0
        told: set[str] = set()
        for r in self.records:
            rows = slice(start, start + len(r.measured()))
            start = rows.stop
            time = r.labels()[2]
            swinging = np.isfinite(time) & (time <= LAST * r.period)
            first = self._of_trial(r)
            found[first : first + 2] = not (left[rows] & swinging).any()
            if left[rows].any():
                told |= {r.specimen, r.trial.material, load_of(r)}
        for k, name in enumerate((*self.specimens, *self.materials)):
            found[k] = name not in told
        for load in self.loads[1:]:
            found[self._of_load(load)] = load not in told
        return found

    def distance_rms(self, state: State) -> float:
        """rms of measured less simulated displacement of single means, nuisances taken out [m]."""
        there = self._rows & self._there()
        left = np.concatenate(self.registered(state))[there]
        return float(np.sqrt(np.mean(left**2)))

    def noise_rms(self) -> float:
        return float(np.sqrt(np.mean(self._deviations()[self._rows & self._there()] ** 2)))

    # -- what reports ask for --

    @property
    def unit(self) -> tuple[str, float]:
        return "mm", 1e3

    def advice(self, rivals: list[Explanation]) -> str:
        return most_parted(advise(self, rivals)[0], rivals)

    def remarks(self) -> list[str]:
        return [*remarks_on(self.records, len(self.near) > 0), *self.wrong]

    def registered(self, state: State) -> list[Array]:
        """Simulated less measured displacement of each record's rows [m], the nuisances at their most likely
        values taken out; NaN where nothing was measured. ValueError where a bar has no equilibrium."""
        left = [p - r.measured() for p, r in zip(self.predicted(state), self.records, strict=True)]
        whole = np.concatenate(left)
        used = self._rows & self._there()
        known = self._known[used] / self._deviations()[used][:, None]
        system = known.T @ known + np.eye(known.shape[1])
        likely = np.linalg.solve(system, known.T @ (whole[used] / self._deviations()[used]))
        whole = whole - self._known @ likely
        return np.split(whole, np.cumsum([len(x) for x in left])[:-1])

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        return mean_moduli(self.owners, u[: len(self.owners)])

    def predicted(self, state: State) -> list[Array]:
        """Rows of each record [m], without nuisances. ValueError where a bar has no equilibrium."""
        return [
            self._predicted(k, self.setting(k, state), self._own(k, state)) for k in range(len(self.records))
        ]

    def setting(self, k: int, state: State) -> Setting:
        """Of a record's bar, with the state's effects in it."""
        r = self.records[k]
        load = load_of(r)
        error = LOAD * float(state.u[self._of_load(load)]) if load != self.loads[0] else 0.0
        found = replace(
            r.setting,
            shear=float(np.exp(state.u[self.specimens.index(r.specimen)] + error)),
            viscous=float(np.exp(state.u[len(self.specimens) + self.materials.index(r.trial.material)])),
            stiff_root=self.fixes[k].stiff_root,
            reference=self.reference,
            inertia=self.fixes[k].inertia,
        )
        for c, a in state.amplitudes.items():
            effect = self.effects[c.effect]
            if a != 0.0 and reaches(c, r, effect):
                found = effect.alter(found, a, kind_of(c))
        return self._pose(found)

    def swing_of(self, k: int, state: State) -> Swing:
        """A record's solved bar. ValueError where it has no equilibrium."""
        return swing(self.setting(k, state), start=self._own(k, state)[1])

    def tip_height(self, k: int, state: State, time: Array) -> Array:
        """Mean height (t,) [m] of a record's outer markers, `time` after the first guess of its release."""
        r = self.records[k]
        since = time + r.released - self._own(k, state)[0]
        moved = self._moved(k, self.setting(k, state), self._own(k, state), since)
        return np.asarray(moved[r.tips, :, 1].mean(axis=0))

    # -- inside --

    def _own(self, k: int, state: State) -> Own:
        r = self.records[k]
        first = self._of_trial(r)
        share = 0.0
        if r.specimen in self.near:
            share = float(state.u[len(self.names) - len(self.near) + self.near.index(r.specimen)])
        return r.released + RELEASE * float(state.u[first]), START * float(state.u[first + 1]), share

    def _of_trial(self, record: Record) -> int:
        """Where a trial's own coordinates begin."""
        return len(self.specimens) + len(self.materials) + 2 * self.trials.index(record.name)

    def _of_load(self, load: str) -> int:
        """Where the error at a load stands that is not the first."""
        return len(self.names) - len(self.near) - len(self.loads) + self.loads.index(load)

    def _predicted(self, k: int, setting: Setting, own: Own) -> Array:
        key = (k, setting, own)
        if key not in self._seen:
            if len(self._seen) >= REMEMBERED:
                self._seen.pop(next(iter(self._seen)))
            self._seen[key] = self._simulated(k, setting, own)
        return self._seen[key]

    def _simulated(self, k: int, setting: Setting, own: Own) -> Array:
        r = self.records[k]
        moved = self._moved(k, setting, own, r.time - own[0])
        return r.flat(lambda i: moved[i], np.zeros((len(r.places), 2)))

    def _moved(self, k: int, setting: Setting, own: Own, since: Array) -> Array:
        """Displacement of a record's markers (m, t, 2) [m], at times since the release by the lab's clock."""
        r, fix = self.records[k], self.fixes[k]
        _, start, share = own
        time = since * (1.0 + setting.clock)
        solved = swing(setting, start=start)
        q = solved.coordinates(time)
        moved = carried(setting, q, r.places).displacement
        drop = -moved[r.tips, :, 1].mean(axis=0)
        moved = moved + fix.left[:, None, :] * (drop / fix.drop)[None, :, None]
        if r.near.any():
            clamped = clamp_motion(setting, q, r.places).displacement
            part = np.where(r.inside, 1.0, share)[:, None, None]
            moved[r.near] += (part * (clamped - moved))[r.near]
        moved = moved * (time > 0.0)[None, :, None]
        slip = abs(solved.frequencies[0] * (1.0 + setting.clock) * r.period - 1.0) * LAST
        if self._pose is as_it_is and slip > SLIPPED:
            raise ValueError("the swing loses step with the measured one")
        c, s = (1.0 + setting.scale) * np.array([np.cos(setting.roll), np.sin(setting.roll)])
        return np.stack([c * moved[..., 0] - s * moved[..., 1], s * moved[..., 0] + c * moved[..., 1]], -1)

    def _deviations(self) -> Array:
        return np.concatenate([r.deviations() for r in self.records])

    def _there(self) -> NDArray[np.bool_]:
        return np.isfinite(self._deviations())

    def _whole(self, state: State) -> Array | None:
        try:
            left = [p - r.measured() for p, r in zip(self.predicted(state), self.records, strict=True)]
        except (ValueError, np.linalg.LinAlgError):
            return None
        z = self._whiten(np.concatenate(left))
        found = np.concatenate([z, self._prior @ state.u - self._centre])
        return found if np.isfinite(found).all() else None

    def _whiten(self, values: Array) -> Array:
        """Rows that are used, (m,) or (m, k), over their noise and the nuisances': (1 + A A^T)^(-1/2)."""
        used = self._rows & self._there()
        sd = self._deviations()[used]
        if self._whitener is None:
            v, s, _ = np.linalg.svd(self._known[used] / sd[:, None], full_matrices=False)
            self._whitener = v, 1.0 - 1.0 / np.sqrt(1.0 + s**2)
        v, less = self._whitener
        x = values[used] / (sd if values.ndim == 1 else sd[:, None])
        inside = v.T @ x
        return np.asarray(x - v @ (less * inside if values.ndim == 1 else less[:, None] * inside))

    def _hit(self, group: object) -> NDArray[np.bool_]:
        assert isinstance(group, frozenset)
        hit = np.zeros(len(self._rows), dtype=bool)
        hit[list(group)] = True
        return hit

    def _centre_of_u(self) -> Array:
        u = np.zeros(len(self.names))
        first = len(self.specimens)
        u[first : first + len(self.materials)] = np.log(VISCOUS)
        u[len(u) - len(self.near) :] = SHARED
        return u

    def _priors(self) -> tuple[Array, Array]:
        n, first = len(self.names), len(self.specimens)
        scatter = scatter_rows(self.owners)
        sds = np.concatenate([
            np.full(len(self.materials), VISCOUS_SD),
            np.tile([RELEASE_SD / RELEASE, START_SD / START], len(self.records)),
            np.full(len(self.loads) - 1, LOAD_SD / LOAD),
            np.full(len(self.near), SHARED_SD),
        ])  # fmt: skip
        own = np.zeros((len(sds), n))
        own[:, first:] = np.diag(1.0 / sds)
        found = np.vstack([np.column_stack([scatter, np.zeros((len(scatter), n - first))]), own])
        return found, found @ self._centre_of_u()


def _modulus(record: Record, stiff_root: float) -> float:
    """Whose reduced bar swings as fast as the record [Pa]."""
    shear = 1e5
    usual = replace(record.setting, stiff_root=stiff_root)
    for _ in range(40):
        try:
            found = float(swing(replace(usual, shear=shear)).frequencies[0])
        except ValueError:  # too soft to stand its load
            shear *= 4.0
            continue
        if abs(found * record.period - 1.0) < 1e-4:
            break
        shear *= float(np.clip((1.0 / (found * record.period)) ** 2, 0.3, 4.0))
    return shear
