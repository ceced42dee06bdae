"""Objective for fits of a cantilever release by FEM: whitened residuals of one trial.

The beam is released from its straight rest shape; its motion and its static equilibrium are compared.
`ReleaseModel` (`model.py`) compares all trials with a reduced beam instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, MaterialBelief, beam_as_stated
from calibration.measurements.release._record import (
    chosen_markers,
    hung_mass,
    stated_density,
    stated_noise,
)
from calibration.measurements.release.kinematics import Motion, Track, marker_motion
from calibration.parameters import Coordinate
from tisim import Beam, Material, Result, Solver, simulate

Array = NDArray[np.float64]
Stage = Literal["motion", "settled"]

MOVED = 10.0  # displacement, in standard deviations, of a marker that counts as released
EARLY, LATE = 5, 2  # samples before and after that time between which the release is searched


@dataclass(frozen=True, kw_only=True)
class Damping:
    """Rayleigh damping, as in `tisim.Solver`.

    Attributes
    ----------
    mass : coefficient of the mass [1/s].
    stiffness : coefficient of the stiffness [s].
    """

    mass: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """Discretisation of the beam; `studies/release` states the error of the defaults on a measured beam.

    Attributes
    ----------
    axial_element_size : length of the elements along the beam [m].
    radial_elements : number of elements from the axis to the surface.
    time_step : [s].
    tolerance : tolerance of the static equilibrium.
    motion_tolerance : tolerance of each time step (between 1e-4 and 1e-6 the measured beam's end differs by
        7e-9 m).
    """

    axial_element_size: float = 0.020
    radial_elements: int = 1
    time_step: float = 2e-3
    tolerance: float = 1e-6
    motion_tolerance: float = 1e-4


@dataclass(frozen=True, kw_only=True)
class Nuisances:
    """Standard deviations of the nuisances of a trial; 0 leaves a nuisance out.

    Attributes
    ----------
    position : each coordinate of a marker [m].
    frame : rotation about each axis of the displacements' frame relative to the beam's [rad]; gravity keeps
        its stated direction.
    offset : constant displacement of each marker after the release [m], in the motion only; with a large
        value only the vibration is compared.
    """

    position: float = 1e-3
    frame: float = float(np.radians(2.0))
    offset: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Match:
    """Comparison of a simulated material with the data; markers are in the objective's order.

    Attributes
    ----------
    release : time of the release on the data's clock [s]; NaN without motion.
    time : times of the motion for each marker [s], shape (t,).
    measured, predicted : displacement of each marker in the motion [m], shape (t, 3); `predicted` is without
        nuisances, and empty without motion.
    settled_measured, settled_predicted : displacement at static equilibrium [m], shape (m, 3).
    nuisances : most likely values by name, in their standard deviations.
    residuals : whitened residuals, shape (size,).
    """

    release: float
    time: tuple[Array, ...]
    measured: tuple[Array, ...]
    predicted: tuple[Array, ...]
    settled_measured: Array
    settled_predicted: Array
    nuisances: dict[str, float]
    residuals: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class AtRest:
    """Simulated markers at static equilibrium, in the objective's order.

    Attributes
    ----------
    displacement : [m], shape (m, 3).
    columns : its change by one standard deviation of each nuisance [m], shape (3 m, k).
    """

    displacement: Array
    columns: Array


class MarkerObjective:
    """Whitened residuals of the markers of one trial, for a beam released from its straight rest shape.

    It implements `calibration.inference.problem.Objective`. The mean at equilibrium has the standard
    deviation of one sample, since the simulation's error is not reduced by averaging.

    Parameters
    ----------
    trial : trial with markers.
    belief : the lab's entry for its material.
    markers : names of the markers to use; None for all.
    stages : "motion", "settled" (static equilibrium), or both.
    window : duration of the motion from the first sample on [s]; later samples are averaged and compared with
        the static equilibrium.
    tip_mass : mass that moves with the free face [kg]; None for the mass whose weight is the tip force.
    damping : damping of `residuals(materials)`; `coordinates` are those of a fit to it.
    nuisances : standard deviations of the nuisances.
    fidelity : discretisation of the simulation.
    workers : number of processes; None for all cores.

    Raises
    ------
    InputError
        If the trial is incomplete; the message names what it lacks.
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
        # what has come to rest may have been measured there alone
        self.bounds = self._release_bounds() if "motion" in stages else (self._first, self._first)

    @property
    def points(self) -> int:
        """Number of measured components, for a reduced chi-square."""
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
        """Whitened residuals at the best nuisances and release, nuisances last, shape (batch, size).

        NaN if a simulation has no solution (see `failures`). damping : one per material; None for the
        objective's damping.
        """
        found = np.full((len(materials), self.size()), np.nan)
        for k, match in enumerate(self.matches(materials, damping)):
            if match is not None:
                found[k] = match.residuals
        return found

    def matches(
        self, materials: Sequence[Material], damping: Sequence[Damping] | None = None
    ) -> list[Match | None]:
        """Comparison of each material with the data; None if a simulation has no solution."""
        dampings = [self.damping] * len(materials) if damping is None else list(damping)
        results = simulate(
            [s for m, d in zip(materials, dampings, strict=True) for s in self.scenes(m, d)],
            workers=self.workers,
        )
        n = len(self.stages)
        return [self._match(results[k * n : (k + 1) * n]) for k in range(len(materials))]

    @property
    def settled(self) -> Array:
        """Mean displacement of each marker after the window [m], shape (m, 3); NaN without later samples."""
        return np.array(
            [
                m.displacement[~used].mean(axis=0) if not used.all() else np.full(3, np.nan)
                for m, used in zip(self.markers, self._used, strict=True)
            ]
        )

    def at_rest(self, materials: Sequence[Material]) -> list[AtRest | None]:
        """Markers at static equilibrium for each material; None without a solution (see `failures`)."""
        results = simulate([self._at_rest(m) for m in materials], workers=self.workers)
        return [self._resting(r) for r in results]

    def _resting(self, result: Result) -> AtRest | None:
        if not result.ok:
            self.failures.append(f"{self.name}: {result.status}: {result.message}")
            return None
        moved = marker_motion(result, np.array([m.position for m in self.markers]))
        u, turn = moved.displacement[:, -1], moved.turn[:, -1:]
        columns = [self._columns(i, u[i : i + 1], turn[i], np.zeros(1)) for i in range(len(self.markers))]
        return AtRest(displacement=u, columns=np.concatenate(columns))

    def scenes(self, material: Material, damping: Damping) -> list[Beam]:
        """FEM scene of each stage."""
        f, at_rest = self.fidelity, self._at_rest(material)
        released = Solver(
            method="implicit",
            duration=self.window + max(self._first - self.bounds[0], 0.0),
            time_step=f.time_step,
            mass_damping=damping.mass,
            stiffness_damping=damping.stiffness,
            tolerance=f.motion_tolerance,
        )
        return [replace(at_rest, solver=released) if s == "motion" else at_rest for s in self.stages]

    def _at_rest(self, material: Material) -> Beam:
        return beam_as_stated(
            self.trial,
            replace(material, density=self.density),
            tip_mass=self.tip_mass,
            axial_element_size=self.fidelity.axial_element_size,
            radial_elements=self.fidelity.radial_elements,
            solver=Solver(tolerance=self.fidelity.tolerance),
        )

    def _match(self, results: Sequence[Result]) -> Match | None:
        if not all(r.ok for r in results):
            self.failures += [f"{self.name}: {r.status}: {r.message}" for r in results if not r.ok]
            return None
        places = np.array([m.position for m in self.markers])
        moved = {s: marker_motion(r, places) for s, r in zip(self.stages, results, strict=True)}
        blank = np.zeros((len(places), 3))
        settled = moved["settled"].displacement[:, -1] if "settled" in moved else blank
        means = self.settled
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
            settled_measured=means,
            settled_predicted=settled,
            nuisances=dict(zip(self.nuisance_names, values.tolist(), strict=True)),
            residuals=residuals,
        )

    def _columns(self, i: int, u: Array, turn: Array, after: Array) -> Array:
        """Change of marker i's displacement u (t, 3) by one sd of each nuisance [m], shape (3 t, k)."""
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
        """Range of times in which the release is searched [s], about the first clear motion of a marker."""
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


def profiled(residual: Array, columns: Array) -> Array:
    """Minimise |residual - columns q|^2 + |q|^2 over q; return residual - columns q (n,), followed by q (k,).

    The sum of squares is the chi-square for the covariance 1 + columns columns^T.

    Parameters
    ----------
    residual : whitened residuals, shape (n,).
    columns : whitened change of the simulation by one sd of each nuisance, shape (n, k).
    """
    system = columns.T @ columns + np.eye(columns.shape[1])
    q = np.linalg.solve(system, columns.T @ residual)
    return np.concatenate([residual - columns @ q, q])


def best_delay(
    residuals: Callable[[float], Array], low: float, high: float, step: float
) -> tuple[float, Array]:
    """Delay in [low, high] with the least sum of squares, to a nanosecond, and the residuals there.

    It begins with a scan in steps of `step` [s], since a vibration shifted by a period is a local minimum.
    """

    def cost(delay: float) -> float:
        return float(np.square(residuals(delay)).sum())

    grid = np.linspace(low, high, max(int(np.ceil((high - low) / step)), 2) + 1)
    k = int(np.argmin([cost(float(d)) for d in grid]))
    left, right = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    found = minimize_scalar(cost, bounds=(left, right), method="bounded", options={"xatol": 1e-9})
    return float(found.x), residuals(float(found.x))
