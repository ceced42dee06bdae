"""The search for causes: calibrate the baseline, screen, confirm in the simulator, and say what is known."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Candidate, Effect
from calibration.diagnosis.explanation import Explanation, Names, confidence, explain, rivals
from calibration.diagnosis.fitting import Fit, fit
from calibration.diagnosis.nested import Nested, State
from calibration.diagnosis.null import Departure, Null
from calibration.diagnosis.places import settled
from calibration.diagnosis.rules import Rules, Tell
from calibration.diagnosis.screening import Screen, screen
from calibration.diagnosis.several import hiding_each_other, with_second
from calibration.diagnosis.thirds import with_third

Array = NDArray[np.float64]
HOPELESS = 0.35  # of the best promise: a candidate that promises less is not fitted
PLACED = 3  # pairs, and threes, of which a cause is moved to where it sits: the best
FAR = 0.05  # of ln G: what was taken so far from the fit's end is taken anew
Verdict = Literal["none", "found", "ambiguous", "unexplained"]


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
    most = min(rules.most, model.most_causes)
    if most < 2:
        pairs = []
    elif chance <= rules.alarm:
        tell(f"looking for a second cause beside {singles[0].fit.reports()}")
        pairs = with_second(model, singles[0], screened, linear.columns, null, rules, tell)
    else:
        tell("looking for two causes that hide each other")
        pairs = hiding_each_other(model, baseline, screened, linear, null, rules, tell)
    where = set(moved.values())
    pairs, again = _placed(model, pairs, _unsettled(pairs, where)[:PLACED], null, tell)
    both = sorted(singles + pairs, key=lambda e: e.score)
    if most > 2 and pairs and both[0] in pairs:
        three = with_third(model, pairs, null, rules, tell)
        three, _ = _placed(model, three, _unsettled(three, where | set(again.values()))[:PLACED], null, tell)
        both = sorted(both + three, key=lambda e: e.score)
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


def _unsettled(explanations: Sequence[Explanation], where: Collection[Candidate]) -> list[Explanation]:
    """Those with a cause that has not been moved to where it sits, best first."""
    some = [e for e in explanations if any(c.place is not None and c not in where for c in e.candidates)]
    return sorted(some, key=lambda e: e.score)


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
