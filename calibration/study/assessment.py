"""Assessment of a fit: does chance explain the residuals between the data and the fitted law?

A search that converges is not yet a calibration. Where a constant is driven to a bound of the search or away
from its prior, where more nuisances leave the lab's stated uncertainty than chance allows, or where the
misfit is far above the noise, the data ask for something that the law, the rig or the camera model lacks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import comb, erfc, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import chdtri, fdtri  # scipy.stats takes 0.3 s to import

from calibration.inference import Estimate
from calibration.parameters import Parametrisation, parametrisation

NEAR = 1e-3  # of a coordinate's range: so near to a bound counts as being there
LEAST_GAIN = 1.0  # improvement of chi-square by a step over a bound, from which the data ask for it
FROM_PRIOR = 3.0  # sd: chance leads there in 0.3 % of fits
LEAST_P = 1e-3  # p-value of the nuisances, below which they count as a lack of fit
NOISE_OFF = 1.5  # reduced chi-square that a noise sd stated 20 % too small explains

NAMES = {
    "shear_modulus": "G",
    "bulk_ratio": "K/G",
    "second_share": "C01 / (C10 + C01)",
    "locking": "locking stretch",
}


def display_name(name: str) -> str:
    """Name of a search coordinate in texts; terms of a series keep their number."""
    for known, word in NAMES.items():
        if name == known:
            return word
        if name.startswith(f"{known}_"):
            return f"{word} {name.removeprefix(f'{known}_')}"
    return name.replace("_", " ")


def undetermined_terms(law: str, terms: int, estimates: Iterable[Estimate]) -> str:
    """Sentence on a series law of which the data determine fewer terms than were fitted; empty elsewhere.

    Terms that are too much alike make up for each other: their constants run along a valley without an end,
    so that the fit neither converges nor has error bars of them.
    """
    if terms == 1:
        return ""
    coordinates = parametrisation(law, terms=terms).coordinates
    own = {c.name for c in coordinates if c.name[-1].isdigit()}  # of a term: shear_modulus_2
    unknown = [display_name(e.name) for e in estimates if e.seen == "not identified" and e.name in own]
    if not unknown:
        return ""
    return (
        f"the data do not determine {terms} terms of {law} ({', '.join(unknown)} not"
        f" identified): fit fewer, by --terms {terms - 1}"
    )


def at_bounds(
    parametrisation: Parametrisation, u: ArrayLike, gains: ArrayLike | None = None
) -> dict[str, float]:
    """Constants at a bound of the search that is no simpler law, with the bound's value.

    Parameters
    ----------
    parametrisation : Parametrisation
    u : array, shape (n,)
    gains : array, shape (n,), optional
        Chi-square that a free step of each coordinate alone would gain (`step_gains`). With it, a bound
        counts only where the data press against it (a gain above `LEAST_GAIN`); a constant that they do not
        see may end anywhere.
    """
    found = {}
    improvements = np.full(len(parametrisation.coordinates), np.inf) if gains is None else np.asarray(gains)
    for c, x, (low, high), gain in zip(
        parametrisation.coordinates, np.asarray(u, float), parametrisation.bounds, improvements, strict=True
    ):
        near = NEAR * (high - low)
        if gain < LEAST_GAIN or c.held:
            continue
        if x - low < near and not c.limit_low:
            found[c.name] = c.low
        elif high - x < near and not c.limit_high:
            found[c.name] = c.high
    return found


def step_gains(residuals: ArrayLike, jacobian: ArrayLike) -> NDArray[np.float64]:
    """(J_i' r)^2 / (J_i' J_i): chi-square that a free step of coordinate i alone would gain, shape (n,)."""
    J, r = np.asarray(jacobian, float), np.asarray(residuals, float)
    return np.asarray((J.T @ r) ** 2 / np.maximum((J**2).sum(axis=0), 1e-300))


def off_prior(parametrisation: Parametrisation, u: ArrayLike) -> dict[str, float]:
    """Constants farther from their prior than `FROM_PRIOR` sd, with that distance [sd]."""
    centre, sd = parametrisation.prior()
    away = np.abs((np.asarray(u, float) - centre) / sd)
    return {
        c.name: float(a)
        for c, a in zip(parametrisation.coordinates, away, strict=True)
        if a > FROM_PRIOR and not c.held
    }


def constants_lacking(
    parametrisation: Parametrisation, u: ArrayLike, gains: ArrayLike | None = None
) -> tuple[str, ...]:
    """A phrase for each constant that is driven to a bound or away from its prior."""
    bounds, away = at_bounds(parametrisation, u, gains), off_prior(parametrisation, u)
    phrases = [f"{display_name(n)} ends at its bound {value:g}" for n, value in bounds.items()]
    for name, distance in away.items():
        if name not in bounds:
            i = parametrisation.names.index(name)
            c = parametrisation.coordinates[i]
            centre, _ = parametrisation.prior()
            value = c.value(float(np.asarray(u, float)[i]))
            phrases.append(
                f"{display_name(name)} {value:.3g} lies {distance:.1f} standard deviations from its prior's"
                f" {c.value(centre[i]):.3g}"
            )
    return tuple(phrases)


def misfit_lacking(reduced_chi2: float, freedom: int, noise_freedom: float | None = None) -> tuple[str, ...]:
    """A phrase on a reduced chi-square that is larger than chance and a noise stated too small make it."""
    if reduced_chi2 > max(NOISE_OFF, largest_by_chance(freedom, noise_freedom)):
        return (f"reduced chi-square {reduced_chi2:.3g}",)
    return ()


def largest_by_chance(freedom: int, noise_freedom: float | None = None) -> float:
    """Reduced chi-square that noise alone exceeds in 1 of 740 fits (three standard deviations).

    With a noise that is itself estimated, with d = `noise_freedom` degrees of freedom, it follows
    F(freedom, d).
    """
    tail = 0.5 * erfc(3.0 / sqrt(2.0))
    if noise_freedom is None:
        return float(chdtri(freedom, tail)) / freedom
    return float(fdtri(freedom, noise_freedom, 1.0 - tail))


def nuisances_lacking(nuisances: Mapping[str, float]) -> list[str]:
    """Phrases on nuisances [sd], where chance explains neither their number beyond 2 sd nor the largest."""
    n = len(nuisances)
    if not n:
        return []
    beyond = sum(abs(v) > 2.0 for v in nuisances.values())
    tail = erfc(2.0 / sqrt(2.0))
    if _at_least(beyond, n, tail) < LEAST_P:
        return [
            f"{beyond} of {n} nuisances lie beyond 2 standard deviations, where chance puts about"
            f" {n * tail:.0f}"
        ]
    name, largest = max(nuisances.items(), key=lambda pair: abs(pair[1]))
    if n * erfc(abs(largest) / sqrt(2.0)) < LEAST_P:
        return [f"{name} lies {abs(largest):.1f} standard deviations from what the lab states"]
    return []


def _at_least(k: int, n: int, p: float) -> float:
    """Binomial probability of k or more."""
    return 1.0 - sum(comb(n, i) * p**i * (1.0 - p) ** (n - i) for i in range(k))


def sentence(label: str, lacking: tuple[str, ...], experiment: str = "EXPERIMENT") -> str:
    """The message of a fit with a lack of fit."""
    return (
        f"the data ask for something that {label} lacks ({'; '.join(lacking)}): find the cause with"
        f" python -m calibration.diagnose {experiment}"
    )
