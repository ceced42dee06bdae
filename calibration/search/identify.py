"""What the data say of each parameter: covariance from Gauss-Newton, and what they do not see."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.parameters import Parametrisation
from calibration.search.polish import AT_BOUND

Array = NDArray[np.float64]
Seen = Literal["identified", "weak", "not identified", "at a bound"]

# Of a parameter's sd: above the first part of its prior's sd the prior speaks, not the data; above the
# second (a factor of e^0.5 or half the range) it is not a number to print.
PRIOR_SHARE = 0.7
WEAK, UNSEEN = 0.15, 0.5

FLAT = 12.0**-0.5  # sd of a belief that is flat over a range, as a part of the range


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """value with its 95 % interval [low, high] (SI); sd: of its logarithm where relative, else of itself,
    never more than that of a flat belief over its bounds; seen: what the data say of it."""

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
    """covariance of u with priors (n, n), scaled up where the fit is worse than the noise; blind: directions
    in coordinates that the data alone do not see, as {coordinate: weight}."""

    estimates: tuple[Estimate, ...]
    covariance: Array
    scale: float
    blind: tuple[dict[str, float], ...]
    shear_modulus_sd: float


def identify(
    parametrisation: Parametrisation, u: Array, jacobian: Array, *, reduced_chi2: float
) -> Identification:
    """jacobian: (m, n) of whitened residuals with the prior's rows last.

    Where reduced chi-square is above 1 the data's information is divided by it (the model is wrong by more
    than the noise; Birge's ratio); it is never made larger, and the prior's is left alone.
    """
    n = len(u)
    _, prior_sd = parametrisation.prior()
    prior = np.diag(np.where(np.isfinite(prior_sd), prior_sd, np.inf) ** -2.0)
    data = jacobian.T @ jacobian - prior
    bounds = parametrisation.bounds
    span = bounds[:, 1] - bounds[:, 0]
    # keeps directions that nobody sees finite, and takes next to nothing off what the data say of the others
    floor = np.diag(span**-2.0)
    scale = max(1.0, reduced_chi2)
    covariance = np.asarray(np.linalg.inv(data / scale + prior + floor))
    estimates = []
    for i, c in enumerate(parametrisation.coordinates):
        wide = float(np.sqrt(covariance[i, i]))
        low, high = np.clip([u[i] - 1.96 * wide, u[i] + 1.96 * wide], *bounds[i])
        sd = min(wide, FLAT * float(span[i]))
        estimates.append(
            Estimate(
                name=c.name,
                unit=c.unit,
                value=c.value(u[i]),
                sd=sd,
                low=c.value(low),
                high=c.value(high),
                relative=c.log,
                seen=_seen(sd, prior_sd[i], u[i], bounds[i], yardstick(parametrisation, i, u[i])),
            )
        )
    return Identification(
        estimates=tuple(estimates),
        covariance=covariance,
        scale=scale,
        blind=_blind(parametrisation, data, span),
        shear_modulus_sd=_shear_sd(parametrisation, u, covariance, n),
    )


def yardstick(parametrisation: Parametrisation, i: int, u: float) -> float:
    """What a coordinate's sd is compared with: its value, or a fifth of its range where that is more; 1 for
    a logarithm."""
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
    """Eigenvectors of the data's information, in units of each coordinate's range, with sd above a quarter of
    that range."""
    values, vectors = np.linalg.eigh(data * np.outer(span, span))
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value < 16.0:
            weights = vector / np.abs(vector).max()
            found.append(
                {n: float(w) for n, w in zip(parametrisation.names, weights, strict=True) if abs(w) > 0.1}
            )
    return tuple(found)


def _shear_sd(parametrisation: Parametrisation, u: Array, covariance: Array, n: int) -> float:
    """sd of the small-strain shear modulus [Pa], by linear propagation."""
    steps = 1e-5 * np.eye(n)
    slope = np.array(
        [(parametrisation.moduli(u + s).shear - parametrisation.moduli(u - s).shear) / 2e-5 for s in steps]
    )
    return float(np.sqrt(slope @ covariance @ slope))
