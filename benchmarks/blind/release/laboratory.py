"""Cantilever release tests for the controls.

Sizes and true shares are to first order around the truth (after some periods, a free vibration is nonlinear
in the modulus), with the modulus, the material's damping, onsets, initial deflections, camera angles and
marker positions projected out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.laboratory import SMOOTH, Laboratory, left, log_uniform, waves
from benchmarks.blind.records import apart
from benchmarks.blind.release.cases import Run, Setup, markers, noise_of, run_of, write_runs
from benchmarks.blind.release.model import Truth
from benchmarks.blind.under_test import diagnose_release

Array = NDArray[np.float64]

# largest amplitudes in a lab: rad/Nm, fractions of the unrelaxed modulus (the second: per decade of time),
# 1/s, fractions; outside the library: metres
INSIDE = {
    "clamp-compliance": 0.3,
    "relaxation": 0.3,
    "creep": 0.08,
    "air-drag": 4.0,
    "clock-rate": 0.1,
    "image-scale": 0.1,
}
OUTSIDE = {"hum": 1e-3, "knock": 1e-3, "sagging-marker": 1e-3}
KEYS = {"clamp-compliance": "clamp", "air-drag": "drag", "clock-rate": "clock", "image-scale": "scale"}
NEAR = (0.8, 1.25)  # size of a cause relative to the requested one
STEP = 0.02  # relative change of an amplitude or parameter, for derivatives
STEPS, TRIES = 4, 40
HUNG = (0.0, 0.01)  # [kg]
SD_MM, SECONDS, RATE = 0.02, 1.6, 200.0
DECADES = 10.0 ** (np.arange(-6, 5) / 3.0)  # [s], three per decade


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A cause in all runs.

    `shape` is a parameter besides the amplitude: a relaxation time [s], an angular frequency [rad/s], the
    time of a knock [s], or the time constant of a sagging marker [s].
    """

    name: str
    amplitude: float
    shape: float = 0.0
    sigma: float = 0.0
    where: str = "all"


SHAPES = {"relaxation": (0.2, 2.0), "hum": (80.0, 200.0), "knock": (0.3, 1.2), "sagging-marker": (0.2, 0.8)}


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """Two runs, without and with a hung mass."""

    seed: int
    made: Setup
    shear: float
    viscous: float
    hidden: tuple[Hidden, ...] = ()

    @cached_property
    def truth(self) -> Truth:
        a = {h.name: h for h in self.hidden}
        kinds = {
            "clamp-compliance": "clamp",
            "air-drag": "drag",
            "clock-rate": "clock",
            "image-scale": "scale",
        }
        own: dict[str, Any] = {key: a[name].amplitude for name, key in kinds.items() if name in a}
        branches = []
        if h := a.get("relaxation"):
            branches.append((h.amplitude / (1.0 - h.amplitude), h.shape))
        if h := a.get("creep"):
            branches += [(h.amplitude / 3.0, float(t)) for t in DECADES]
        extras = [h for h in self.hidden if h.name in OUTSIDE]
        if extras:
            own["extra"] = lambda t: np.sum([_extra(h, t) for h in extras], axis=0)
        return Truth(shear=self.shear, viscous=self.viscous, branches=tuple(branches), **own)

    @property
    def seen(self) -> Array:
        """All displacements over their noise."""
        return _stacked(self.made, self.truth)

    def resized(self, name: str, factor: float) -> Case:
        return replace(
            self,
            hidden=tuple(
                replace(h, amplitude=factor * h.amplitude) if h.name == name else h for h in self.hidden
            ),
        )

    @cached_property
    def slopes(self) -> dict[str, Array]:
        """Change of the records by each cause, to first order."""
        seen = self.seen
        return {h.name: (seen - self.resized(h.name, 1.0 - STEP).seen) / STEP for h in self.hidden}

    @cached_property
    def free(self) -> Array:
        """Columns of all parameters that any fit may change."""
        seen, made = self.seen, self.made
        moved = [
            replace(self, shear=(1.0 + 1e-4) * self.shear).seen,
            replace(self, viscous=(1.0 + STEP) * self.viscous).seen,
        ]
        for k in range(len(HUNG)):
            moved += [_stacked(_with_run(made, k, **{key: step}), self.truth)
                      for key, step in (("onset", 1e-4), ("start", 1e-2), ("angle", 1e-3))]  # fmt: skip
        for name, at in made.places.items():
            for axis in (0, 2):
                place = at + 0.1 * np.eye(3)[axis]
                moved.append(_stacked(replace(made, places={**made.places, name: place}), self.truth))
        columns = np.column_stack(moved) - seen[:, None]
        return columns[:, np.abs(columns).max(axis=0) > 0.0]  # no effect of a marker on a rigid clamp


def _extra(hidden: Hidden, time: Array) -> Array:
    """Height [m] added by a cause outside the library."""
    a, shape = hidden.amplitude, hidden.shape
    if hidden.name == "hum":
        return np.asarray(a * np.exp(-time) * np.sin(shape * time))
    if hidden.name == "knock":
        return np.asarray(a * np.exp(-(((time - shape) / 0.08) ** 2)))
    return np.asarray(-a * (1.0 - np.exp(-((time / shape) ** 4))))


def _stacked(made: Setup, truth: Truth) -> Array:
    both = zip(HUNG, made.runs, strict=True)
    return np.concatenate([u.ravel() for m, run in both for u in made.seen(truth, m, run).values()]) / SD_MM


def _with_run(made: Setup, k: int, **by: float) -> Setup:
    ((key, step),) = by.items()
    old = made.runs[k]
    new: Run = replace(old, **{key: getattr(old, key) + step})  # type: ignore[arg-type]
    return replace(made, runs=(*made.runs[:k], new, *made.runs[k + 1 :]))


def clean(seed: int) -> Case:
    rng = np.random.default_rng([seed, 0])
    made = Setup(
        time=np.arange(int(SECONDS * RATE)) / RATE,
        places=markers(rng),
        runs=tuple(run_of(rng, RATE) for _ in HUNG),
    )
    return Case(seed=seed, made=made, shear=rng.uniform(4e5, 8e5), viscous=rng.uniform(3e-4, 6e-4))


def sized(case: Case, name: str, size: float, rng: np.random.Generator) -> Hidden:
    """Cause of the requested size, or at the largest amplitude in a lab."""
    largest = {**INSIDE, **OUTSIDE}[name]
    shape = float(rng.uniform(*SHAPES[name])) if name in SHAPES else 0.0
    found = Hidden(name=name, amplitude=0.1 * largest, shape=shape)
    for _ in range(STEPS):
        alone = replace(case, hidden=(found,))
        sigma = float(np.sqrt(left(alone.free, alone.slopes[name])))
        found = replace(found, amplitude=min(found.amplitude * size / sigma, largest))
    alone = replace(case, hidden=(found,))
    return replace(found, sigma=float(np.sqrt(left(alone.free, alone.slopes[name]))))


def make(seed: int, size: float, names: Callable[[np.random.Generator], Sequence[Any]]) -> Case:
    """A case with these causes, each of about the requested size and detectable beside the others.

    Raises
    ------
    RuntimeError
        If no draw has such sizes.
    """

    def beside(case: Case, own: Hidden, others: tuple[Hidden, ...]) -> float:
        both = replace(case, hidden=(own, *others))
        columns = [both.free, *(both.slopes[h.name] for h in others)]
        return float(np.sqrt(left(np.column_stack(columns), both.slopes[own.name])))

    for number in range(TRIES):
        rng = np.random.default_rng([seed, 1, number])
        case = clean(seed)
        hidden = tuple(sized(case, str(n), size, rng) for n in names(rng))
        if all(NEAR[0] * size < h.sigma < NEAR[1] * size for h in hidden) and apart(beside, case, hidden):
            return replace(case, hidden=hidden)
    raise RuntimeError(f"seed {seed}: no causes of {size} sigmas")


def write(case: Case, folder: Path) -> None:
    rng = np.random.default_rng([case.seed, 2])
    noise = [noise_of(rng, case.made.time) for _ in HUNG]
    write_runs(folder, case.truth, case.made, noise, hung=HUNG, sd_mm=SD_MM)


def smooth_error(folder: Path, seed: int) -> None:
    """Add a smooth error of its own to the height of each marker.

    The stated error stays, since the format requires one.
    """
    rng = np.random.default_rng([seed, 7])
    size = log_uniform(rng, SMOOTH)
    for path in sorted(folder.glob("run-*.csv")):
        head, *rows = (line.split(",") for line in path.read_text(encoding="utf-8").splitlines())
        heights = np.array([float(row[-1]) for row in rows])
        names = np.array([row[0] for row in rows])
        full = float(np.abs(heights).max())
        for name in dict.fromkeys(names.tolist()):
            own = names == name
            heights[own] += size * full * waves(rng, np.linspace(0.0, 1.0, int(own.sum())))
        lines = [head, *([*row[:-1], f"{z:.9g}"] for row, z in zip(rows, heights, strict=True))]
        path.write_text("\n".join(",".join(line) for line in lines) + "\n", encoding="utf-8")


def whitened(case: Case, hidden: Sequence[Hidden]) -> Array:
    return np.sum([np.zeros(len(case.free)), *(case.slopes[h.name] for h in hidden)], axis=0)


LABORATORY = Laboratory(
    clean=clean,
    one=lambda seed, size: make(seed, size, lambda rng: [rng.choice(list(INSIDE))]),
    half=lambda seed, size: make(
        seed, size, lambda rng: [rng.choice(list(INSIDE)), rng.choice(list(OUTSIDE))]
    ),
    two=lambda seed, size: make(seed, size, lambda rng: rng.choice(list(INSIDE), 2, replace=False)),
    write=write,
    hidden=lambda case: case.hidden,
    whitened=whitened,
    free=lambda case: case.free,
    diagnose=diagnose_release,
    smooth_error=smooth_error,
    same={"creep": frozenset({"relaxation"}), "relaxation": frozenset({"creep"})},
)
