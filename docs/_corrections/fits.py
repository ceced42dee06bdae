"""Fits of the shear modulus: the likelihood's as by default, and the least squares of any simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

import tisim
from _corrections.bench import objective
from calibration.outlines import REFERENCE, OutlineObjective
from calibration.parameters import parametrisation
from calibration.search import Problem, guess, polish

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fitted:
    """shear [Pa] (NaN: none found); misfit there, as the fit says; steps of Gauss-Newton."""

    shear: float
    misfit: float
    steps: int


@cache
def default_fit(mixture: str) -> Fitted:
    """Shear modulus and K/G by Gauss-Newton; leaves the objective linearised there."""
    likelihood = objective(mixture)
    problem = Problem(parametrisation=parametrisation("neo-hookean"), objectives=(likelihood,))
    likelihood.reference = None
    start = guess(problem)
    likelihood.reference = REFERENCE
    if start is None:
        raise SystemExit(f"{mixture}: no start found")
    end = polish(problem, start)
    if not end.converged:
        raise SystemExit(f"{mixture}: the default fit did not converge: {end.message}")
    shear = problem.parametrisation.moduli(end.u).shear
    return Fitted(shear, end.cost / (problem.points - len(end.u)), end.steps)


def material(shear: float, ratio: float) -> tisim.Material:
    return tisim.material_from_moduli("neo-hookean", shear=shear, bulk=ratio * shear)


def distances(likelihood: OutlineObjective, materials: Sequence[tisim.Material]) -> Array:
    """Distances of all points as measured, nothing taken out, (batch, points) [m]; NaN without an answer."""
    found = np.full((len(materials), likelihood.points), np.nan)
    for k, results in enumerate(likelihood.simulate(materials)):
        if all(r.ok for r in results):
            found[k] = distances_of(likelihood, results)
    return found


def distances_of(likelihood: OutlineObjective, results: Sequence[tisim.Result]) -> Array:
    seen = [f.distance for p in likelihood.photographs for f in likelihood.distances(results, p)]
    return np.asarray(np.concatenate(seen))


def least_squares(likelihood: OutlineObjective, ratio: float, start: float) -> Fitted:
    """Modulus of least squared distance; `misfit` in m."""
    found = _gauss_newton(lambda m: distances(likelihood, m), ratio, start)
    return replace(found, misfit=float(np.sqrt(found.misfit / likelihood.points)))


def _gauss_newton(
    residuals: Callable[[Sequence[tisim.Material]], Array], ratio: float, start: float
) -> Fitted:
    """Gauss-Newton on the logarithm of the shear modulus alone, K/G held; ends below 0.1 % a step."""
    log, ahead = float(np.log(start)), 0.01
    for step in range(1, 13):
        here, there = residuals([material(np.exp(log + d), ratio) for d in (0.0, ahead)])
        if not np.isfinite([here, there]).all():
            return Fitted(float("nan"), float("nan"), step)
        slope = (there - here) / ahead
        move = float(np.clip(-(slope @ here) / (slope @ slope), -0.5, 0.5))
        log += move
        if abs(move) < 1e-3:
            return Fitted(float(np.exp(log)), float(here @ here), step)
    return Fitted(float("nan"), float("nan"), 12)
