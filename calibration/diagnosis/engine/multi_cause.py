"""Multi-cause search: pairs and triples of causes, as long as further causes improve the fit significantly.

All pairs, and all triples, of candidates are compared to first order; the best of them are confirmed in the
simulator. A triple is accepted only if each of its three causes is significant. Effects that can replace one
of the three are confirmed as well, so that they can be named as alternatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, chdtri  # scipy.stats takes 0.3 s to import

from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation, Names
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.rules import Rules
from calibration.diagnosis.engine.screening import Screen, multiplicity_penalty, screen
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import Linearisation
from calibration.progress import OnMessage

Array = NDArray[np.float64]

ALIKE = 0.98  # cosine above which two candidates count as one
KEPT = 200  # triples kept per candidate, before those with forbidden signs or equal names are removed
POSSIBLE = (
    0.1  # p-value of a second cause, by the baseline's columns, below which candidates are relinearised
)
HOPELESS, FAR = (
    0.35,
    40.0,
)  # a replacement with less than this fraction of the improvement, and less by this much, is not fitted
STAND_INS = 2  # number of replacements that are fitted for each of three causes
ROUNDS = 3  # rounds of replacements in the best triple
ONCE_MORE = 2.0  # largest ratio of the improvement in the simulator to that of first order
NOISE = 6.0  # standard deviations of chi-square within which only noise may be left


def worth_fitting(baseline: Fit, now: float, promised: float, rules: Rules) -> bool:
    """True if causes with this first-order reduction of the chi-square `now` could be named.

    With `ONCE_MORE` times the reduction they must leave no more than noise, or remove the additional fraction
    of the misfit that one more cause has to (`Rules.further_share`).
    """
    freedom = len(baseline.z) - len(baseline.state.u)
    reach = ONCE_MORE * promised
    noise = freedom + NOISE * np.sqrt(2.0 * freedom)
    return bool(now - reach <= noise or reach >= rules.further_share * (baseline.chi2 - freedom))


def with_second(
    model: MeasurementModel,
    baseline: Fit,
    best: Explanation,
    screened: Screen,
    columns: Array,
    null: Null,
    rules: Rules,
    on_progress: OnMessage,
) -> list[Explanation]:
    """Search for pairs of causes if a second cause improves the best explanation significantly.

    columns : derivatives by the amplitudes at the baseline, shape (m, c). If these indicate no second cause,
    the model is not linearised again at the best explanation.
    """
    # another position of an effect that has one cannot be added to it: the scene holds one
    placed = {c.effect for c in best.candidates if c.position is not None}
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
    if null.max_improvement(roughly).p_value(float(roughly.penalised(held.z).max(initial=0.0))) > POSSIBLE:
        return []
    linear = model.linearise(best.fit.state, candidates)
    beside = screen(linear, model.effects, held=best.fit)
    improvement = beside.penalised(linear.z)
    if null.max_improvement(beside).p_value(float(improvement.max(initial=0.0))) > rules.extra_cause_rate:
        return []
    # the best single cause may stand for two others: all pairs are compared at its state
    target = linear.z - held.columns @ np.array(list(best.fit.state.amplitudes.values()))
    afresh = screen(linear, model.effects)
    # a cause at a bound is not named: a pair that replaces it need not be better
    against = baseline if inside_bounds(model, best) else None
    found = _pairs(
        model, best.fit, afresh, linear.columns, target, null, rules, on_progress, baseline=against
    )
    if any(afresh.sizes[candidates.index(c)] == 0.0 for c in best.candidates if c in candidates):
        # its own coordinates hide it to first order at this state: no such pair contains it
        found += _beside(model, best, beside, improvement, linear.z, null, rules, on_progress)
    return found


def _beside(
    model: MeasurementModel,
    best: Explanation,
    beside: Screen,
    improvement: Array,
    z: Array,
    null: Null,
    rules: Rules,
    on_progress: OnMessage,
) -> list[Explanation]:
    """Confirm pairs of the best explanation and each of the effects with the largest further improvement."""
    found = []
    for k in _best_of_each(beside, improvement, rules.max_pairs):
        other = beside.candidates[k]
        if other.effect in best.names:
            continue
        both = (*best.candidates, other)
        on_progress(f"confirming {best.fit.label} + {other.label}")
        guess = [*best.fit.state.amplitudes.values(), float(beside.amplitudes(z)[k])]
        pair = explain(model, best.fit, both, guess, null)
        if pair is not None and inside_bounds(model, pair):
            found.append(pair)
    return found


def hiding_each_other(
    model: MeasurementModel,
    baseline: Fit,
    screened: Screen,
    linear: Linearisation,
    null: Null,
    rules: Rules,
    on_progress: OnMessage,
) -> list[Explanation]:
    """Pairs of causes that improve chi-square significantly together although neither does alone."""
    found = _pairs(model, baseline, screened, linear.columns, linear.z, null, rules, on_progress)
    tries = 0.5 * np.count_nonzero(screened.sizes) ** 2
    return [
        e for e in found if tries * chdtrc(2, max(0.0, baseline.chi2 - e.fit.chi2)) < rules.false_alarm_rate
    ]


def _pairs(
    model: MeasurementModel,
    start: Fit,
    screened: Screen,
    columns: Array,
    target: Array,
    null: Null,
    rules: Rules,
    on_progress: OnMessage,
    *,
    baseline: Fit | None = None,
) -> list[Explanation]:
    """Confirm the pairs with the largest first-order improvement for the residuals `target`.

    If a baseline is given, pairs that could not be named (`worth_fitting`) are skipped.
    """
    found = []
    pairs = best_pairs(screened, target, count=rules.max_pairs)
    for n, (a, b) in enumerate(pairs):
        both = (screened.candidates[a], screened.candidates[b])
        guess, squares = _linear_fit(screened, columns[:, [a, b]], target)
        if baseline is not None and not worth_fitting(baseline, start.chi2, start.chi2 - squares, rules):
            continue
        on_progress(f"confirming pair {n + 1} of {len(pairs)}: {both[0].label} + {both[1].label}")
        pair = explain(model, start, both, guess, null)
        if pair is not None and inside_bounds(model, pair):
            found.append(pair)
    return found


def _linear_fit(screened: Screen, columns: Array, target: Array) -> tuple[list[float], float]:
    """Least-squares amplitudes of columns (m, k) for residuals (m,), and the sum of squares that remains."""
    left = columns - screened.free @ (screened.free.T @ columns)
    there = target - screened.free @ (screened.free.T @ target)
    guess = -np.linalg.lstsq(left, target, rcond=None)[0]
    return [float(x) for x in guess], float(np.sum((there + left @ guess) ** 2))


def inside_bounds(model: MeasurementModel, found: Explanation) -> bool:
    """True if no amplitude is at a bound, physical limits excepted.

    A cause with amplitude 0 is absent; one at another bound is implausible.
    """
    return not any(
        x in effect.bounds and x not in effect.physical_limits
        for effect, x in ((model.effects[c.effect], x) for c, x in found.fit.state.amplitudes.items())
    )


def with_third(
    model: MeasurementModel,
    baseline: Fit,
    pairs: Sequence[Explanation],
    null: Null,
    rules: Rules,
    on_progress: OnMessage,
) -> list[Explanation]:
    """Search for sets of three significant causes.

    A third cause is added to the best pairs if it improves chi-square significantly, and triples compared to
    first order are confirmed. Then each cause of the best triple is replaced by others, so that equivalent
    explanations are found.
    """
    threes = _Triples(model, baseline, null, rules, on_progress)
    beside: list[Names] = []
    for pair in sorted(pairs, key=lambda e: e.score):
        if pair.names not in beside and len(beside) < rules.max_triples[0]:
            beside.append(pair.names)
            threes.add_to(pair)
    for _ in range(ROUNDS):
        best = min(threes.found, key=lambda e: e.score, default=None)
        if best is None or not threes.replace_in(best):
            break
    return threes.found


class _Triples:
    """Search for three causes; `found` are the explanations in which each of the three is significant."""

    def __init__(
        self, model: MeasurementModel, baseline: Fit, null: Null, rules: Rules, on_progress: OnMessage
    ) -> None:
        self.model, self.baseline = model, baseline
        self.null, self.rules, self.on_progress = null, rules, on_progress
        self.found: list[Explanation] = []
        self._tried: set[frozenset[Candidate]] = set()

    def add_to(self, pair: Explanation) -> None:
        """Confirm triples near a pair, if a third cause improves chi-square significantly."""
        self.on_progress(f"looking for a third cause beside {pair.fit.label}")
        linear = self._linear(pair)
        beside = screen(linear, self.model.effects, held=pair.fit)
        # an effect that the pair has already has a position, or scope: the scene has only one
        free = np.array([c.effect not in pair.names for c in linear.candidates]) & (beside.sizes > 0.0)
        promises = np.where(free, beside.penalised(linear.z), 0.0)
        if (
            self.null.max_improvement(beside).p_value(float(promises.max(initial=0.0)))
            > self.rules.extra_cause_rate
        ):
            return
        guesses = beside.amplitudes(linear.z)
        for k in _best_of_each(beside, promises, self.rules.max_triples[1]):
            if not worth_fitting(self.baseline, pair.fit.chi2, float(promises[k]), self.rules):
                break
            self._confirm(pair, {**pair.fit.state.amplitudes, beside.candidates[k]: float(guesses[k])})
        # the best pair may stand for three others: all triples are compared at its state
        alone = screen(linear, self.model.effects)
        target = linear.z - linear.columns[:, : len(pair.candidates)] @ _values(pair)
        for three in best_triples(alone, target, count=self.rules.max_triples[1]):
            guess, squares = _linear_fit(alone, linear.columns[:, three], target)
            if worth_fitting(self.baseline, pair.fit.chi2, pair.fit.chi2 - squares, self.rules):
                self._confirm(pair, {linear.candidates[k]: g for k, g in zip(three, guess, strict=True)})

    def replace_in(self, three: Explanation) -> bool:
        """Confirm triples with one cause replaced by another effect, position or scope.

        Returns True if one of them has a better score than `three`.
        """
        self.on_progress(f"looking for equivalents of {three.fit.label}")
        count, best = len(three.candidates), three.score
        linear = self._linear(three)
        for k, out in enumerate(three.candidates):
            kept = [j for j in range(count) if j != k]
            there = {three.candidates[j].effect for j in kept}
            free = [j for j, c in enumerate(linear.candidates) if j >= count and c.effect not in there]
            without = replace(
                linear,
                by_u=np.column_stack([linear.by_u, linear.columns[:, kept]]),
                columns=linear.columns[:, free],
                candidates=tuple(linear.candidates[j] for j in free),
            )
            beside = screen(without, self.model.effects)
            target = linear.z - linear.columns[:, k] * three.fit.state.amplitudes[out]
            promises = np.where(beside.sizes > 0.0, beside.penalised(target), 0.0)
            value, sd = three.fit.amplitude(out)
            own = (value / sd) ** 2 - multiplicity_penalty(out)
            same = np.array([c.effect == out.effect for c in beside.candidates], dtype=bool)
            promises[promises < np.where(same, own, min(HOPELESS * own, own - FAR))] = 0.0
            guesses = beside.amplitudes(target)
            for j in _best_of_each(beside, promises, STAND_INS):
                others = {c: a for c, a in three.fit.state.amplitudes.items() if c != out}
                self._confirm(three, {**others, beside.candidates[j]: float(guesses[j])})
        return min(e.score for e in self.found) < best

    def _linear(self, held: Explanation) -> Linearisation:
        """Linearisation at an explanation: columns of its causes, then of all other candidates."""
        others = tuple(c for c in self.model.candidates if c not in held.candidates)
        return self.model.linearise(held.fit.state, (*held.candidates, *others))

    def _confirm(self, start: Explanation, guess: dict[Candidate, float]) -> None:
        if frozenset(guess) in self._tried:
            return
        self._tried.add(frozenset(guess))
        self.on_progress(f"confirming {' + '.join(c.label for c in guess)}")
        three = explain(self.model, start.fit, tuple(guess), list(guess.values()), self.null)
        if three is not None and inside_bounds(self.model, three) and self._all_needed(three):
            self.found.append(three)

    def _all_needed(self, three: Explanation) -> bool:
        """True if each amplitude is significant at the level `Rules.extra_cause_rate` (Wald test)."""
        least = chdtri(1, self.rules.extra_cause_rate)
        parts = [three.fit.amplitude(c) for c in three.candidates]
        return all(value**2 >= least * sd**2 for value, sd in parts)


def _values(found: Explanation) -> Array:
    """Amplitudes of an explanation, in the order of its candidates, shape (c,)."""
    return np.array([found.fit.state.amplitudes[c] for c in found.candidates])


def _best_of_each(screened: Screen, promises: Array, count: int) -> list[int]:
    """Indices of the candidates with the largest positive promise, one for each of up to `count` effects."""
    found: dict[str, int] = {}
    for k in np.argsort(-promises):
        if promises[k] > 0.0 and len(found) < count:
            found.setdefault(screened.candidates[k].effect, int(k))
    return list(found.values())


def best_pairs(screened: Screen, z: Array, *, count: int) -> list[tuple[int, int]]:
    """Pairs of candidates (by index) with the largest penalised improvement of chi-square, best first.

    The two candidates are of different effects; of each pair of effects the best pair of candidates is taken.
    """
    score = screened.directions.T @ z
    cosine = screened.directions.T @ screened.directions
    a, b = np.triu_indices(len(score), 1)
    names = np.array([c.effect for c in screened.candidates])
    sound = (np.abs(cosine[a, b]) < ALIKE) & (screened.sizes[a] > 0) & (screened.sizes[b] > 0)
    sound &= names[a] != names[b]
    a, b = a[sound], b[sound]
    c = cosine[a, b]
    first = (score[a] - c * score[b]) / (1.0 - c**2)  # minus the amplitudes, in directions of unit length
    second = (score[b] - c * score[a]) / (1.0 - c**2)
    forbidden = (screened.upwards[a] & (first > 0.0)) | (screened.upwards[b] & (second > 0.0))
    improvement = (score[a] ** 2 + score[b] ** 2 - 2.0 * c * score[a] * score[b]) / (1.0 - c**2)
    improvement = np.where(forbidden, 0.0, improvement)
    penalties = np.array([multiplicity_penalty(k) for k in screened.candidates])
    found: list[tuple[int, int]] = []
    seen: set[frozenset[str]] = set()
    for k in np.argsort(-(improvement - penalties[a] - penalties[b])):
        pair = frozenset((str(names[a[k]]), str(names[b[k]])))
        if pair not in seen:
            seen.add(pair)
            found.append((int(a[k]), int(b[k])))
            if len(found) == count:
                break
    return found


def best_triples(screened: Screen, z: Array, *, count: int) -> list[tuple[int, int, int]]:
    """Triples of candidates (by index) with the largest penalised improvement of chi-square, best first.

    As `best_pairs`; all triples are compared, with the first candidate projected out of the other two.
    """
    used = np.flatnonzero(screened.sizes > 0.0)
    directions = screened.directions[:, used]
    score, cosine = directions.T @ z, directions.T @ directions
    penalties = np.array([multiplicity_penalty(screened.candidates[k]) for k in used])
    improvements, threes = [np.zeros(0)], [np.zeros((0, 3), dtype=int)]
    for first in range(len(used) - 2):
        rest = np.arange(first + 1, len(used))
        along = cosine[first, rest]
        rest, along = rest[np.abs(along) < ALIKE], along[np.abs(along) < ALIKE]
        size = np.sqrt(1.0 - along**2)
        left = (score[rest] - along * score[first]) / size
        between = (cosine[np.ix_(rest, rest)] - np.outer(along, along)) / np.outer(size, size)
        b, c = np.triu_indices(len(rest), 1)
        apart = np.abs(between[b, c]) < ALIKE
        b, c = b[apart], c[apart]
        both = left[b] ** 2 + left[c] ** 2 - 2.0 * between[b, c] * left[b] * left[c]
        improvement = score[first] ** 2 + both / (1.0 - between[b, c] ** 2)
        improvement -= penalties[first] + penalties[rest[b]] + penalties[rest[c]]
        most = np.argsort(-improvement)[:KEPT]
        improvements.append(improvement[most])
        threes.append(np.column_stack([np.full(len(most), first), rest[b[most]], rest[c[most]]]))
    ordered = np.concatenate(threes)[np.argsort(-np.concatenate(improvements))]
    found: list[tuple[int, int, int]] = []
    seen: set[frozenset[str]] = set()
    for three in ordered:
        names = frozenset(screened.candidates[k].effect for k in used[three])
        amplitudes = -np.linalg.solve(cosine[np.ix_(three, three)], score[three])
        if len(names) < 3 or names in seen or (screened.upwards[used[three]] & (amplitudes < 0.0)).any():
            continue
        seen.add(names)
        found.append((int(used[three[0]]), int(used[three[1]]), int(used[three[2]])))
        if len(found) == count:
            break
    return found
