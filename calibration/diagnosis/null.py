"""What chance alone does for this design: null distributions by parametric bootstrap of whitened noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calibration.diagnosis.screening import Screen, basis_of
from calibration.diagnosis.specimens import ALLOWED, SPECIMENS

Array = NDArray[np.float64]

DRAWS = 4000
EVERYTHING = "everything"
ROUNDING = 1e-7  # part of a pattern that is not its own where the rest is fitted


@dataclass(frozen=True, eq=False, kw_only=True)
class Departure:
    """Whether residuals depart from noise. p: the chance that noise alone departs as much, over all tests
    together; each: p of each test by its name; worst: the name of the strongest."""

    p: float
    each: Mapping[str, float]
    worst: str


class Null:
    """Draws of whitened noise, shared by all questions that are asked of one experiment.

    patterns: what a departure that nobody thought of might look like, columns (m, k) by name.
    """

    def __init__(self, size: int, patterns: Mapping[str, Array], *, seed: int = 0) -> None:
        self.noise = np.random.default_rng(seed).standard_normal((DRAWS, size))
        self.patterns = dict(patterns)

    def departure(self, z: Array, jacobian: Array) -> Departure:
        """Test residuals z (m,) of a fit with this Jacobian (m, n).

        The tests: the whole squared sum, and the squared sum in each set of patterns. Their smallest p-value
        is judged by its own distribution, which accounts for their number and for what they share. By what
        the moduli of specimens differ is a set of its own, and part of no other.
        """
        free = basis_of(jacobian)
        scatter = self.patterns.get(SPECIMENS)
        known = free if scatter is None else basis_of(np.hstack([jacobian, scatter]))
        drawn = self.noise - (self.noise @ free) @ free.T
        smallest = np.ones(DRAWS)
        each: dict[str, float] = {}
        for name in (EVERYTHING, *self.patterns):
            if name == EVERYTHING:
                squares, here = (drawn**2).sum(axis=1), float(z @ z)
            else:
                columns, off = self.patterns[name], free if name == SPECIMENS else known
                left = columns - off @ (off.T @ columns)
                own = np.linalg.norm(left, axis=0) > ROUNDING * np.linalg.norm(columns, axis=0)
                span = basis_of(left[:, own])
                squares, here = ((drawn @ span) ** 2).sum(axis=1), float(((z @ span) ** 2).sum())
                here *= ALLOWED.get(name, 1.0)
            order = np.sort(squares)
            smallest = np.minimum(smallest, _exceeding(squares, order))
            each[name] = float(_exceeding(np.array([here]), order)[0])
        worst = min(each, key=lambda n: each[n])
        p = (np.count_nonzero(smallest <= each[worst]) + 1) / (DRAWS + 1)
        return Departure(p=float(min(1.0, p)), each=each, worst=worst)

    def gains(self, screened: Screen) -> Gains:
        """The null distribution of the best candidate's promise (`Screen.promises`)."""
        best = np.zeros(DRAWS)
        for part in np.array_split(np.arange(DRAWS), 8):  # in parts: it is draws times candidates
            best[part] = screened.promises(self.noise[part]).max(axis=1, initial=0.0)
        return Gains(drawn=np.sort(best))


@dataclass(frozen=True, eq=False, kw_only=True)
class Gains:
    """Sorted draws of the best candidate's improvement of chi-square by noise alone, less what the choice of
    its place is worth."""

    drawn: Array

    def chance(self, gain: float) -> float:
        """That noise alone gives the best of all candidates this improvement. Beyond what the draws reach,
        the tail is that of as many independent squared normals as agree with the draws' 1 % quantile."""
        counted = (len(self.drawn) - np.searchsorted(self.drawn, gain) + 1) / (len(self.drawn) + 1)
        if counted > 20.0 / len(self.drawn):
            return float(counted)
        tries = 0.01 / chi2.sf(self.threshold(0.01), 1)
        return float(min(20.0 / len(self.drawn), tries * chi2.sf(gain, 1)))

    def threshold(self, chance: float) -> float:
        """Improvement that noise alone exceeds with this chance."""
        return float(np.quantile(self.drawn, 1.0 - chance))


def _exceeding(values: Array, order: Array) -> Array:
    """Part of the sorted draws that reaches each value, never none."""
    above = len(order) - np.searchsorted(order, values, side="left")
    return np.asarray((above + 1) / (len(order) + 1))
