"""Fit of a law, for given platens, to the measured curve of a compressed cylinder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.errors import InputError
from calibration.experiment.model import CouponTrial
from calibration.measurements.compression.curves import PressCurves

Array = NDArray[np.float64]

POINTS = 45
# Strain below which platen and cylinder are not in full contact: the secant modulus of the Ecoflex cylinders
# doubles between 0.5 and 2 % strain, which no law describes.
FIRST_STRAIN = 0.05
# Range of the strain before the platen touches the whole face, fitted as a shift of the strain.
SLACK = (0.0, 0.015)


@dataclass(frozen=True, kw_only=True)
class PressFit:
    """Result of a fit.

    Attributes
    ----------
    trial, law, platens : what was fitted.
    values : fitted values by name (SI), the shear modulus first.
    slack : strain before the platen touches [-].
    error : rms relative error of the stress [-].
    chi_square : (error / relative sd of the repeats)^2.
    at_bound : names of the values at an end of their range.
    strains : fitted range of strain.
    points : number of points.
    """

    trial: str
    law: str
    platens: str
    values: dict[str, float]
    slack: float
    error: float
    chi_square: float
    at_bound: tuple[str, ...]
    strains: tuple[float, float]
    points: int


@dataclass(frozen=True, kw_only=True)
class Repeats:
    """Scatter of repeated tests.

    Attributes
    ----------
    relative_sd : relative standard deviation of one curve about the mean of the repeats [-], rms over strain.
    tests : number of tests.
    strains : range of strain.
    """

    relative_sd: float
    tests: int
    strains: tuple[float, float]


def sampled(trial: CouponTrial, strains: tuple[float, float]) -> tuple[Array, Array]:
    """Stretch and stress [Pa] at POINTS equidistant strains of the first loading.

    InputError if the trial does not cover them.
    """
    if trial.mode != "uniaxial":
        raise InputError(f"{trial.id}: expected a uniaxial test, got {trial.mode}")
    strain, stress = 1.0 - np.asarray(trial.stretch), np.asarray(trial.stress)
    loading = slice(0, int(np.argmax(strain)) + 1)
    strain, stress = strain[loading], stress[loading]
    order = np.argsort(strain, kind="stable")
    strain, stress = strain[order], stress[order]
    if strain[-1] < strains[1] - 1e-9 or strain[0] > strains[0] + 1e-9:
        span = f"{strains[0]:g} to {strains[1]:g}"
        raise InputError(f"{trial.id}: expected compressive strains from {span}, got up to {strain[-1]:.3g}")
    at = np.linspace(*strains, POINTS)
    found = np.interp(at, strain, stress)
    if (found >= 0.0).any():
        raise InputError(f"{trial.id}: expected negative (compressive) stresses beyond strain {strains[0]:g}")
    return 1.0 - at, found


def repeats(trials: Sequence[CouponTrial], strains: tuple[float, float]) -> Repeats:
    """Scatter of repeated tests, the uncertainty of one test's curve; InputError for fewer than two tests."""
    if len(trials) < 2:
        raise InputError("repeats: expected at least two tests of one sample")
    stresses = np.array([sampled(trial, strains)[1] for trial in trials])
    relative = stresses / stresses.mean(axis=0)
    sd = float(np.sqrt((relative.std(axis=0, ddof=1) ** 2).mean()))
    return Repeats(relative_sd=sd, tests=len(trials), strains=strains)


def fit_press(
    trial: CouponTrial,
    curves: PressCurves,
    *,
    last_strain: float,
    noise: Repeats,
    first_strain: float = FIRST_STRAIN,
) -> PressFit:
    """Fit curves and slack by least squares of ln(simulated / measured stress) over a range of strain.

    Parameters
    ----------
    trial : the test.
    curves : curves of a law.
    last_strain, first_strain : range of strain.
    noise : scatter of repeats, for `PressFit.chi_square`.

    Raises
    ------
    ValueError
        If the curves end before the last strain.
    """
    stretch, stress = sampled(trial, (first_strain, last_strain))
    guess = float(-stress[0] / (4.0 * (1.0 - stretch[0])))
    names = ("shear_modulus", *curves.names)
    bounds = [(np.log(guess / 20.0), np.log(guess * 20.0))]
    bounds += [(np.log(a), np.log(b)) if a > 0 else (a, b) for a, b in curves.bounds]
    logs = [True, *(a > 0 for a, _ in curves.bounds)]
    low, high = (np.array(v) for v in zip(*bounds, SLACK, strict=True))

    def values(u: Array) -> dict[str, float]:
        return {n: float(np.exp(x)) if g else float(x) for n, x, g in zip(names, u[:-1], logs, strict=True)}

    def errors(u: Array) -> Array:
        return np.log(curves.stress(stretch + u[-1], values(u)) / stress)

    starts = [0.5 * (low + high), 0.85 * low + 0.15 * high, 0.15 * low + 0.85 * high]
    for start in starts:
        start[0], start[-1] = np.log(guess), 0.004
    found = min(
        (least_squares(errors, s, bounds=(low, high), x_scale=high - low) for s in starts),
        key=lambda f: float(f.cost),
    )
    near = 1e-3 * (high - low)
    ends = (found.x < low + near) | (found.x > high - near)
    relative = np.expm1(found.fun)
    rms = float(np.sqrt((relative**2).mean()))
    return PressFit(
        trial=trial.id,
        law=curves.law,
        platens=curves.platens,
        values=values(found.x),
        slack=float(found.x[-1]),
        error=rms,
        chi_square=(rms / noise.relative_sd) ** 2,
        at_bound=tuple(n for n, end in zip((*names, "slack"), ends, strict=True) if end),
        strains=(first_strain, last_strain),
        points=len(stretch),
    )
