"""Two causes at once: looked for only while what is left is more than noise would leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calibration.diagnosis.explanation import Explanation, explain
from calibration.diagnosis.fitting import Fit
from calibration.diagnosis.nested import Linear, Nested
from calibration.diagnosis.null import Null
from calibration.diagnosis.pairs import best_pairs
from calibration.diagnosis.rules import Rules, Tell
from calibration.diagnosis.screening import Screen, screen

Array = NDArray[np.float64]
PERHAPS = 0.1  # chance of a second cause by the baseline's columns, below which it is looked for properly


def with_second(
    model: Nested,
    best: Explanation,
    screened: Screen,
    columns: Array,
    null: Null,
    rules: Rules,
    tell: Tell,
) -> list[Explanation]:
    """Pairs of causes, where one more than the best one gains what noise alone would not.

    columns: the candidates' at the baseline; where even these promise nothing, none is linearised anew.
    """
    # another place of an effect that has one cannot be added to it: the scene holds one
    placed = {c.effect for c in best.candidates if c.place is not None}
    seen = [
        k
        for k, c in enumerate(screened.candidates)
        if screened.sizes[k] > 0.0 and (c.effect not in placed or c in best.candidates)
    ]
    candidates = tuple(screened.candidates[k] for k in seen)
    held = best.fit.linear
    roughly = screen(
        replace(held, columns=columns[:, seen], candidates=candidates), model.effects, held=best.fit
    )
    if null.gains(roughly).chance(float(roughly.promises(held.z).max(initial=0.0))) > PERHAPS:
        return []
    linear = model.linearise(best.fit.state, candidates)
    beside = screen(linear, model.effects, held=best.fit)
    gained = beside.promises(linear.z)
    if null.gains(beside).chance(float(gained.max(initial=0.0))) > rules.second:
        return []
    # the best single cause may be a mixture of two others: pairs are sought afresh, around where it leads
    target = linear.z - held.columns @ np.array(list(best.fit.state.amplitudes.values()))
    return _pairs(model, best.fit, screen(linear, model.effects), linear.columns, target, null, rules, tell)


def hiding_each_other(
    model: Nested,
    baseline: Fit,
    screened: Screen,
    linear: Linear,
    null: Null,
    rules: Rules,
    tell: Tell,
) -> list[Explanation]:
    """Pairs of causes of which neither alone gains what noise would not, but both do."""
    found = _pairs(model, baseline, screened, linear.columns, linear.z, null, rules, tell)
    tries = 0.5 * np.count_nonzero(screened.sizes) ** 2
    return [e for e in found if tries * chi2.sf(baseline.chi2 - e.fit.chi2, 2) < rules.alarm]


def _pairs(
    model: Nested,
    start: Fit,
    screened: Screen,
    columns: Array,
    target: Array,
    null: Null,
    rules: Rules,
    tell: Tell,
) -> list[Explanation]:
    """The pairs that promise most for the residuals `target`, confirmed."""
    found = []
    pairs = best_pairs(screened, target, count=rules.pairs)
    for n, (a, b) in enumerate(pairs):
        both = (screened.candidates[a], screened.candidates[b])
        tell(f"confirming pair {n + 1} of {len(pairs)}: {both[0].label} + {both[1].label}")
        left = columns[:, [a, b]] - screened.free @ (screened.free.T @ columns[:, [a, b]])
        guess = [float(x) for x in -np.linalg.lstsq(left, target, rcond=None)[0]]
        pair = explain(model, start, both, guess, null)
        if pair is not None and all_there(model, pair):
            found.append(pair)
    return found


def all_there(model: Nested, found: Explanation) -> bool:
    """Whether no amplitude ended at a bound: at zero it is no cause, elsewhere none that makes sense, but
    where the physics itself ends."""
    return not any(
        x in effect.bounds and x not in effect.ends
        for effect, x in ((model.effects[c.effect], x) for c, x in found.fit.state.amplitudes.items())
    )
