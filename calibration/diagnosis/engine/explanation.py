"""Sets of causes fitted in the simulator: score, test for lack of fit, comparison of alternatives."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import Fit, fit
from calibration.diagnosis.engine.null import LackOfFit, Null
from calibration.diagnosis.engine.screening import multiplicity_penalty
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel

Array = NDArray[np.float64]

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


def explain(
    model: MeasurementModel,
    start: Fit,
    candidates: Sequence[Candidate],
    amplitudes: Sequence[float],
    null: Null,
) -> Explanation | None:
    """Fit a set of causes, starting from another fit and initial amplitudes [SI].

    Returns None if the simulator finds no solution from any of the starts. A converged fit of the same causes
    is reused (`Null.explained`).
    """
    causes = frozenset(candidates)
    if causes in null.explained:
        return null.explained[causes]
    known = dict(start.state.amplitudes)
    begun = model.begun(start.state, [c for c in candidates if c not in known])
    for c, a in zip(candidates, amplitudes, strict=True):
        effect = model.effects[c.effect]
        low, high = effect.bounds
        there = (
            high if effect.switch else np.clip(a, effect.start_fraction * low, effect.start_fraction * high)
        )
        known.setdefault(c, float(there))
    for fraction in (1.0, 0.3, 0.0):  # closer to the baseline if there is no equilibrium
        inside = {c: known[c] if model.effects[c.effect].switch else fraction * known[c] for c in candidates}
        try:
            found = fit(model, replace(begun, amplitudes=inside), candidates)
        except ValueError:
            continue
        if fraction > 0.0 and not found.converged and found.chi2 > start.chi2:
            continue  # diverged from a distant start
        each = float(np.log(len(found.z)))
        constants = each * sum(map(model.brings, found.candidates))
        cost = each * len(found.candidates) + sum(map(multiplicity_penalty, found.candidates))
        left = null.lack_of_fit(found.z, found.jacobian)
        made = Explanation(fit=found, cost=cost + constants, lack_of_fit=left, constants_cost=constants)
        if found.converged:
            null.explained[causes] = made
        return made
    return None


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


def ranked_first(explanations: Sequence[Explanation], null: Null) -> dict[Names, float]:
    """Probability that each set of effects is ranked first under new noise, if the best explanation is true.

    Each explanation is refitted, to first order, to the prediction of the best one plus drawn noise (the
    first 1000 draws of `null`).
    """
    ordered = sorted(explanations, key=lambda e: e.score)
    draws = null.noise[:1000]
    scores = np.empty((len(ordered), len(draws)))
    for row, e in zip(scores, ordered, strict=True):
        data = e.fit.z - ordered[0].fit.z + draws
        size = np.linalg.norm(e.fit.jacobian, axis=0)
        q, _ = np.linalg.qr(e.fit.jacobian[:, size > 0] / size[size > 0])
        row[:] = (data**2).sum(axis=1) - ((data @ q) ** 2).sum(axis=1) + e.cost
    times = Counter(ordered[k].names for k in scores.argmin(axis=0))
    return {names: count / len(draws) for names, count in times.items()}
