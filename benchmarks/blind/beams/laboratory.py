"""Beams for the controls.

True shares are to first order around the true beams: for each photograph, the normal distance between its
edges and those of a slightly smaller cause, after fitting moduli and, with their priors, radii, free lengths
and registrations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.cases import Case, resized, solve_case
from benchmarks.blind.beams.detectability import Columns, columns_at
from benchmarks.blind.beams.effects import EFFECTS, OUTSIDE
from benchmarks.blind.beams.experiment import rewrite_tables, write_experiment
from benchmarks.blind.beams.ideal_beams import Table, table
from benchmarks.blind.beams.make import make_case
from benchmarks.blind.beams.model import Resolution
from benchmarks.blind.beams.solver import NoEquilibriumError
from benchmarks.blind.beams.store import CASES
from benchmarks.blind.laboratory import Laboratory, log_uniform, waves
from benchmarks.blind.under_test import Diagnoser

Array = NDArray[np.float64]

NEAR = (0.8, 1.25)  # size of a cause relative to the requested one
# causes outside the library that have a size; the others are present or not
SIZED = tuple(name for name, e in OUTSIDE.items() if e.largest != e.threshold)
ERROR = (0.05e-3, 0.15e-3)  # rms of an unstated error of edges [m]
STEP = 0.05  # relative change of an amplitude, for derivatives
TRIES = 40


@dataclass(frozen=True, kw_only=True)
class Put:
    """A hidden cause in the form that the controls use."""

    name: str
    amplitude: float
    where: str
    sigma: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Made:
    """A case with its true edges (trials, photographs, 2, points, 2) [m] and sizes [sigma]."""

    case: Case
    edges: Array
    sizes: dict[str, float]

    @property
    def hidden(self) -> tuple[Put, ...]:
        return tuple(
            Put(name=h.effect, amplitude=h.amplitude, where=h.scope, sigma=self.sizes[h.effect])
            for h in self.case.hidden
        )

    @cached_property
    def columns(self) -> Columns:
        return columns_at(self.case, self.edges, ideal(), [self._smaller(k) for k in range(len(self.hidden))])

    def _smaller(self, k: int) -> tuple[Case, Array]:
        """Case with the amplitude of its cause k reduced by the fraction STEP."""
        amplitudes = [h.amplitude for h in self.case.hidden]
        amplitudes[k] *= 1.0 - STEP
        case = resized(self.case, tuple(amplitudes))
        return case, solve_case(case, ideal(), Resolution())


@lru_cache(maxsize=1)
def ideal() -> Table:
    """Table of beams without faults; stored beside the cases, computed in half a minute."""
    return table(CASES.with_name("ideal.npz"), Resolution())


def make(seed: int, size: float, draw: Callable[[np.random.Generator], Sequence[Any]]) -> Made:
    """A case with these causes, each within NEAR of the requested size when fitted beside the others.

    Raises
    ------
    RuntimeError
        If no draw has such sizes.
    """
    for number in range(TRIES):
        names = tuple(str(n) for n in draw(np.random.default_rng([seed, 1, number])))
        category = "single" if names else "clean"
        try:
            case, edges, sizes = make_case(number, seed, category, names, (size, size), ideal(), Resolution())
        except (NoEquilibriumError, ValueError, np.linalg.LinAlgError):
            continue  # this draw has a beam that bends more than the solver can handle
        if all(NEAR[0] * size < sizes[n] < NEAR[1] * size for n in names):
            return Made(case=case, edges=edges, sizes=sizes)
    raise RuntimeError(f"seed {seed}: no causes of {size} sigmas")


def whitened(made: Made, hidden: Sequence[Put]) -> Array:
    names = [h.name for h in hidden]
    own = [made.columns.causes[:, k] / STEP for k, h in enumerate(made.hidden) if h.name in names]
    return np.sum([np.zeros(len(made.columns.causes)), *own], axis=0)


def smooth_error(folder: Path, seed: int) -> None:
    """Move each edge along its normal by a smooth random error of its own.

    The stated errors stay, since the format requires them for every outline.
    """
    rng = np.random.default_rng([seed, 7])
    size = log_uniform(rng, ERROR)

    def moved(edge: Array) -> Array:
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(edge, axis=0).T))])
        tangent = np.gradient(edge, along, axis=0)
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) / np.hypot(*tangent.T)[:, None]
        return np.asarray(edge + size * waves(rng, along / along[-1])[:, None] * normal)

    rewrite_tables(folder, moved)


def clean(rng: np.random.Generator) -> Sequence[str]:
    del rng
    return []


def one(rng: np.random.Generator) -> Sequence[str]:
    return [str(rng.choice(list(EFFECTS)))]


def half(rng: np.random.Generator) -> Sequence[str]:
    return [*one(rng), str(rng.choice(SIZED))]


def two(rng: np.random.Generator) -> Sequence[str]:
    return [str(n) for n in rng.choice(list(EFFECTS), 2, replace=False)]


LABORATORY = Laboratory(
    clean=lambda seed: make(seed, 0.0, clean),
    one=lambda seed, size: make(seed, size, one),
    half=lambda seed, size: make(seed, size, half),
    two=lambda seed, size: make(seed, size, two),
    write=lambda made, folder: write_experiment(made.case, made.edges, folder),
    hidden=lambda made: made.hidden,
    whitened=whitened,
    free=lambda made: made.columns.free,
    diagnose=lambda folder, without=(): Diagnoser(in_process=True, workers=1)(folder, without=without),
    smooth_error=smooth_error,
)
