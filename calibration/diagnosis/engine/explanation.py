"""A set of causes with its fit: score and test for lack of fit; comparison of alternatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.screening import multiplicity_penalty
from calibration.measurements._effect import Candidate

Names = tuple[str, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Explanation:
    """A set of causes with its fit.

    Attributes
    ----------
    fit : fit of the baseline's coordinates and the causes' amplitudes.
    cost : penalty added to chi-square: ln m per amplitude or further constant (Bayesian information
        criterion, m residuals), plus the multiplicity penalties.
    constants_cost : contribution to `cost` of further constants that causes introduce (parameters of a law).
    lack_of_fit : test of the residuals of the fit.
    """

    fit: Fit
    cost: float
    lack_of_fit: LackOfFit
    constants_cost: float = 0.0

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        return self.fit.candidates

    @property
    def names(self) -> Names:
        return tuple(sorted({c.effect for c in self.candidates}))

    @property
    def multiplicity_penalty(self) -> float:
        """Sum of the candidates' multiplicity penalties (`screening.multiplicity_penalty`)."""
        return sum(multiplicity_penalty(c) for c in self.candidates)

    @property
    def score(self) -> float:
        return self.fit.chi2 + self.cost


def equivalent_explanations(
    explanations: Sequence[Explanation],
    tolerance: float,
    first: Mapping[Names, float] | None = None,
    first_fraction: float = 1.0,
) -> tuple[Names, ...]:
    """Distinct sets of effects that the data cannot separate from the best one, best first.

    A set is included if its score is within `tolerance` of the best, or if its probability of being ranked
    first (`first`) is at least `first_fraction`. A superset of a better set is left out.

    If the best explanation has several effects, `constants_cost` is not counted for sets of as many effects
    or fewer: constants of a richer law make a set less simple, which is no evidence against it, and several
    causes are not simple either.
    """
    ordered = sorted(explanations, key=lambda e: e.score)
    found: list[Names] = []
    for e in ordered:
        as_many = len(e.names) <= len(ordered[0].names) > 1
        score = e.score - (e.constants_cost if as_many else 0.0)
        near = score <= ordered[0].score + tolerance or (first or {}).get(e.names, 0.0) >= first_fraction
        if not near or e.names in found:
            continue
        if not any(set(better) < set(e.names) for better in found):
            found.append(e.names)
    return tuple(found)
