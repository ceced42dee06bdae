"""Bars that are let go, of all trials together, with the catalogue's effects nested in a reduced bar.

What is compared are displacements of markers in the plane of the swing: held, swinging (from one period
after the release on, since no hand lets go in an instant) and settled, in means of neighbouring samples.
Their noise is the lab's marker error; nuisances are marginalised: the cameras' frame, markers' places and
zeros, a twist, what FEM adds to the reduced bar.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.advice import most_parted
from calibration.diagnosis.bars._candidates import candidates_of
from calibration.diagnosis.bars._coordinates import Coordinates
from calibration.diagnosis.bars._differences import linearised
from calibration.diagnosis.bars._families import families_of, hit_by, untold
from calibration.diagnosis.bars._fem import Correction, corrections, uncorrected
from calibration.diagnosis.bars._noise import Noise
from calibration.diagnosis.bars._nuisances import columns_of
from calibration.diagnosis.bars._patterns import patterns_of
from calibration.diagnosis.bars._record import Record, further, records_of
from calibration.diagnosis.bars._remarks import remarks_on
from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars._simulation import Simulation
from calibration.diagnosis.bars._start import start_of
from calibration.diagnosis.bars.advice import advise
from calibration.diagnosis.bars.effects import EFFECTS, BarEffect
from calibration.diagnosis.bars.experiments import Release
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Linear, State
from calibration.diagnosis.specimens import mean_moduli
from calibration.errors import InputError
from calibration.experiment.model import Experiment

Array = NDArray[np.float64]

MOVED = 0.05  # of ln G, after which FEM is asked anew


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

    most_causes = 3

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
        self.workers, self.fem = workers, fem
        self.effects: Mapping[str, BarEffect] = {n: e for n, e in EFFECTS.items() if n not in without}
        self.coordinates = Coordinates.of(self.records)
        self.names = self.coordinates.names
        periods = [r.period for r in self.records]
        self.reference = float(np.exp(np.mean(np.log(periods)))) / (2.0 * np.pi)
        self.candidates = candidates_of(self.records, self.effects)
        self.simulation = Simulation(
            records=self.records,
            coordinates=self.coordinates,
            effects=self.effects,
            fixes=[uncorrected(r, usual=fem) for r in self.records],
            reference=self.reference,
        )
        self.noise = Noise.bare(_deviations(self.records))
        self.wrong: list[str] = []
        self._asked: Array | None = None

    @property
    def points(self) -> int:
        return self.noise.points

    @property
    def fixes(self) -> Sequence[Correction]:
        """What FEM adds, of each record."""
        return self.simulation.fixes

    # -- what the search asks for --

    def start(self) -> Array:
        """The modulus whose swing is as fast as the measured one, the damping of its ratio, and the release
        nearest to the data. ValueError where the bar has no equilibrium."""
        return start_of(self.simulation)

    def retake(self, state: State, *, rough: bool = False) -> None:
        """Nuisances' columns and the correction by FEM, taken at a state; rough: without asking FEM."""
        of_bar = [self.coordinates.specimens.index(r.specimen) for r in self.records]
        moduli = state.u[of_bar]
        if self.fem and not rough and (self._asked is None or np.abs(moduli - self._asked).max() > MOVED):
            bars = self._settings(state)
            fixes, self.wrong = corrections(
                self.records, [b.shear for b in bars], [b.viscous for b in bars], workers=self.workers
            )
            self.simulation = replace(self.simulation, fixes=fixes)
            self._asked = moduli
        own = [self.simulation.own(k, state) for k in range(len(self.records))]
        known = columns_of(
            self.records,
            self._settings(state),
            [o[0] for o in own],
            self.fixes,
            lambda k, setting: self.simulation.rows(k, setting, own[k]),
        )
        self.noise = self.noise.knowing(known)

    def residuals(self, states: Sequence[State]) -> Array:
        size = self.points + len(self.coordinates.prior)
        found = np.full((len(states), size), np.nan)
        for row, state in zip(found, states, strict=True):
            whole = self._whole(state)
            if whole is not None:
                row[:] = whole
        return found

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        return linearised(self._whole, state, candidates, self.effects)

    def patterns(self) -> Mapping[str, Array]:
        found = {}
        for name, raw in patterns_of(self.records).items():
            none = np.zeros((len(self.coordinates.prior), raw.shape[1]))
            found[name] = np.vstack([self.noise.whiten(raw), none])
        return found

    # -- what folds ask for --

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]:
        return families_of(self.records)

    def rows(self, group: object) -> NDArray[np.bool_]:
        hit = self._hit(group)[self.noise.used]
        return np.concatenate([hit, np.zeros(len(self.coordinates.prior), dtype=bool)])

    def part(self, group: object, *, others: bool) -> BarModel:
        some = copy(self)
        some.noise = self.noise.among(self._hit(group) != others)
        return some

    def unseen(self, group: object) -> NDArray[np.bool_]:
        return untold(self.records, self.coordinates, self.noise.used & ~self._hit(group))

    def distance_rms(self, state: State) -> float:
        """rms of measured less simulated displacement of single means, nuisances taken out [m]."""
        left = np.concatenate(self.registered(state))[self.noise.used]
        return float(np.sqrt(np.mean(left**2)))

    def noise_rms(self) -> float:
        return float(np.sqrt(np.mean(self.noise.sd[self.noise.used] ** 2)))

    # -- what verdicts and reports ask for --

    @property
    def unit(self) -> tuple[str, float]:
        return "mm", 1e3

    def advice(self, rivals: list[Explanation]) -> str:
        return most_parted(advise(self, rivals)[0], rivals)

    def released_anew(self, release: Release, state: State) -> Self | None:
        """The same bars in another experiment, as a state predicts it, nuisances drawn anew; None where it
        cannot be done."""
        some = copy(self)
        some.records = [further(r, release.stretch) for r in self.records]
        some.simulation = replace(self.simulation, records=some.records, pose=release.pose)
        some.noise = Noise.bare(_deviations(some.records))
        try:
            some.retake(state, rough=True)
            predicted = some.simulation.predicted(state)
        except ValueError:
            return None
        some.records = [r.measuring(p) for r, p in zip(some.records, predicted, strict=True)]
        return some

    def remarks(self) -> list[str]:
        return [*remarks_on(self.records, len(self.coordinates.near) > 0), *self.wrong]

    def registered(self, state: State) -> list[Array]:
        """Simulated less measured displacement of each record's rows [m], the nuisances at their most likely
        values taken out; NaN where nothing was measured. ValueError where a bar has no equilibrium."""
        left = self._left(state)
        whole = self.noise.taken_out(np.concatenate(left))
        return np.split(whole, np.cumsum([len(x) for x in left])[:-1])

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        owners = self.coordinates.owners
        return mean_moduli(owners, u[: len(owners)])

    def tip_height(self, k: int, state: State, time: Array) -> Array:
        """Mean height (t,) [m] of a record's outer markers, `time` after the first guess of its release."""
        return self.simulation.tip_height(k, state, time)

    # -- inside --

    def _settings(self, state: State) -> list[Setting]:
        return [self.simulation.setting(k, state) for k in range(len(self.records))]

    def _left(self, state: State) -> list[Array]:
        predicted = self.simulation.predicted(state)
        return [p - r.measured() for p, r in zip(predicted, self.records, strict=True)]

    def _whole(self, state: State) -> Array | None:
        try:
            left = self._left(state)
        except (ValueError, np.linalg.LinAlgError):
            return None
        z = self.noise.whiten(np.concatenate(left))
        found = np.concatenate([z, self.coordinates.off(state.u)])
        return found if np.isfinite(found).all() else None

    def _hit(self, group: object) -> NDArray[np.bool_]:
        return hit_by(group, len(self.noise.sd))


def _deviations(records: Sequence[Record]) -> Array:
    return np.concatenate([r.deviations() for r in records])
