"""Fraction of the explainable misfit removed by an explanation and by each of its causes, with intervals.

With a noise estimate of nu degrees of freedom, lambda = chi2 (nu - 2) / nu - (N - n) estimates the systematic
misfit of a fit of n coordinates to N points without bias, since E[1/s^2] = nu / ((nu - 2) sigma^2) (after
Haefner and Cumming, Adv. Neural Inf. Process. Syst. 21, 2008). The explained fraction ("share") of an
explanation is 1 - lambda_explained / lambda_baseline. It is divided among correlated causes by their Shapley
values (in regression: LMG; Groemping, J. Stat. Softw. 17, 2006), which sum to the total independently of the
order of the causes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from math import factorial, inf

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.resampling import Groups, Resampled, groups_of
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel

Array = NDArray[np.float64]

INTERVAL = (0.025, 0.975)


@dataclass(frozen=True, kw_only=True)
class Interval:
    """Explained fraction with its 95 % bootstrap interval; infinite bounds if there is none."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Misfit:
    """Systematic misfit lambda of a fit, in units of the noise variance.

    Attributes
    ----------
    value : value of the fit.
    drawn : values of the bootstrap replicates, shape (b,).
    """

    value: float
    drawn: Array


class Shares:
    """Explained fractions of several fits of one experiment, from the same bootstrap replicates.

    Parameters
    ----------
    model : the measurements.
    baseline : fit of the baseline.
    draws, seed : number of bootstrap replicates, and seed.
    noise_dof : degrees of freedom nu of the noise estimate; inf if the noise is known.
    noise_scale : ratio of the noise to the standard deviation that residuals were whitened by.
    """

    def __init__(
        self,
        model: MeasurementModel,
        baseline: Fit,
        *,
        draws: int,
        seed: int,
        noise_dof: float = inf,
        noise_scale: float = 1.0,
    ) -> None:
        self._variance = noise_scale**2
        self.groups: Groups = groups_of(model)
        self._drawn = self.groups.draws(draws, seed)
        self._known = 1.0 if noise_dof == inf else max(noise_dof - 2.0, 0.0) / noise_dof
        self.baseline = self.misfit(baseline)

    def misfit(self, fit: Fit) -> Misfit:
        again = Resampled(fit, self.groups)
        once = again.replicates(np.ones((1, self.groups.count)))
        drawn = again.replicates(self._drawn)
        return Misfit(
            value=float(self._known * fit.chi2 - self._variance * once.expected[0]),
            drawn=np.asarray(self._known * drawn.chi2 - self._variance * drawn.expected),
        )

    def moves(self, fit: Fit) -> Array:
        """Change of coordinates and amplitudes from the fit in each replicate, shape (b, n)."""
        return Resampled(fit, self.groups).replicates(self._drawn).moves

    def share(self, explained: Misfit) -> Interval:
        """Fraction of the baseline's misfit that an explanation with misfit `explained` removes."""
        return self._interval(1.0 - explained.value / self.baseline.value, self.drawn(explained))

    def drawn(self, explained: Misfit) -> Array:
        """Explained fraction in each replicate, shape (b,); 0 if the baseline leaves no misfit there."""
        base = self.baseline.drawn
        some = base > 0.0
        return np.where(some, 1.0 - explained.drawn / np.where(some, base, 1.0), 0.0)

    def _interval(self, value: float, drawn: Array) -> Interval:
        if self.groups.count < 2 or not self.baseline.value > 0.0:
            return Interval(value=value, low=-inf, high=inf)
        low, high = np.quantile(drawn, INTERVAL)
        return Interval(value=value, low=float(min(low, value)), high=float(max(high, value)))

    def of_causes(
        self, model: MeasurementModel, start: Fit, chosen: Explanation, null: Null
    ) -> dict[Candidate, Interval]:
        """Shapley value of each cause.

        Subsets of the causes are fitted in the simulator, starting from the baseline `start`. A subset
        without a solution counts as the baseline.
        """
        causes = chosen.candidates
        parts: dict[frozenset[Candidate], Misfit] = {
            frozenset(): self.baseline,
            frozenset(causes): self.misfit(chosen.fit),
        }
        for size in range(1, len(causes)):
            for some in combinations(causes, size):
                guess = [chosen.fit.state.amplitudes[c] for c in some]
                found = explain(model, start, some, guess, null)
                parts[frozenset(some)] = self.baseline if found is None else self.misfit(found.fit)
        return {c: self._shapley(c, causes, parts) for c in causes}

    def _shapley(
        self,
        cause: Candidate,
        causes: tuple[Candidate, ...],
        parts: Mapping[frozenset[Candidate], Misfit],
    ) -> Interval:
        others = [c for c in causes if c != cause]
        value, drawn = 0.0, np.zeros(len(self._drawn))
        for size in range(len(causes)):
            weight = factorial(size) * factorial(len(others) - size) / factorial(len(causes))
            for some in combinations(others, size):
                without, beside = parts[frozenset(some)], parts[frozenset((*some, cause))]
                value += weight * (without.value - beside.value) / self.baseline.value
                drawn += weight * (self.drawn(beside) - self.drawn(without))
        return self._interval(value, drawn)
