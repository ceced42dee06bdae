"""The search for causes: fit the baseline, screen, confirm in the simulator, and reach a verdict."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.explain import explain, ranked_first
from calibration.diagnosis.engine.explanation import Explanation, Names, equivalent_explanations
from calibration.diagnosis.engine.fitting import AS_FITTED, Fit, fit
from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.multi_cause import hiding_each_other, with_second, with_third
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.positions import at_best_position
from calibration.diagnosis.engine.rules import Rules
from calibration.diagnosis.engine.screening import Screen, screen
from calibration.measurements._effect import Candidate, EffectModel
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State
from calibration.progress import OnMessage

Array = NDArray[np.float64]
HOPELESS = 0.35  # of the best candidate's improvement: one that promises less is not fitted
POSITIONED = 3  # pairs, and triples, whose causes are moved to their best position: the best ones
FAR = 0.05  # of ln G: nuisances that were taken so far from the end of the fit are taken again
Verdict = Literal["none", "found", "ambiguous", "partly explained", "unexplained"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Finding:
    """Result of a search.

    Attributes
    ----------
    verdict : none, found, ambiguous (several equivalent explanations), partly explained (`partly.py`; a
        search alone calls that unexplained) or unexplained.
    baseline : fit of the baseline.
    lack_of_fit : test of the baseline's residuals.
    p_value : probability that noise alone gives the best candidate its improvement.
    screened : all candidates at the baseline.
    null : noise draws that all tests share.
    explanations : all that were confirmed in the simulator, best first.
    equivalent : sets of effects that the data cannot separate, the chosen one first.
    confidence : probability that the chosen set is ranked first under new noise; for a partial explanation,
        fraction of the bootstrap replicates in which no other set of as many causes removes more misfit.
    dominant : the explanation that is named if the data are partly explained.
    doubt : reason why an explanation that leaves only noise is downgraded to partly explained or not named.
    """

    verdict: Verdict
    baseline: Fit
    lack_of_fit: LackOfFit
    p_value: float
    screened: Screen
    null: Null
    explanations: tuple[Explanation, ...] = ()
    equivalent: tuple[Names, ...] = field(default=())
    confidence: float = 0.0
    dominant: Explanation | None = None
    doubt: str = ""

    @property
    def chosen(self) -> Explanation | None:
        """Explanation that the verdict names first; None if it names none."""
        if self.verdict == "partly explained":
            return self.dominant
        return self.explanations[0] if self.verdict in ("found", "ambiguous") else None

    @property
    def certain(self) -> Names:
        """Effects common to all equivalent sets, which the data therefore determine."""
        first = self.equivalent[0] if self.equivalent else ()
        return tuple(name for name in first if all(name in names for names in self.equivalent))


def search(
    model: MeasurementModel,
    *,
    rules: Rules | None = None,
    before: Finding | None = None,
    on_progress: OnMessage = lambda _: None,
) -> Finding:
    """Search for the effects that a model lacks.

    Parameters
    ----------
    model : measurements of one kind, with effects.
    rules : significance levels and limits; None for the defaults.
    before : result for the same measurements with a smaller catalogue, whose converged fits are reused.
    on_progress : called with a sentence at each step.

    Raises
    ------
    ValueError : the baseline has no solution anywhere.
    """
    rules = rules or Rules()
    on_progress("fitting the baseline")
    baseline = fit_baseline(model)
    on_progress(f"screening {len(model.candidates)} candidates")
    linear = model.linearise(baseline.state, model.candidates)
    screened = screen(linear, model.effects)
    null = (
        before.null
        if before is not None and _same(before.baseline, baseline)
        else Null.of(model, len(linear.z), seed=rules.seed)
    )
    lack_of_fit = null.lack_of_fit(linear.z, linear.by_u)
    improvement = null.max_improvement(screened)
    singles: list[Explanation] = []
    likely = _shortlist(
        screened, model.effects, linear.z, rules.max_confirmed, at_least=0.5 * improvement.threshold(0.05)
    )
    for n, k in enumerate(likely):
        c = screened.candidates[k]
        on_progress(f"confirming {n + 1} of {len(likely)}: {c.label}")
        found = explain(model, baseline, (c,), [float(screened.amplitudes(linear.z)[k])], null)
        if found is not None:
            singles.append(found)
    enough = baseline.chi2 - improvement.threshold(rules.false_alarm_rate)
    singles, moved = _positioned(
        model, singles, [e for e in singles if e.fit.chi2 < enough], null, on_progress
    )
    # a second cause is sought beside the first at its best position
    screened = replace(screened, candidates=tuple(moved.get(c, c) for c in screened.candidates))
    best = max((baseline.chi2 - e.fit.chi2 - e.multiplicity_penalty for e in singles), default=0.0)
    p_value = improvement.p_value(best)

    def finding(
        verdict: Verdict, explanations: Sequence[Explanation], sets: tuple[Names, ...] = (), sure: float = 0.0
    ) -> Finding:
        return Finding(
            verdict=verdict,
            baseline=baseline,
            lack_of_fit=lack_of_fit,
            p_value=p_value,
            screened=screened,
            null=null,
            explanations=tuple(explanations),
            equivalent=sets,
            confidence=sure,
        )

    if p_value > rules.false_alarm_rate and lack_of_fit.p_value >= rules.lack_of_fit_level:
        return finding("none", singles)
    most = min(rules.max_causes, model.max_causes)
    if most < 2:
        pairs = []
    elif p_value <= rules.false_alarm_rate:
        on_progress(f"looking for a second cause beside {singles[0].fit.label}")
        pairs = with_second(model, baseline, singles[0], screened, linear.columns, null, rules, on_progress)
    else:
        on_progress("looking for two causes that hide each other")
        pairs = hiding_each_other(model, baseline, screened, linear, null, rules, on_progress)
    where = set(moved.values())
    pairs, again = _positioned(model, pairs, _unpositioned(pairs, where)[:POSITIONED], null, on_progress)
    both = sorted(singles + pairs, key=lambda e: e.score)
    if most > 2 and pairs and both[0] in pairs:
        three = with_third(model, baseline, pairs, null, rules, on_progress)
        three, _ = _positioned(
            model, three, _unpositioned(three, where | set(again.values()))[:POSITIONED], null, on_progress
        )
        both = sorted(both + three, key=lambda e: e.score)
    if (p_value > rules.false_alarm_rate and not pairs) or both[
        0
    ].lack_of_fit.p_value < rules.lack_of_fit_level:
        return finding("unexplained", both)
    first = ranked_first(both, null)
    sets = equivalent_explanations(both, rules.score_tolerance, first, rules.first_fraction)
    return finding("found" if len(sets) == 1 else "ambiguous", both, sets, first.get(sets[0], 0.0))


def fit_baseline(model: MeasurementModel) -> Fit:
    """Fit the baseline to the tolerance `AS_FITTED`, with nuisances estimated at its end."""
    start = State(u=model.start())
    model.update_nuisances(start, rough=True)
    found = fit(model, start)
    for _ in range(3):
        model.update_nuisances(found.state)
        again = fit(model, found.state, tolerance=AS_FITTED)
        moved = np.abs(again.state.u - found.state.u).max(initial=0.0)
        found = again
        if moved < FAR:
            break
    return found


def _same(before: Fit, now: Fit) -> bool:
    """True if two baseline fits have equal Jacobians and residuals of equal shape."""
    return before.z.shape == now.z.shape and np.array_equal(before.jacobian, now.jacobian)


def _unpositioned(explanations: Sequence[Explanation], where: Collection[Candidate]) -> list[Explanation]:
    """Explanations with a cause whose position has not been optimised, best first."""
    some = [e for e in explanations if any(c.position is not None and c not in where for c in e.candidates)]
    return sorted(some, key=lambda e: e.score)


def _positioned(
    model: MeasurementModel,
    explanations: Sequence[Explanation],
    some: Sequence[Explanation],
    null: Null,
    on_progress: OnMessage,
) -> tuple[list[Explanation], dict[Candidate, Candidate]]:
    """Optimise the positions of causes in the explanations `some`.

    Returns all explanations, best first, and a map from each cause to the cause at its best position.
    """
    found: list[Explanation] = []
    moved: dict[Candidate, Candidate] = {}
    for e in explanations:
        if e in some and any(c.position is not None for c in e.candidates):
            on_progress(f"looking for the best position: {e.fit.label}")
            there = at_best_position(model, e, null)
            moved |= dict(zip(e.candidates, there.candidates, strict=True))
            found.append(there)
        else:
            found.append(e)
    return sorted(found, key=lambda e: e.score), moved


def _shortlist(
    screened: Screen, effects: Mapping[str, EffectModel], z: Array, count: int, *, at_least: float
) -> list[int]:
    """Indices of candidates to fit, best first.

    At most two candidates of each effect are taken, the second if its expected improvement is within 8 of the
    first. Candidates whose fit requires simulations are skipped if they fall so far short of the best that
    non-linearity cannot compensate.
    """
    expected = screened.penalised(z)
    hopeless = min(HOPELESS * expected.max(initial=0.0), expected.max(initial=0.0) - 40.0)
    found: list[int] = []
    for k in np.argsort(-expected):
        name = screened.candidates[k].effect
        same = [j for j in found if screened.candidates[j].effect == name]
        near = len(same) < 2 and expected[k] > expected[same[0]] - 8.0 if same else True
        least = max(at_least, hopeless) if effects[name].simulated else at_least
        if expected[k] >= least and near and len(found) < count:
            found.append(int(k))
    return found
