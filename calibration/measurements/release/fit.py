"""The fit of a law and the damping to markers, by damped least squares with few simulations."""

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

# Of differences, in spreads: a vibration of a dozen periods is linear in its frequency only so far.
STEP = 0.01
NO_ANSWER = 1e6  # residual of a candidate that has none
ACCURACY = 1e-4  # relative change of chi-square, and of the coordinates, that ends the search


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionFit:
    """A fitted law with its damping.

    Attributes
    ----------
    material, damping : at the optimum.
    values : of the coordinates by name [SI].
    sd : their standard deviations by name (of the logarithm where the coordinate has one), widened by
        sqrt(chi_square / points) where that is above 1. They take residuals for independent from sample to
        sample, which a simulator's own error is not.
    covariance : of the coordinates, shape (n, n).
    chi_square : under the stated marker noise, without the prior.
    points : number of measured components.
    simulations : how many were run.
    converged, message : how the search ended.
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
    """Fit a law and, where the motion is used, both Rayleigh coefficients.

    Parameters
    ----------
    shear : small-strain shear modulus to start from [Pa], near enough that the simulated vibration does not
        lose a period to the measured one (a fit of the static equilibrium gives it).
    damping : to start from.
    most : linearisations. A search that stops there says so in `converged` and `message`.

    Raises
    ------
    InputError : the start, or a run beside it, has no answer.
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
        # a step to where there is no answer is refused as any step uphill is
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
