"""The search for causes: calibrate the baseline, screen, confirm in the simulator, and say what is known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from calibration.diagnosis.effect import Candidate, Effect
from calibration.diagnosis.explanation import Explanation, Names, confidence, explain, rivals
from calibration.diagnosis.fitting import Fit, fit
from calibration.diagnosis.nested import Linear, Nested, State
from calibration.diagnosis.null import Departure, Null
from calibration.diagnosis.pairs import best_pairs
from calibration.diagnosis.places import settled
from calibration.diagnosis.screening import Screen, screen

Array = NDArray[np.float64]
PERHAPS = 0.1  # chance of a second cause by the baseline's columns, below which it is looked for properly
HOPELESS = 0.35  # of the best promise: a candidate that promises less is not fitted
PLACED = 3  # pairs of which a cause is moved to where it sits: the best
FAR = 0.05  # of ln G: what was taken so far from the fit's end is taken anew
Verdict = Literal["none", "found", "ambiguous", "unexplained"]
Tell = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class Rules:
    """alarm: chance of naming a cause where there is none; second: of one cause too many.
    unlike: chance below which what a fit leaves of the residuals counts as unexplained.
    within: of chi-square: what explains the data nearly as well as the best is a rival.
    shortlist: effects that are confirmed in the simulator; pairs: pairs of them.
    seed: of the bootstrap.
    """

    alarm: float = 0.02
    second: float = 0.003
    unlike: float = 0.005
    within: float = 6.0
    shortlist: int = 7
    pairs: int = 5
    seed: int = 0


@dataclass(frozen=True, eq=False, kw_only=True)
class Finding:
    """What is known after a search.

    baseline: its fit; departure: of its residuals from noise; chance: that noise alone gives the best
    candidate its improvement. screened: all candidates at the baseline.
    explanations: all that were confirmed in the simulator, best first. rivals: the sets of effects that the
    data cannot tell apart, the chosen one first; confidence: how often it would be ranked first again.
    """

    verdict: Verdict
    baseline: Fit
    departure: Departure
    chance: float
    screened: Screen
    null: Null
    explanations: tuple[Explanation, ...] = ()
    rivals: tuple[Names, ...] = field(default=())
    confidence: float = 0.0

    @property
    def chosen(self) -> Explanation | None:
        """What the verdict names first; None where it names nothing."""
        return self.explanations[0] if self.verdict in ("found", "ambiguous") else None


def search(model: Nested, *, rules: Rules | None = None, tell: Tell = lambda _: None) -> Finding:
    """Look for what a model lacks. ValueError where the baseline has no answer anywhere."""
    rules = rules or Rules()
    tell("calibrating the baseline")
    baseline = calibrated(model)
    tell(f"screening {len(model.candidates)} candidates")
    linear = model.linearise(baseline.state, model.candidates)
    screened = screen(linear, model.effects)
    null = Null(len(linear.z), model.patterns(), seed=rules.seed)
    departure = null.departure(linear.z, linear.by_u)
    gains = null.gains(screened)
    singles: list[Explanation] = []
    likely = _shortlist(
        screened, model.effects, linear.z, rules.shortlist, at_least=0.5 * gains.threshold(0.05)
    )
    for n, k in enumerate(likely):
        c = screened.candidates[k]
        tell(f"confirming {n + 1} of {len(likely)}: {c.label}")
        found = explain(model, baseline, (c,), [float(screened.amplitudes(linear.z)[k])], null)
        if found is not None:
            singles.append(found)
    enough = baseline.chi2 - gains.threshold(rules.alarm)
    singles, moved = _placed(model, singles, [e for e in singles if e.fit.chi2 < enough], null, tell)
    # a second cause is sought beside the first where that sits
    screened = replace(screened, candidates=tuple(moved.get(c, c) for c in screened.candidates))
    gain = max((baseline.chi2 - e.fit.chi2 - e.choice for e in singles), default=0.0)
    chance = gains.chance(gain)

    def finding(verdict: Verdict, explanations: Sequence[Explanation], named: bool) -> Finding:
        return Finding(
            verdict=verdict,
            baseline=baseline,
            departure=departure,
            chance=chance,
            screened=screened,
            null=null,
            explanations=tuple(explanations),
            rivals=rivals(explanations, rules.within) if named else (),
            confidence=confidence(explanations, null) if named else 0.0,
        )

    if chance > rules.alarm and departure.p >= rules.unlike:
        return finding("none", singles, False)
    if chance <= rules.alarm:
        tell(f"looking for a second cause beside {singles[0].fit.reports()}")
        pairs = _with_second(model, singles[0], screened, linear.columns, null, rules, tell)
    else:
        tell("looking for two causes that hide each other")
        pairs = _hidden(model, baseline, screened, linear, null, rules, tell)
    where = set(moved.values())
    loose = [e for e in pairs if any(c.place is not None and c not in where for c in e.candidates)]
    pairs, _ = _placed(model, pairs, sorted(loose, key=lambda e: e.score)[:PLACED], null, tell)
    both = sorted(singles + pairs, key=lambda e: e.score)
    if (chance > rules.alarm and not pairs) or both[0].departure.p < rules.unlike:
        return finding("unexplained", both, False)
    sets = rivals(both, rules.within)
    return finding("found" if len(sets) == 1 else "ambiguous", both, True)


def calibrated(model: Nested) -> Fit:
    """The baseline's fit, with nuisances taken where it ends."""
    start = State(u=model.start())
    model.retake(start, rough=True)
    found = fit(model, start)
    for _ in range(3):
        model.retake(found.state)
        again = fit(model, found.state)
        moved = np.abs(again.state.u - found.state.u).max(initial=0.0)
        found = again
        if moved < FAR:
            break
    return found


def _placed(
    model: Nested, explanations: Sequence[Explanation], some: Sequence[Explanation], null: Null, tell: Tell
) -> tuple[list[Explanation], dict[Candidate, Candidate]]:
    """All explanations, best first, causes of some of them moved to where they sit; and what moved where."""
    found: list[Explanation] = []
    moved: dict[Candidate, Candidate] = {}
    for e in explanations:
        if e in some and any(c.place is not None for c in e.candidates):
            tell(f"looking where it sits: {e.fit.reports()}")
            there = settled(model, e, null)
            moved |= dict(zip(e.candidates, there.candidates, strict=True))
            found.append(there)
        else:
            found.append(e)
    return sorted(found, key=lambda e: e.score), moved


def _shortlist(
    screened: Screen, effects: Mapping[str, Effect], z: Array, count: int, *, at_least: float
) -> list[int]:
    """Candidates worth a fit, best first: of each effect the best one, and one more that comes near it; of
    those whose fit costs simulations none that promises far less than the best, more than what is not linear
    could mend."""
    gains = screened.promises(z)
    hopeless = min(HOPELESS * gains.max(initial=0.0), gains.max(initial=0.0) - 40.0)
    found: list[int] = []
    for k in np.argsort(-gains):
        name = screened.candidates[k].effect
        same = [j for j in found if screened.candidates[j].effect == name]
        near = len(same) < 2 and gains[k] > gains[same[0]] - 8.0 if same else True
        least = max(at_least, hopeless) if effects[name].simulated else at_least
        if gains[k] >= least and near and len(found) < count:
            found.append(int(k))
    return found


def _with_second(
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


def _hidden(
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
    """The pairs that promise most for the residuals `target`, confirmed; none of which one amplitude ended at
    a bound, since that is no pair."""
    found = []
    pairs = best_pairs(screened, target, count=rules.pairs)
    for n, (a, b) in enumerate(pairs):
        both = (screened.candidates[a], screened.candidates[b])
        tell(f"confirming pair {n + 1} of {len(pairs)}: {both[0].label} + {both[1].label}")
        left = columns[:, [a, b]] - screened.free @ (screened.free.T @ columns[:, [a, b]])
        guess = [float(x) for x in -np.linalg.lstsq(left, target, rcond=None)[0]]
        pair = explain(model, start, both, guess, null)
        if pair is not None and not any(
            x in model.effects[c.effect].bounds for c, x in pair.fit.state.amplitudes.items()
        ):
            found.append(pair)
    return found
