"""Markers of a beam that is held straight and let go, as whitened residuals over time and at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, MaterialBelief
from calibration.motion._profile import best_delay, profiled
from calibration.motion._track import Track
from calibration.motion._trial import chosen, density, hung_mass, noise
from calibration.motion.kinematics import Motion, marker_motion
from calibration.motion.settings import Damping, Fidelity, Nuisances
from calibration.parameters import Coordinate
from tisim import Beam, Material, Result, Solver, simulate

Array = NDArray[np.float64]
Stage = Literal["motion", "settled"]

MOVED = 10.0  # standard deviations of a marker that tell the release
EARLY, LATE = 5, 2  # samples before and after that sign that the release is looked for in


@dataclass(frozen=True, eq=False, kw_only=True)
class Match:
    """One candidate beside the data, each (samples, 3) [m], per marker in the objective's order.

    release [s] on the data's clock; time (t,), measured and predicted (t, 3) of each marker over the motion;
    settled_measured, settled_predicted (m, 3); nuisances: values in their sds; residuals: whitened, (size,).
    predicted is without the nuisances, corrected with them.
    """

    release: float
    time: tuple[Array, ...]
    measured: tuple[Array, ...]
    predicted: tuple[Array, ...]
    settled_measured: Array
    settled_predicted: Array
    nuisances: dict[str, float]
    residuals: Array


class MarkerObjective:
    """Markers of one trial against a beam let go from its straight rest shape.

    markers: names to use (None: all). window: of the motion, from the first sample on [s]; what comes after
    is averaged and compared with the static equilibrium ("settled"). tip_mass [kg]: that moves with the free
    face; None takes the tip force for a hung mass (`hung_mass`).
    damping: that `residuals(materials)` takes; it is searched with `coordinates` (see `fit_motion`).
    The settled mean has the marker's own sd, not less: what is left there is no noise that averages out.

    InputError names what the trial lacks. Meets `calibration.search.problem.Objective`.
    """

    coordinates = (
        Coordinate(name="mass_damping", unit="1/s", log=False, low=0.0, high=100.0, spread=1.0, start=1.0),
        Coordinate(
            name="stiffness_damping", unit="s", log=False, low=0.0, high=0.05, spread=1e-3, start=1e-3
        ),
    )

    def __init__(
        self,
        trial: BeamTrial,
        belief: MaterialBelief,
        *,
        markers: Sequence[str] | None = None,
        stages: tuple[Stage, ...] = ("motion", "settled"),
        window: float = 2.0,
        tip_mass: float | None = None,
        damping: Damping | None = None,
        nuisances: Nuisances | None = None,
        fidelity: Fidelity | None = None,
        workers: int | None = None,
    ) -> None:
        self.name = f"markers of {trial.id}"
        self.trial = trial
        self.density = density(trial, belief)
        self.sd = noise(trial)
        self.markers = chosen(trial, markers)
        self.stages = stages
        self.window = window
        self.tip_mass = hung_mass(trial) if tip_mass is None else tip_mass
        self.damping = damping or Damping()
        self.spread = nuisances or Nuisances()
        self.fidelity = fidelity or Fidelity()
        self.workers = workers
        self.failures: list[str] = []
        self._first = min(float(m.time[0]) for m in self.markers)
        self._used = [m.time <= self._first + window for m in self.markers]
        if "settled" in stages and any(used.all() for used in self._used):
            raise InputError(
                f"trials.{trial.id}.markers: expected samples later than {self._first + window:g} s, which"
                " the settled value is taken from"
            )
        self.bounds = self._release_bounds()

    @property
    def points(self) -> int:
        """Measured components: the count for a reduced chi-square."""
        motion = 3 * sum(int(u.sum()) for u in self._used) * ("motion" in self.stages)
        return motion + 3 * len(self.markers) * ("settled" in self.stages)

    def size(self) -> int:
        return self.points + len(self.nuisance_names)

    @property
    def nuisance_names(self) -> tuple[str, ...]:
        s, names = self.spread, []
        if s.position:
            names += [f"{m.name} {axis}" for m in self.markers for axis in "xyz"]
        if s.frame:
            names += [f"frame {axis}" for axis in "xyz"]
        if s.offset and "motion" in self.stages:
            names += [f"{m.name} offset {axis}" for m in self.markers for axis in "xyz"]
        return tuple(names)

    def residuals(self, materials: Sequence[Material], damping: Sequence[Damping] | None = None) -> Array:
        """(batch, size): whitened, nuisances and release at their best, the nuisances' own values last.

        damping: one a material; None takes the objective's. NaN where a run has no answer (see `failures`).
        """
        found = np.full((len(materials), self.size()), np.nan)
        for k, match in enumerate(self.matches(materials, damping)):
            if match is not None:
                found[k] = match.residuals
        return found

    def matches(
        self, materials: Sequence[Material], damping: Sequence[Damping] | None = None
    ) -> list[Match | None]:
        """Each candidate beside the data; None where a run has no answer."""
        dampings = [self.damping] * len(materials) if damping is None else list(damping)
        results = simulate(
            [s for m, d in zip(materials, dampings, strict=True) for s in self.scenes(m, d)],
            workers=self.workers,
        )
        n = len(self.stages)
        return [self._match(results[k * n : (k + 1) * n]) for k in range(len(materials))]

    def scenes(self, material: Material, damping: Damping) -> list[Beam]:
        """The beam of each stage."""
        t, f = self.trial, self.fidelity
        at_rest = Beam(
            material=replace(material, density=self.density),
            length=t.free_length,
            section=t.section,
            supports=t.supports,
            grip_length=t.grip_length,
            gravity=t.gravity,
            tip_force=t.tip_force,
            tip_mass=self.tip_mass,
            layer=f.layer,
            rings=f.rings,
            solver=Solver(tolerance=f.tolerance),
        )
        released = Solver(
            method="implicit",
            duration=self.window + max(self._first - self.bounds[0], 0.0),
            time_step=f.time_step,
            mass_damping=damping.mass,
            stiffness_damping=damping.stiffness,
            tolerance=f.motion_tolerance,
        )
        return [replace(at_rest, solver=released) if s == "motion" else at_rest for s in self.stages]

    def _match(self, results: Sequence[Result]) -> Match | None:
        if not all(r.ok for r in results):
            self.failures += [f"{self.name}: {r.status}: {r.message}" for r in results if not r.ok]
            return None
        places = np.array([m.position for m in self.markers])
        moved = {s: marker_motion(r, places) for s, r in zip(self.stages, results, strict=True)}
        blank = np.zeros((len(places), 3))
        settled = moved["settled"].displacement[:, -1] if "settled" in moved else blank
        means = [m.displacement[~u].mean(axis=0) if not u.all() else m.displacement[0] * np.nan
                 for m, u in zip(self.markers, self._used, strict=True)]  # fmt: skip
        tracks = (
            self._tracks(moved["motion"], results[self.stages.index("motion")]) if "motion" in moved else None
        )

        def at(delay: float) -> tuple[Array, list[Array]]:
            rows, columns, shown = [], [], []
            for i, marker in enumerate(self.markers):
                if tracks is not None:
                    u, turn, after = tracks[i].at(marker.time[self._used[i]] - delay)
                    rows.append(marker.displacement[self._used[i]] - u)
                    columns.append(self._columns(i, u, turn, after))
                    shown.append(u)
                if "settled" in moved:
                    rows.append((means[i] - settled[i])[None])
                    turn = moved["settled"].turn[i, -1:]
                    columns.append(self._columns(i, settled[i][None], turn, np.zeros(1)))
            residual = np.concatenate([r.ravel() for r in rows]) / self.sd
            return profiled(residual, np.concatenate(columns) / self.sd), shown

        if tracks is None:
            release, residuals = float("nan"), at(0.0)[0]
        else:
            interval = float(np.diff(self.markers[0].time).min())
            release, residuals = best_delay(lambda d: at(d)[0], *self.bounds, interval / 2.0)
        values = residuals[self.points :]
        return Match(
            release=release,
            time=tuple(m.time[u] for m, u in zip(self.markers, self._used, strict=True)),
            measured=tuple(m.displacement[u] for m, u in zip(self.markers, self._used, strict=True)),
            predicted=tuple(at(release)[1]) if tracks is not None else (),
            settled_measured=np.array(means),
            settled_predicted=settled,
            nuisances=dict(zip(self.nuisance_names, values.tolist(), strict=True)),
            residuals=residuals,
        )

    def _columns(self, i: int, u: Array, turn: Array, after: Array) -> Array:
        """What one sd of each nuisance adds to marker i's displacement u (t, 3), shape (3 t, k) [m]."""
        s, n, t = self.spread, len(self.markers), len(u)
        found = []
        if s.position:
            own = np.zeros((t, 3, n, 3))
            own[:, :, i] = turn * s.position
            found.append(own.reshape(3 * t, 3 * n))
        if s.frame:
            found.append(np.stack([np.cross(e, u) for e in np.eye(3)], axis=2).reshape(3 * t, 3) * s.frame)
        if s.offset and "motion" in self.stages:
            own = np.zeros((t, 3, n, 3))
            own[:, :, i] = after[:, None, None] * np.eye(3) * s.offset
            found.append(own.reshape(3 * t, 3 * n))
        return np.concatenate(found, axis=1) if found else np.zeros((3 * t, 0))

    def _tracks(self, motion: Motion, result: Result) -> list[Track]:
        return [Track(result.load, d, t) for d, t in zip(motion.displacement, motion.turn, strict=True)]

    def _release_bounds(self) -> tuple[float, float]:
        """Where the release is looked for: just before the first marker that has clearly moved [s]."""
        signs = []
        for marker in self.markers:
            zero = marker.displacement[0]
            moved = np.flatnonzero(np.abs(marker.displacement - zero).max(axis=1) > MOVED * self.sd)
            if len(moved):
                signs.append(float(marker.time[moved[0]]))
        if not signs:
            raise InputError(f"trials.{self.trial.id}.markers: expected a release, but no marker moves")
        interval = float(np.diff(self.markers[0].time).min())
        return min(signs) - EARLY * interval, min(signs) + LATE * interval
