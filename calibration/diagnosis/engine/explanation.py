"""Explanations: sets of causes fitted in the simulator, with their score and remaining lack of fit."""

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
    cost : penalty added to chi-square for the number of amplitudes (Bayes' information criterion) and for the
        choice among alternatives (twice the logarithm of their number).
    constants_cost : the part of `cost` for constants that causes have beside their amplitudes (those of a
        law).
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
        """Penalty for the choice among alternatives, in chi-square."""
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
    """Fit a set of causes, from another fit and initial amplitudes [SI].

    None if the simulator has no equilibrium with them. Converged fits are cached in `Null.explained`.
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
    """Distinct sets of effects that explain the data as well as the best one, best first.

    These are the sets whose score is within `tolerance` of the best, and those that rank first in at least
    `first_fraction` of the replicates; `first` has that fraction by set. A set that only adds to a better
    one is left out.

    If several causes are named, the constants of a richer law in place of some of them do not count in the
    score: they make a set less simple, which is no evidence against it, and several causes are not simple
    either.
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
    """Probability that each set of effects would rank first with other noise, if the best one were true.

    Each explanation is refitted, to first order, to the prediction of the best one plus random noise.
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
