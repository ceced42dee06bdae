"""Three causes at once: looked for only where two are better than one, and one more gains what noise would
not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation, Names, explain
from calibration.diagnosis.nested import Linear, Nested
from calibration.diagnosis.null import Null
from calibration.diagnosis.pairs import best_threes
from calibration.diagnosis.rules import Rules, Tell
from calibration.diagnosis.screening import Screen, screen, worth
from calibration.diagnosis.several import all_there

Array = NDArray[np.float64]

HOPELESS, FAR = 0.35, 40.0  # a stand-in that promises less than this part, and so much less, is not fitted
STAND_INS = 2  # of other effects that are fitted in the place of each of three
ROUNDS = 3  # of stand-ins, each beside the best three that there are


def with_third(
    model: Nested, pairs: Sequence[Explanation], null: Null, rules: Rules, tell: Tell
) -> list[Explanation]:
    """Sets of three of which all are needed: one more beside the best pairs, where it gains what noise would
    not, or three others that promise more. Then others are tried in the place of each, so that a name that
    would do as well is not left out."""
    threes = _Threes(model, null, rules, tell)
    beside: list[Names] = []
    for pair in sorted(pairs, key=lambda e: e.score):
        if pair.names not in beside and len(beside) < rules.beside[0]:
            beside.append(pair.names)
            threes.add_to(pair)
    for _ in range(ROUNDS):
        best = min(threes.found, key=lambda e: e.score, default=None)
        if best is None or not threes.replace_in(best):
            break
    return threes.found


class _Threes:
    """What has been tried of three causes, and what was found. found: sets of which all three are needed."""

    def __init__(self, model: Nested, null: Null, rules: Rules, tell: Tell) -> None:
        self.model, self.null, self.rules, self.tell = model, null, rules, tell
        self.found: list[Explanation] = []
        self._tried: set[frozenset[Candidate]] = set()

    def add_to(self, pair: Explanation) -> None:
        """A third cause beside two, where one gains what noise would not."""
        self.tell(f"looking for a third cause beside {pair.fit.reports()}")
        linear = self._linear(pair)
        beside = screen(linear, self.model.effects, held=pair.fit)
        # an effect that is there already has its place, or its scope: the scene holds one
        free = np.array([c.effect not in pair.names for c in linear.candidates]) & (beside.sizes > 0.0)
        promises = np.where(free, beside.promises(linear.z), 0.0)
        if self.null.gains(beside).chance(float(promises.max(initial=0.0))) > self.rules.second:
            return
        guesses = beside.amplitudes(linear.z)
        for k in _best_of_each(beside, promises, self.rules.beside[1]):
            self._confirm(pair, {**pair.fit.state.amplitudes, beside.candidates[k]: float(guesses[k])})
        # the best pair may be a mixture of three others: these are sought afresh, around where it leads
        alone = screen(linear, self.model.effects)
        target = linear.z - linear.columns[:, : len(pair.candidates)] @ _values(pair)
        for three in best_threes(alone, target, count=self.rules.beside[1]):
            columns = linear.columns[:, three] - alone.free @ (alone.free.T @ linear.columns[:, three])
            guess = -np.linalg.lstsq(columns, target, rcond=None)[0]
            self._confirm(pair, {linear.candidates[k]: float(g) for k, g in zip(three, guess, strict=True)})

    def replace_in(self, three: Explanation) -> bool:
        """Others in the place of each of three causes, and the same elsewhere; whether one that had not been
        tried is better."""
        self.tell(f"looking for what would do as well as {three.fit.reports()}")
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
            promises = np.where(beside.sizes > 0.0, beside.promises(target), 0.0)
            value, sd = three.fit.amplitude(out)
            own = (value / sd) ** 2 - worth(out)
            same = np.array([c.effect == out.effect for c in beside.candidates], dtype=bool)
            promises[promises < np.where(same, own, min(HOPELESS * own, own - FAR))] = 0.0
            guesses = beside.amplitudes(target)
            for j in _best_of_each(beside, promises, STAND_INS):
                others = {c: a for c, a in three.fit.state.amplitudes.items() if c != out}
                self._confirm(three, {**others, beside.candidates[j]: float(guesses[j])})
        return min(e.score for e in self.found) < best

    def _linear(self, held: Explanation) -> Linear:
        """Columns of its causes, then of all others."""
        others = tuple(c for c in self.model.candidates if c not in held.candidates)
        return self.model.linearise(held.fit.state, (*held.candidates, *others))

    def _confirm(self, start: Explanation, guess: dict[Candidate, float]) -> None:
        if frozenset(guess) in self._tried:
            return
        self._tried.add(frozenset(guess))
        self.tell(f"confirming {' + '.join(c.label for c in guess)}")
        three = explain(self.model, start.fit, tuple(guess), list(guess.values()), self.null)
        if three is not None and all_there(self.model, three) and self._all_needed(three):
            self.found.append(three)

    def _all_needed(self, three: Explanation) -> bool:
        """Whether without any one of the causes the fit would be worse by more than noise does."""
        least = chi2.isf(self.rules.second, 1)
        parts = [three.fit.amplitude(c) for c in three.candidates]
        return all(value**2 >= least * sd**2 for value, sd in parts)


def _values(found: Explanation) -> Array:
    """Amplitudes of its causes, in their order."""
    return np.array([found.fit.state.amplitudes[c] for c in found.candidates])


def _best_of_each(screened: Screen, promises: Array, count: int) -> list[int]:
    """Candidates with the largest promise, of each effect one."""
    found: dict[str, int] = {}
    for k in np.argsort(-promises):
        if promises[k] > 0.0 and len(found) < count:
            found.setdefault(screened.candidates[k].effect, int(k))
    return list(found.values())
