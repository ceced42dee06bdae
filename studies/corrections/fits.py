"""Fits of the shear modulus: the likelihood's as by default, and the least squares of any simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

import tisim
from calibration.inference import Problem, guess, polish
from studies.corrections.bench import LAW, Beams, objective

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
    problem = Problem(parametrisation=LAW, objectives=(objective(mixture),))
    start = guess(problem)
    if start is None:
        raise SystemExit(f"{mixture}: no start found")
    end = polish(problem, start)
    if not end.converged:
        raise SystemExit(f"{mixture}: the default fit did not converge: {end.message}")
    shear = problem.parametrisation.moduli(end.u).shear_modulus
    return Fitted(shear, end.cost / (problem.points - len(end.u)), end.steps)


def material(shear: float, ratio: float) -> tisim.Material:
    return tisim.material_from_moduli("neo-hookean", shear_modulus=shear, bulk_modulus=ratio * shear)


def distances(beams: Beams, materials: Sequence[tisim.Material]) -> Array:
    """Distances of all points as measured, (batch, points) [m]; NaN without an answer."""
    found = np.full((len(materials), beams.points), np.nan)
    for k, results in enumerate(beams.simulate(materials)):
        if all(r.ok for r in results):
            found[k] = beams.distances(results)
    return found


def least_squares(beams: Beams, ratio: float, start: float) -> Fitted:
    """Modulus of least squared distance; `misfit` in m."""
    found = _gauss_newton(lambda m: distances(beams, m), ratio, start)
    return replace(found, misfit=float(np.sqrt(found.misfit / beams.points)))


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
