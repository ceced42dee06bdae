"""Null distributions of test statistics for a design, by parametric bootstrap of whitened noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, fdtrc  # scipy.stats takes 0.3 s to import

from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.screening import Screen, basis_of
from calibration.measurements._baseline import ALLOWED, SPECIMENS
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise_known import Estimated

Array = NDArray[np.float64]

DRAWS = 4000
EVERYTHING = "everything"
BEYOND = 0.1  # relative to the least p-value of the draws: below, no draw is expected to reach the value
ROUNDING = 1e-7  # relative length of a column, without the fitted part, that is rounding error


class Null:
    """Draws of whitened noise, shared by all tests of one experiment.

    Parameters
    ----------
    size : number m of residuals.
    basis : discrepancy basis: sets of columns (m, k) by name (`MeasurementModel.discrepancy_basis`).
    estimated : residuals whose noise was estimated from their own scatter; None if all of it is stated.

    Attributes
    ----------
    noise : draws of residuals, shape (DRAWS, m): standard normal where the noise is stated, and where it was
        estimated over what it would have been estimated as.
    explained : cache of converged fits to these residuals by their sets of causes (`explain`). A second round
        and the explained fractions of single causes need many of them again.
    """

    def __init__(
        self, size: int, basis: Mapping[str, Array], *, seed: int = 0, estimated: Estimated | None = None
    ) -> None:
        rng = np.random.default_rng(seed)
        self.noise = rng.standard_normal((DRAWS, size))
        self._freedom = inf if estimated is None else estimated.least
        if estimated is not None and self._freedom < inf:
            self.noise *= estimated.over_estimate(DRAWS, rng)
        self._squares = np.einsum("ij,ij->i", self.noise, self.noise)
        self.basis = dict(basis)
        self.explained: dict[frozenset[Candidate], Explanation] = {}

    @classmethod
    def of(cls, model: MeasurementModel, size: int, *, seed: int) -> Null:
        """Null distributions of the residuals (size,) of a model's fits, with its noise as it is now."""
        return cls(size, model.discrepancy_basis(), seed=seed, estimated=model.estimated_noise())

    @property
    def estimated(self) -> bool:
        """True if some of the noise was estimated from the data."""
        return self._freedom < inf

    def lack_of_fit(self, z: Array, jacobian: Array) -> LackOfFit:
        """Test residuals z (m,) of a fit with this Jacobian (m, n).

        The statistics are the sum of squares of z and that of its projection onto each set of the basis. The
        smallest p-value is referred to its own null distribution, which accounts for the number of tests and
        their correlation. If it is below the resolution of the draws, the chi-square distribution (F, where
        noise was estimated, of the least certain estimate) with a Bonferroni correction is used instead.
        Differences between the moduli of specimens are a set of their own and are projected out of all
        others.
        """
        free = basis_of(jacobian)
        scatter = self.basis.get(SPECIMENS)
        known = free if scatter is None else basis_of(np.hstack([jacobian, scatter]))
        spans: dict[str, Array] = {}
        for name, columns in self.basis.items():
            off = free if name == SPECIMENS else known
            left = columns - off @ (off.T @ columns)
            own = np.linalg.norm(left, axis=0) > ROUNDING * np.linalg.norm(columns, axis=0)
            # orthogonal to the fitted columns, in residuals and noise alike
            spans[name] = basis_of(left[:, own])
        here = {n: float(((z @ s) ** 2).sum()) * ALLOWED.get(n, 1.0) for n, s in spans.items()}
        here = {EVERYTHING: float(z @ z), **here}
        freedom = {EVERYTHING: len(z) - free.shape[1], **{n: s.shape[1] for n, s in spans.items()}}
        each = {n: _tail(here[n], freedom[n], self._freedom) if freedom[n] else 1.0 for n in here}
        least = 1.0 / (DRAWS + 1)
        if min(each.values()) < BEYOND * least:
            p_value = max(len(each) * min(each.values()), least)
            each = {n: max(p, least) for n, p in each.items()}
            return LackOfFit(p_value=p_value, each=each, worst=min(each, key=lambda n: each[n]))
        smallest = np.ones(DRAWS)
        for name, square in here.items():
            if name == EVERYTHING:
                squares = self._squares - ((self.noise @ free) ** 2).sum(axis=1)
            else:
                squares = ((self.noise @ spans[name]) ** 2).sum(axis=1)
            order = np.sort(squares)
            smallest = np.minimum(smallest, _exceeding(squares, order))
            each[name] = float(_exceeding(np.array([square]), order)[0])
        worst = min(each, key=lambda n: each[n])
        p = (np.count_nonzero(smallest <= each[worst]) + 1) / (DRAWS + 1)
        return LackOfFit(p_value=float(min(1.0, p)), each=each, worst=worst)

    def max_improvement(self, screened: Screen) -> MaxImprovement:
        """Null distribution of the largest penalised improvement over all candidates (`Screen.penalised`)."""
        best = np.zeros(DRAWS)
        for part in np.array_split(np.arange(DRAWS), 8):  # in parts, to limit memory
            best[part] = screened.penalised(self.noise[part]).max(axis=1, initial=0.0)
        return MaxImprovement(drawn=np.sort(best), estimated=self.estimated)


@dataclass(frozen=True, eq=False, kw_only=True)
class MaxImprovement:
    """Null distribution of the largest penalised improvement of chi-square.

    Attributes
    ----------
    drawn : sorted draws, shape (DRAWS,).
    estimated : True if some of the noise was estimated, so that no theory gives the tail.
    """

    drawn: Array
    estimated: bool = False

    def p_value(self, improvement: float) -> float:
        """Probability that noise alone gives the best of all candidates at least this improvement.

        If fewer than about 20 draws exceed it, the tail is that of the maximum of k independent chi-square
        variables with one degree of freedom, where k matches the upper 1 % quantile of the draws. With
        estimated noise draws are counted to the last.
        """
        counted = (len(self.drawn) - np.searchsorted(self.drawn, improvement) + 1) / (len(self.drawn) + 1)
        if self.estimated or counted > 20.0 / len(self.drawn):
            return float(counted)
        tries = 0.01 / chdtrc(1, self.threshold(0.01))
        return float(min(20.0 / len(self.drawn), tries * chdtrc(1, max(0.0, improvement))))

    def threshold(self, p_value: float) -> float:
        """Improvement that noise alone exceeds with probability `p_value`."""
        return float(np.quantile(self.drawn, 1.0 - p_value))


def _tail(square: float, freedom: int, of_noise: float) -> float:
    """Probability of a larger sum of squares of `freedom` residuals; of_noise : that of the noise's sd."""
    if of_noise == inf:
        return float(chdtrc(freedom, square))
    return float(fdtrc(freedom, of_noise, square / freedom))


def _exceeding(values: Array, order: Array) -> Array:
    """Fraction of the sorted draws that are at least each value: (count + 1) / (draws + 1), never 0."""
    above = len(order) - np.searchsorted(order, values, side="left")
    return np.asarray((above + 1) / (len(order) + 1))
