"""Fit of a law and of damping to marker displacements, by least squares with few simulations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from calibration.errors import InputError
from calibration.measurements.release.objective import Damping, MarkerObjective
from calibration.parameters import Parametrisation
from tisim import Material

Array = NDArray[np.float64]

# Finite-difference step, in spreads: a vibration of a dozen periods is linear in its frequency only so far.
STEP = 0.01
NO_ANSWER = 1e6  # residual of a point without a solution
ACCURACY = 1e-4  # relative tolerance on chi-square and on the coordinates


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionFit:
    """Result of a fit of a law and its damping.

    Attributes
    ----------
    material, damping : material and damping at the optimum.
    values : values of the coordinates by name [SI].
    sd : standard deviations of the coordinates by name (of the logarithm for logarithmic ones), multiplied by
        sqrt(chi_square / points) if that is above 1. Residuals are assumed independent from sample to sample,
        which does not hold for the simulator's error.
    covariance : covariance of the coordinates, with the same factor, shape (n, n).
    chi_square : chi-square for the stated marker noise, without the prior.
    points : number of measured components.
    simulations : number of evaluations of the objective.
    converged, message : outcome of the search.
    """

    material: Material
    damping: Damping
    values: dict[str, float]
    sd: dict[str, float]
    covariance: Array
    chi_square: float
    points: int
    simulations: int
    converged: bool
    message: str


def fit_motion(
    objective: MarkerObjective,
    parametrisation: Parametrisation,
    *,
    shear: float,
    damping: Damping | None = None,
    most: int = 12,
) -> MotionFit:
    """Fit a law and, if the motion is used, both Rayleigh coefficients.

    Parameters
    ----------
    objective : the trial's objective.
    parametrisation : the law in search coordinates.
    shear : start of the small-strain shear modulus [Pa], close enough that the simulated vibration does not
        differ by a period from the measured one (a fit of the static equilibrium gives it).
    damping : start of the damping.
    most : largest number of evaluations by the search, without those for derivatives; if it is reached,
        `converged` is False.

    Raises
    ------
    InputError
        If the start, or a point of a finite difference, has no solution.
    """
    coordinates = list(parametrisation.coordinates)
    u = list(parametrisation.start(shear=shear))
    moving = "motion" in objective.stages
    if moving:
        coordinates += objective.coordinates
        given = damping or Damping(mass=1.0, stiffness=1e-3)
        u += [given.mass, given.stiffness]
    n = len(parametrisation.coordinates)
    unit = np.array([c.spread for c in coordinates])
    start = np.array(u) / unit
    bounds = np.array([[c.inside(c.low), c.inside(c.high)] for c in coordinates]) / unit[:, None]
    centre, prior_sd = parametrisation.prior()
    known = np.isfinite(prior_sd)
    runs = 0

    def split(v: Array) -> tuple[Material, Damping]:
        w = v * unit
        rest = Damping(mass=float(w[n]), stiffness=float(w[n + 1])) if moving else objective.damping
        return parametrisation.material(w[:n]), rest

    def batch(V: Array) -> Array:
        nonlocal runs
        runs += len(V)
        pairs = [split(v) for v in V]
        found = objective.residuals([p[0] for p in pairs], [p[1] for p in pairs])
        prior = ((V * unit)[:, :n] - centre) / prior_sd
        return np.concatenate([found, prior[:, known]], axis=1)

    kept: dict[bytes, Array] = {}

    def residuals(v: ArrayLike) -> Array:
        v = np.asarray(v)
        if v.tobytes() not in kept:
            kept[v.tobytes()] = batch(v[None])[0]
        # a step to a point without a solution is rejected as any uphill step
        return np.nan_to_num(kept[v.tobytes()], nan=NO_ANSWER)

    def jacobian(v: ArrayLike) -> Array:
        v = np.asarray(v)
        steps = np.where(v + STEP <= bounds[:, 1], STEP, -STEP)
        moved = batch(v + np.diag(steps))
        if not np.isfinite(moved).all():
            raise InputError(
                f"{objective.name}: a run beside {parametrisation.values((v * unit)[:n])} has no answer"
            )
        return np.asarray(((moved - residuals(v)) / steps[:, None]).T)

    if (residuals(start) == NO_ANSWER).any():
        reason = objective.failures[-1] if objective.failures else "no answer"
        raise InputError(f"{objective.name}: the start at {shear:g} Pa has no answer ({reason})")
    found = least_squares(
        residuals, start, jac=jacobian, bounds=(bounds[:, 0], bounds[:, 1]), x_scale="jac",
        ftol=ACCURACY, xtol=ACCURACY, gtol=1e-12, max_nfev=most,
    )  # fmt: skip
    chi_square = float(np.square(found.fun[: objective.size()]).sum())
    slope: Array = np.asarray(found.jac, dtype=np.float64)
    wide = max(chi_square / objective.points, 1.0)
    covariance = np.asarray(np.linalg.pinv(slope.T @ slope) * np.outer(unit, unit) * wide, dtype=np.float64)
    material, best = split(found.x)
    return MotionFit(
        material=material,
        damping=best,
        values={c.name: c.value(x) for c, x in zip(coordinates, found.x * unit, strict=True)},
        sd={c.name: float(s) for c, s in zip(coordinates, np.sqrt(np.diag(covariance)), strict=True)},
        covariance=covariance,
        chi_square=chi_square,
        points=objective.points,
        simulations=runs,
        converged=bool(found.status > 0),
        message=str(found.message),
    )
