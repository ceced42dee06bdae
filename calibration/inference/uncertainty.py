"""Uncertainty of a fit by linear theory: covariance, unconstrained directions, scatter between specimens."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, stdtrit  # scipy.stats takes 0.3 s to import

from calibration.inference.polish import AT_BOUND, Polished
from calibration.parameters import Parametrisation

Array = NDArray[np.float64]
Seen = Literal["identified", "weak", "not identified", "at a bound", "held"]

# Limits of a parameter's sd: above this fraction of its prior's sd the prior decides, not the data; above
# UNSEEN (a factor of e^0.5 or half the range) it is not a number to print.
PRIOR_SHARE = 0.7
WEAK, UNSEEN = 0.15, 0.5

LEVEL, WIDTH = 0.95, 1.959964  # of the intervals, and half their width in standard deviations
DIFFER = 0.01  # p-value of the differences between specimens below which they scatter beyond the noise

FLAT = 12.0**-0.5  # sd of a flat prior over a range, as a fraction of the range


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """One constant of a law with its uncertainty.

    Attributes
    ----------
    name, unit : str
        Name of the search coordinate, and unit of its value.
    value, low, high : float
        Value and 95 % interval, SI.
    sd : float
        Standard deviation: of the logarithm where `relative`, else of the value; never more than that of a
        flat prior over the bounds.
    relative : bool
    seen : str
        How well the data determine it: "identified", "weak", "not identified" (the prior or the bounds
        decide), "at a bound" or "held" (`Coordinate.held`: value and interval are the hold's, not measured).
    """

    name: str
    unit: str
    value: float
    sd: float
    low: float
    high: float
    relative: bool
    seen: Seen


@dataclass(frozen=True, eq=False, kw_only=True)
class Identification:
    """Uncertainty of all constants of a fit.

    Attributes
    ----------
    estimates : tuple of Estimate
    covariance : array, shape (n, n)
        Covariance of u, with the priors, scaled up where the fit is worse than the noise.
    of_intervals : array, shape (n, n)
        Covariance of which 1.96 standard deviations are the 95 % intervals: larger where these have Student's
        t, else the same.
    scale : float
        Factor of the data's covariance: reduced chi-square, at least 1 (Birge's ratio).
    blind : tuple of dict
        Directions that the data alone do not determine, as {coordinate: weight}.
    shear_modulus_sd : float
        Standard deviation of the small-strain shear modulus [Pa].
    """

    estimates: tuple[Estimate, ...]
    covariance: Array
    of_intervals: Array
    scale: float
    blind: tuple[dict[str, float], ...]
    shear_modulus_sd: float


def identify(
    parametrisation: Parametrisation, u: Array, jacobian: Array, *, reduced_chi2: float
) -> Identification:
    """Covariance and estimates at a minimum, by linear (Gauss-Newton) theory.

    Where reduced chi-square is above 1 the data's information is divided by it (the model is wrong by more
    than the noise; Birge's ratio); it is never made larger, and the prior's is left alone.

    Parameters
    ----------
    parametrisation : Parametrisation
    u : array, shape (n,)
    jacobian : array, shape (m, n)
        Jacobian of the whitened residuals, the prior's rows last.
    reduced_chi2 : float
    """
    _, prior_sd = parametrisation.prior()
    prior = np.diag(np.where(np.isfinite(prior_sd), prior_sd, np.inf) ** -2.0)
    data = jacobian.T @ jacobian - prior
    bounds = parametrisation.bounds
    span = bounds[:, 1] - bounds[:, 0]
    # keeps undetermined directions finite, and hardly changes the others
    floor = np.diag(span**-2.0)
    scale = max(1.0, reduced_chi2)
    covariance = np.asarray(np.linalg.inv(data / scale + prior + floor))
    return Identification(
        estimates=_estimates(parametrisation, u, covariance, prior_sd),
        covariance=covariance,
        of_intervals=covariance,
        scale=scale,
        blind=_blind(parametrisation, data, span),
        shear_modulus_sd=_shear_sd(parametrisation, u, covariance),
    )


def with_prior_sd(
    known: Identification, parametrisation: Parametrisation, u: Array, name: str
) -> Identification:
    """The uncertainty of a fit in which one coordinate was held, with that coordinate's prior sd put back.

    The data say nothing of the held coordinate, its whole prior does, and the others move along with it:
    C + s s' (sd^2 - C_ii), s = C_i / C_ii (a "cut" posterior, which a model that misfits cannot use to repair
    its curve).

    Parameters
    ----------
    known : Identification
        Result of the fit with the coordinate held (`Parametrisation.holding`).
    parametrisation : Parametrisation
        Parametrisation with the coordinate's own prior.
    u : array, shape (n,)
    name : str
        The coordinate.
    """
    i = parametrisation.names.index(name)
    _, prior_sd = parametrisation.prior()

    def put_back(C: Array) -> Array:
        slope = C[:, i] / C[i, i]
        return np.asarray(C + np.outer(slope, slope) * (prior_sd[i] ** 2 - C[i, i]))

    covariance, of_intervals = put_back(known.covariance), put_back(known.of_intervals)
    return replace(
        known,
        estimates=_estimates(parametrisation, u, covariance, prior_sd, of_intervals),
        covariance=covariance,
        of_intervals=of_intervals,
        shear_modulus_sd=_shear_sd(parametrisation, u, covariance),
    )


def between_specimens(
    known: Identification, parametrisation: Parametrisation, end: Polished, specimens: Sequence[str]
) -> Identification:
    """The uncertainty with the scatter between specimens, where they differ by more than the noise.

    With scores g_s = J_s' r_s of the k specimens and H = J' J, the covariance of what specimens of the
    material have on average is H^-1 (sum_s g_s g_s') H^-1 k / (k - 1) (S.-L. Liang and K.-Y. Zeger,
    Biometrika 73, 1986). In each direction the larger of it and the noise's is taken; intervals have
    Student's t with k - 1 degrees of freedom. Nothing changes for one specimen, or if the scores are as the
    noise makes them (W. G. Cochran, Biometrics 10, 1954: sum_s g_s' H_s^-1 g_s, chi-square, p above DIFFER).
    The noise is as stated, or as large as the misfit within the specimens, each with constants of its own,
    where that is larger.

    Parameters
    ----------
    known : Identification
    parametrisation : Parametrisation
    end : Polished
        Result of the polish, with m residuals and their Jacobian.
    specimens : sequence of str, length m
        Specimen of each residual; "" for the prior's, and where there is none.
    """
    names = [n for n in dict.fromkeys(specimens) if n]
    if len(names) < 2:
        return known
    J, r, label = end.jacobian, end.residuals, np.array(specimens)
    scores, heterogeneity, freedom = [], 0.0, 0
    for name in names:
        own = J[label == name]
        scores.append(own.T @ r[label == name])
        information = own.T @ own
        heterogeneity += float(
            scores[-1] @ np.linalg.pinv(information, rcond=1e-9, hermitian=True) @ scores[-1]
        )
        freedom += int(np.linalg.matrix_rank(information, rtol=1e-9, hermitian=True))
    left = int((label != "").sum()) - freedom
    within = (float(r[label != ""] @ r[label != ""]) - heterogeneity) / left if left > 0 else known.scale
    freedom -= int(np.linalg.matrix_rank(J[label != ""], rtol=1e-9))
    if freedom < 1 or chdtrc(freedom, heterogeneity / max(1.0, within)) > DIFFER:
        return known
    span = np.ptp(parametrisation.bounds, axis=1)
    inverse = np.linalg.inv(J.T @ J + np.diag(span**-2.0))
    k = len(names)
    robust = inverse @ (np.array(scores).T @ np.array(scores)) @ inverse * k / (k - 1.0)
    root = np.linalg.cholesky(known.covariance)
    back = np.linalg.inv(root)
    ratios, directions = np.linalg.eigh(back @ robust @ back.T)

    def widened(factor: float) -> Array:
        turned = root @ directions
        return np.asarray(turned @ np.diag(np.maximum(1.0, factor * ratios)) @ turned.T)

    _, prior_sd = parametrisation.prior()
    covariance = widened(1.0)
    of_intervals = widened(float(stdtrit(k - 1, 0.5 * (1.0 + LEVEL)) / WIDTH) ** 2)
    return replace(
        known,
        estimates=_estimates(parametrisation, end.u, covariance, prior_sd, of_intervals),
        covariance=covariance,
        of_intervals=of_intervals,
        shear_modulus_sd=_shear_sd(parametrisation, end.u, covariance),
    )


def _estimates(
    parametrisation: Parametrisation,
    u: Array,
    covariance: Array,
    prior_sd: Array,
    of_intervals: Array | None = None,
) -> tuple[Estimate, ...]:
    wide = np.sqrt(np.diag(covariance if of_intervals is None else of_intervals))
    bounds = parametrisation.bounds
    span = bounds[:, 1] - bounds[:, 0]
    estimates = []
    for i, c in enumerate(parametrisation.coordinates):
        low, high = np.clip([u[i] - WIDTH * wide[i], u[i] + WIDTH * wide[i]], *bounds[i])
        sd = min(float(np.sqrt(covariance[i, i])), FLAT * float(span[i]))
        estimates.append(
            Estimate(
                name=c.name,
                unit=c.unit,
                value=c.value(u[i]),
                sd=sd,
                low=c.value(low),
                high=c.value(high),
                relative=c.log,
                seen="held"
                if c.held
                else _seen(sd, prior_sd[i], u[i], bounds[i], yardstick(parametrisation, i, u[i])),
            )
        )
    return tuple(estimates)


def yardstick(parametrisation: Parametrisation, i: int, u: float) -> float:
    """Scale of a coordinate's sd: 1 for a logarithm, else its value or a fifth of its range, the larger."""
    low, high = parametrisation.bounds[i]
    return 1.0 if parametrisation.coordinates[i].log else max(abs(u), 0.2 * (high - low))


def _seen(sd: float, prior: float, u: float, bounds: Array, unit: float) -> Seen:
    span = bounds[1] - bounds[0]
    if min(u - bounds[0], bounds[1] - u) < AT_BOUND * span:
        return "at a bound"
    if sd > PRIOR_SHARE * min(prior, FLAT * span) or sd > UNSEEN * unit:
        return "not identified"
    return "weak" if sd > WEAK * unit else "identified"


def _blind(parametrisation: Parametrisation, data: Array, span: Array) -> tuple[dict[str, float], ...]:
    """Directions that the data do not determine: eigenvectors of their information, in units of each
    coordinate's range, with an sd above a quarter of that range."""
    values, vectors = np.linalg.eigh(data * np.outer(span, span))
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value < 16.0:
            weights = vector / np.abs(vector).max()
            found.append(
                {n: float(w) for n, w in zip(parametrisation.names, weights, strict=True) if abs(w) > 0.1}
            )
    return tuple(found)


def _shear_sd(parametrisation: Parametrisation, u: Array, covariance: Array) -> float:
    """sd of the small-strain shear modulus [Pa], by linear propagation."""
    steps = 1e-5 * np.eye(len(u))
    slope = np.array(
        [
            (parametrisation.moduli(u + s).shear_modulus - parametrisation.moduli(u - s).shear_modulus) / 2e-5
            for s in steps
        ]
    )
    return float(np.sqrt(slope @ covariance @ slope))
