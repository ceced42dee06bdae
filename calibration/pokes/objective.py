"""Force against depth of pokes, as whitened residuals: a candidate scales and tilts curves known before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import PokeTrial
from calibration.outlines import Nuisances
from calibration.pokes import _shape
from calibration.pokes._branch import loading_branch
from calibration.pokes._curve import at_depths, log_change, rod_force
from calibration.pokes._errors import TOGETHER, scatter, wandering_modes
from calibration.pokes._run import PokeRun
from calibration.pokes._scene import poke_scene
from tisim import Material, Poke, Result, simulate

Array = NDArray[np.float64]

# Curves are taken again where the shape has changed some force by more than this, relative: what is left out,
# of second order in it, is then far below the mesh's error.
NEAR = 2e-3
LEAST = 3  # points of a record that must be reached


@dataclass(frozen=True, eq=False)
class _Curves:
    """unit: force over shear modulus [m2] at the measured points (k,), and its log-derivatives by the shape
    (n, k), 0 where not `used` (not reached); the shape they were taken at and the derivatives' steps (n,)."""

    unit: Array
    derivatives: Array
    shape: Array
    steps: Array
    used: NDArray[np.bool_]
    nuisances: Nuisances
    runs: tuple[PokeRun, ...]

    def change(self, shape: Array) -> Array:
        """ln of the force's change with the shape (k,)."""
        return np.asarray((shape - self.shape) @ self.derivatives)


class PokeObjective:
    """First loadings of pokes into one material. Meets `calibration.search.problem.Objective`.

    `linearise` simulates each poke once, and once for each shape coordinate of the law; `residuals` takes
    F = G f(depth) exp(sum_i dlnF/ds_i (s_i - s0_i)): exact in the shear modulus G (quasi-static, without
    gravity), first order in the shape s. Pokes that differ in their record alone share a simulation.
    Curves are kept for each law, and taken again only where the shape has moved (`NEAR`).

    friction: Coulomb coefficient of rod and block, a belief. max_depth [m]: nothing deeper is used.
    refinement: of the poke's mesh; its error is a nuisance and a part of `sd` (`_errors`).
    touch_sd [m]: of the depth at which the lab saw the first touch, one draw a poke; None takes the trial's
    depth_sd. edge_radius [m]: of flat rods; None: 0.4 of the rod's radius.
    sd [N]: of each point's force, (k,). left_out: what of the records is not used, one sentence a trial.
    runs, simulated: what became of the last pokes, and how many there were so far.
    InputError names what a trial lacks.
    """

    def __init__(
        self,
        trials: Sequence[PokeTrial],
        *,
        friction: float = 0.6,
        max_depth: float | None = None,
        refinement: float = 1.0,
        touch_sd: float | None = None,
        edge_radius: float | None = None,
        workers: int | None = None,
    ) -> None:
        if not trials:
            raise ValueError("expected at least one poke")
        self.trials = list(trials)
        self.name = "pokes " + ", ".join(t.id for t in self.trials)
        self.friction = friction
        self.refinement = refinement
        self.touch_sd = touch_sd
        self.edge_radius = edge_radius
        self.workers = workers
        self.branches = [loading_branch(t, max_depth=max_depth) for t in self.trials]
        self.left_out = tuple(f"{b.trial}: {b.left_out}" for b in self.branches if b.left_out)
        ends = np.cumsum([0, *(len(b.depth) for b in self.branches)])
        self._rows = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self._force = np.concatenate([b.force for b in self.branches])
        self.sd = np.concatenate([self._point_sd(i) for i in range(len(self.trials))])
        self._groups = self._alike()
        self._modes = self._nuisance_modes()
        self._known: dict[tuple[str, int], _Curves] = {}
        self._now: _Curves | None = None
        self.runs: tuple[PokeRun, ...] = ()
        self.simulated = 0

    @property
    def points(self) -> int:
        """Measured points in use: fewer than all where a simulated poke stopped before its record."""
        return len(self._force) if self._now is None else int(self._now.used.sum())

    @property
    def shortfalls(self) -> tuple[str, ...]:
        """A sentence for each poke of the last linearisation that did not reach its record's depth."""
        return tuple(str(r) for r in self.runs if r.short)

    @property
    def nuisance_names(self) -> tuple[str, ...]:
        return tuple(name for name, _, _ in self._modes)

    def size(self) -> int:
        return len(self._force) + len(self._modes)

    def linearise(self, material: Material) -> bool:
        """Take the curves at a material, unless those known are near enough; False where a poke reaches fewer
        than 3 points of its record (`runs` says how far each came), the curves then stay as they were."""
        shape = _shape.shape(material)
        known = self._known.get(_key(material))
        if known is not None and _near(known, shape):
            self._now, self.runs = known, known.runs
            return True
        names = _shape.shape_names(material)
        materials = [material, *(_shape.moved(material, n) for n in names)]
        results = self._simulate(materials)
        unit = np.full(len(self._force), np.nan)
        slope = np.full(len(self._force), np.nan)
        derivatives = np.full((len(names), len(self._force)), np.nan)
        steps = np.array([(_shape.shape(m) - shape)[i] for i, m in enumerate(materials[1:])])
        for group, results_of in zip(self._groups, results, strict=True):
            curves = [_unit_curve(r, m) for r, m in zip(results_of, materials, strict=True)]
            for i in group:
                rows, depth = self._rows[i], self.branches[i].depth
                tip = self.trials[i].rod_tip == "hemisphere"
                unit[rows], slope[rows] = at_depths(*curves[0], depth, round_tip=tip)
                for k, curve in enumerate(curves[1:]):
                    derivatives[k, rows] = log_change(curves[0], curve, depth) / steps[k]
        used = np.isfinite(unit) & np.isfinite(slope) & np.isfinite(derivatives).all(axis=0)
        self.runs = tuple(self._runs(results, names))
        if any(int(used[rows].sum()) < LEAST for rows in self._rows):
            return False
        self._now = _Curves(
            unit=np.where(used, unit, 0.0),
            derivatives=np.where(used, derivatives, 0.0),
            shape=shape,
            steps=steps,
            used=used,
            nuisances=self._nuisances(unit, slope, used),
            runs=self.runs,
        )
        self._known[_key(material)] = self._now
        return True

    def forces(self, material: Material) -> Array:
        """Force along the rod [N] at all measured points (k,), NaN where the simulated poke ended before."""
        now = self._curves(material)
        predicted = _shape.shear(material) * now.unit * np.exp(now.change(_shape.shape(material)))
        return np.where(now.used, predicted, np.nan)

    def residuals(self, materials: Sequence[Material]) -> Array:
        """(batch, size): (data - model) / sd with the nuisances at their best, their values last; 0 at points
        that no simulated poke reached. A row of NaN where the law's coordinates cannot give the material."""
        found = np.full((len(materials), self.size()), np.nan)
        for row, material in zip(found, materials, strict=True):
            try:
                whitened = self._whitened(material)
            except ValueError:
                continue
            if np.isfinite(whitened).all():
                row[:] = self._curves(material).nuisances.profile(whitened)
        return found

    def summary(self, material: Material) -> tuple[float, dict[str, float]]:
        """rms of what is left of the force [N] once the nuisances are taken out, and their values [in sd]."""
        now, whitened = self._curves(material), self._whitened(material)
        b = now.nuisances.estimate(whitened)
        left = (whitened - now.nuisances.columns @ b) * self.sd
        return float(np.sqrt(np.mean(left[now.used] ** 2))), dict(
            zip(self.nuisance_names, b.tolist(), strict=True)
        )

    def check(self, material: Material) -> float:
        """Largest relative error of `forces` against pokes simulated at this very material, NaN if none."""
        predicted = self.forces(material)
        fresh = np.full(len(self._force), np.nan)
        for group, (result,) in zip(self._groups, self._simulate([material]), strict=True):
            for i in group:
                tip = self.trials[i].rod_tip == "hemisphere"
                fresh[self._rows[i]] = at_depths(*rod_force(result), self.branches[i].depth, round_tip=tip)[0]
        both = np.isfinite(predicted) & np.isfinite(fresh)
        return float(np.abs(predicted[both] / fresh[both] - 1.0).max()) if both.any() else float("nan")

    def _curves(self, material: Material) -> _Curves:
        now = self._known.get(_key(material))
        if now is None:
            raise RuntimeError(f"linearise a PokeObjective at a {material.law} material before use")
        return now

    def _whitened(self, material: Material) -> Array:
        used = self._curves(material).used
        return np.where(used, (self._force - self.forces(material)) / self.sd, 0.0)

    def _point_sd(self, trial: int) -> Array:
        branch, radius = self.branches[trial], self.trials[trial].rod_radius
        return np.hypot(branch.sd, np.abs(branch.force) * scatter(branch.depth, radius, self.refinement))

    def _alike(self) -> list[list[int]]:
        """Indices of trials that one simulated poke answers."""
        found: dict[object, list[int]] = {}
        for i, t in enumerate(self.trials):
            scene = self._scene(i, _ANY, depth=self.branches[i].depth[-1])
            found.setdefault((scene.block, scene.rod, scene.site, t.direction), []).append(i)
        return list(found.values())

    def _scene(self, trial: int, material: Material, *, depth: float) -> Poke:
        return poke_scene(
            self.trials[trial],
            material,
            depth=float(depth),
            friction=self.friction,
            refinement=self.refinement,
            edge_radius=self.edge_radius,
        )

    def _simulate(self, materials: Sequence[Material]) -> list[list[Result]]:
        """Each group's poke with each material."""
        scenes = []
        for group in self._groups:
            depth = max(self.branches[i].depth[-1] for i in group)
            scenes += [self._scene(group[0], replace(m, density=1000.0), depth=depth) for m in materials]
        try:
            results = simulate(scenes, workers=self.workers)
        except ValueError as error:
            raise InputError(f"{self.name}: {error}") from error
        self.simulated += len(scenes)
        n = len(materials)
        return [results[k * n : (k + 1) * n] for k in range(len(self._groups))]

    def _runs(self, results: list[list[Result]], names: Sequence[str]) -> list[PokeRun]:
        found = []
        for group, results_of in zip(self._groups, results, strict=True):
            depth = np.concatenate([self.branches[i].depth for i in group])
            for change, result in zip(("", *names), results_of, strict=True):
                reached = float(rod_force(result)[0].max(initial=0.0))
                assert isinstance(result.scene, Poke)
                found.append(
                    PokeRun(
                        trials=tuple(self.trials[i].id for i in group),
                        change=change,
                        status=str(result.status),
                        message=result.message,
                        asked=result.scene.depth,
                        reached=reached,
                        dropped=int((depth > reached * (1.0 + 1e-9)).sum()),
                        core_seconds=result.cost.core_seconds + result.cost.mesh_seconds,
                    )
                )
        return found

    def _nuisance_modes(self) -> list[tuple[str, str, Array]]:
        """Name, what it multiplies ("force" or "slope"), and one sd of it at each measured point (k,)."""
        k = len(self._force)
        found = [("mesh of all pokes", "force", np.full(k, TOGETHER / self.refinement**2))]
        for group in self._groups:
            rows = np.concatenate([np.arange(k)[self._rows[i]] for i in group])
            depth = np.concatenate([self.branches[i].depth for i in group])
            radius = self.trials[group[0]].rod_radius
            label = ", ".join(self.trials[i].id for i in group)
            for m, mode in enumerate(wandering_modes(depth, radius, self.refinement).T, 1):
                whole = np.zeros(k)
                whole[rows] = mode
                found.append((f"mesh {m} of {label}", "force", whole))
        for t, part in zip(self.trials, self._rows, strict=True):
            sd = t.depth_sd if self.touch_sd is None else self.touch_sd
            if sd > 0.0:
                whole = np.zeros(k)
                whole[part] = sd
                found.append((f"touch of {t.id}", "slope", whole))
        return found

    def _nuisances(self, unit: Array, slope: Array, used: NDArray[np.bool_]) -> Nuisances:
        """Columns relative to the simulated curve scaled to the records: free of their noise, and the same
        whatever shear modulus is looked at."""
        w = used / self.sd**2
        f = np.where(used, unit, 0.0)
        scale = float((w * f) @ self._force / ((w * f) @ f))
        size = {"force": scale * f / self.sd, "slope": scale * np.where(used, slope, 0.0) / self.sd}
        columns = [amplitude * size[what] for _, what, amplitude in self._modes]
        return Nuisances(self.nuisance_names, np.column_stack(columns))


_ANY = Material(law="neo-hookean", parameters={"mu": 1e4, "lam": 1e6})


def _key(material: Material) -> tuple[str, int]:
    return material.law, _shape.terms(material)


def _near(known: _Curves, shape: Array) -> bool:
    moved = np.abs(shape - known.shape)
    return bool((moved <= np.abs(known.steps)).all() and np.abs(known.change(shape)).max() <= NEAR)


def _unit_curve(result: Result, material: Material) -> tuple[Array, Array]:
    """Depth [m] and force over shear modulus [m2]."""
    depth, force = rod_force(result)
    return depth, force / _shape.shear(material)
