"""Fits of sets of causes in the simulator, and how often noise would rank each of them first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.diagnosis.engine.explanation import Explanation, Names
from calibration.diagnosis.engine.fitting import Fit, fit
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.screening import multiplicity_penalty
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel


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
