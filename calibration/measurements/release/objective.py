"""The fit's objective of a cantilever release: whitened residuals of one trial, in motion and at equilibrium.

The beam is simulated by FEM, from its straight rest shape. `ReleaseModel` (`model.py`) compares all trials
with a reduced beam instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, MaterialBelief
from calibration.measurements.release._record import (
    chosen_markers,
    hung_mass,
    stated_density,
    stated_noise,
)
from calibration.measurements.release.kinematics import Motion, marker_motion
from calibration.parameters import Coordinate
from tisim import Beam, Material, Result, Solver, simulate

Array = NDArray[np.float64]
Stage = Literal["motion", "settled"]

MOVED = 10.0  # standard deviations by which a marker that is released has moved
EARLY, LATE = 5, 2  # samples before and after that between which the release is searched


@dataclass(frozen=True, kw_only=True)
class Damping:
    """Rayleigh damping, as in `tisim.Solver`.

    Attributes
    ----------
    mass : proportional to mass [1/s].
    stiffness : proportional to stiffness [s].
    """

    mass: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """How the beam is simulated; `studies/release` states what the defaults leave on a measured beam.

    Attributes
    ----------
    layer : axial element size [m].
    rings : radial elements.
    time_step : [s].
    tolerance : of the static equilibrium.
    motion_tolerance : of each time step (1e-4 moves the measured beam's end by 7e-9 m against 1e-6).
    """

    layer: float = 0.020
    rings: int = 1
    time_step: float = 2e-3
    tolerance: float = 1e-6
    motion_tolerance: float = 1e-4


@dataclass(frozen=True, kw_only=True)
class Nuisances:
    """Standard deviations of what is not known of a trial; 0 leaves one out.

    Attributes
    ----------
    position : of each coordinate of a marker [m].
    frame : of the rotation about each axis between the frame of the displacements and the beam's [rad];
        gravity keeps its stated direction.
    offset : of a constant displacement of each marker from the release on [m], in the motion only: with a
        large one only the vibration is compared.
    """

    position: float = 1e-3
    frame: float = float(np.radians(2.0))
    offset: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Match:
    """One candidate beside the data; of each marker in the objective's order.

    Attributes
    ----------
    release : time of the release on the data's clock [s].
    time : of the motion, shape (t,) [s].
    measured, predicted : displacement in the motion, shape (t, 3) [m]; `predicted` is without nuisances.
    settled_measured, settled_predicted : displacement at static equilibrium, shape (m, 3) [m].
    nuisances : most likely values, in their standard deviations, by name.
    residuals : whitened, shape (size,).
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
    """Markers of one trial against a beam that is released from its straight rest shape.

    Meets `calibration.inference.problem.Objective`. The mean at equilibrium has the marker's own standard
    deviation, not less: what a simulation leaves there is no noise that averages out.

    Parameters
    ----------
    trial : with markers.
    belief : what the lab states of its material.
    markers : names to use; None for all.
    stages : "motion", "settled" (static equilibrium), or both.
    window : duration of the motion from the first sample on [s]; the samples after it are averaged and
        compared with the static equilibrium.
    tip_mass : mass that moves with the free face [kg]; None takes the tip force for a hung mass.
    damping : that `residuals(materials)` takes; a search for it has `coordinates` (see `fit_motion`).
    nuisances : standard deviations of what is not known of the trial.
    fidelity : of the simulation.
    workers : processes; None for all cores.

    Raises
    ------
    InputError : the trial lacks something, which the message names.
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
        self.density = stated_density(trial, belief)
        self.sd = stated_noise(trial)
        self.markers = chosen_markers(trial, markers)
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
        """Whitened residuals (batch, size), nuisances and release at their best, the nuisances' own values
        last; NaN where a run has no answer (see `failures`). damping : one a material; None takes the
        objective's."""
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
            axial_element_size=f.layer,
            radial_elements=f.rings,
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
        """One standard deviation of each nuisance in marker i's displacement u (t, 3), shape (3 t, k) [m]."""
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
        """Between which times the release is searched [s]: just before a marker has clearly moved."""
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


@dataclass(eq=False)
class Track:
    """A marker between the f frames of a simulation, by cubic splines from the release on.

    Attributes
    ----------
    time : since the release, shape (f,) [s].
    displacement : shape (f, 3) [m].
    turn : R - 1 of what carries the marker, shape (f, 3, 3).
    """

    time: Array
    displacement: Array
    turn: Array
    _spline: CubicSpline = field(init=False)

    def __post_init__(self) -> None:
        values = np.concatenate([self.displacement, self.turn.reshape(-1, 9)], axis=1)
        values = np.concatenate([np.zeros((1, 12)), values])
        start: tuple[Literal[1], Array] = (1, np.zeros(12))  # released at rest: no velocity
        self._spline = CubicSpline(np.concatenate([[0.0], self.time]), values, bc_type=(start, "not-a-knot"))

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Displacement (t, 3), turn (t, 3, 3) and 1 after the release, 0 before (t,), at times since it."""
        after = (time > 0.0).astype(float)
        values = self._spline(np.clip(time, 0.0, self.time[-1])) * after[:, None]
        return values[:, :3], values[:, 3:].reshape(-1, 3, 3), after


def profiled(residual: Array, columns: Array) -> Array:
    """min over q of |residual - columns q|^2 + |q|^2: the residuals left (n,), then q (k,).

    The sum of squares is chi-square under the covariance 1 + columns columns^T.

    Parameters
    ----------
    residual : whitened, shape (n,).
    columns : one standard deviation of each nuisance in the simulation, whitened, shape (n, k).
    """
    system = columns.T @ columns + np.eye(columns.shape[1])
    q = np.linalg.solve(system, columns.T @ residual)
    return np.concatenate([residual - columns @ q, q])


def best_delay(
    residuals: Callable[[float], Array], low: float, high: float, step: float
) -> tuple[float, Array]:
    """The delay in [low, high] with the least sum of squares, to a nanosecond, and the residuals there.

    A scan in `step` [s] first: a vibration shifted by a period is a local minimum too.
    """

    def cost(delay: float) -> float:
        return float(np.square(residuals(delay)).sum())

    grid = np.linspace(low, high, max(int(np.ceil((high - low) / step)), 2) + 1)
    k = int(np.argmin([cost(float(d)) for d in grid]))
    left, right = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    found = minimize_scalar(cost, bounds=(left, right), method="bounded", options={"xatol": 1e-9})
    return float(found.x), residuals(float(found.x))
