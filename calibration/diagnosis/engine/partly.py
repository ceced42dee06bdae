"""Partial explanations: causes that may be named although every explanation leaves more than noise.

Real measurements rarely pass a test that only noise is left. The smallest set of causes that removes most of
the explainable misfit is then named if

1. it removes at least two fifths of the misfit, and at least a tenth in 95 % of the bootstrap replicates over
   specimens, tests or segments of records;
2. it predicts every held-out fold better than the baseline does, or significantly many of them, and its
   held-out skill over all folds is at least two fifths;
3. its amplitudes do not depend on the fold that is left out, and are not at a bound, physical limits aside.

Other sets of as many causes or fewer that remove about as much misfit are named as alternatives. Thresholds
are in `rules.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from calibration.diagnosis.engine.explanation import Explanation, Names
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.held_out import HeldOut, Predictions, held_out_improvement
from calibration.diagnosis.engine.multi_cause import inside_bounds
from calibration.diagnosis.engine.remainder import relative_rms
from calibration.diagnosis.engine.rules import Rules
from calibration.diagnosis.engine.shares import Interval, Misfit, Shares
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise_known import NoiseKnown
from calibration.progress import OnMessage

EACH = 2  # sets of each number of causes that are tried


@dataclass(frozen=True, eq=False, kw_only=True)
class Assessed:
    """An explanation assessed as a partial explanation.

    Attributes
    ----------
    share : fraction of the explainable misfit that it removes.
    at_least : fraction that it removes in at least `Rules.replicate_level` of the replicates; -inf with a
        single group.
    alternatives : other sets of effects that remove about as much, with their fractions.
    held_out : held-out scores; None if not computed.
    against : reasons why it is not named, a clause each; () if it may be named.
    confidence : fraction of the replicates in which no other set of as many causes removes more.
    """

    explanation: Explanation
    share: Interval
    at_least: float
    alternatives: tuple[tuple[Names, Interval], ...] = ()
    held_out: HeldOut | None = None
    against: tuple[str, ...] = field(default=())
    confidence: float = 0.0


def assess(
    model: MeasurementModel,
    baseline: Fit,
    explanations: Sequence[Explanation],
    shares: Shares,
    rules: Rules,
    noise: NoiseKnown,
    *,
    on_progress: OnMessage = lambda _: None,
) -> Assessed | None:
    """Find an explanation that may be named as a partial explanation.

    Parameters
    ----------
    baseline : fit of the baseline.
    explanations : those confirmed in the simulator by a search with the verdict "unexplained".
    shares : bootstrap of the explained fractions.

    Returns
    -------
    The first explanation that may be named among the `Rules.tries` that are tried. If there is none, the one
    that was tried first, with reasons in `against`. None if there are no explanations or no misfit.
    """
    if not explanations or not shares.baseline.value > 0.0:
        return None
    found = [(e, shares.misfit(e.fit)) for e in explanations]
    sound = [(e, m) for e, m in found if inside_bounds(model, e)]
    left = _best_of_each_number(sound or found)
    first: Assessed | None = None
    known: Predictions = {}
    for _ in range(min(rules.max_held_out, len(left))):
        explanation, misfit = left.pop(_dominant(left, shares, rules))
        on_progress(f"predicting held-out measurements: {explanation.fit.label}")
        held_out = held_out_improvement(model, baseline, explanation.fit, known=known)
        judged = _judge(model, baseline, explanation, misfit, held_out, sound, shares, rules, noise)
        if not judged.against:
            return judged
        first = first or judged
    return first


def within_smooth_error(model: MeasurementModel, baseline: Fit, noise: NoiseKnown, rules: Rules) -> bool:
    """True if the baseline's misfit is within an unstated smooth error (`Rules.smooth_error_fraction`).

    False if the noise is known or records have no full scale.
    """
    part = None if noise.known else relative_rms(model, baseline)
    return part is not None and part < rules.smooth_error_fraction


def _best_of_each_number(found: Sequence[tuple[Explanation, Misfit]]) -> list[tuple[Explanation, Misfit]]:
    """For each number of causes the `EACH` sets of effects that remove most, ordered by what they leave."""
    best: dict[int, list[Names]] = {}
    kept = []
    for e, m in sorted(found, key=lambda pair: pair[1].value):
        own = best.setdefault(len(e.names), [])
        if len(own) < EACH and e.names not in own:
            own.append(e.names)
            kept.append((e, m))
    return kept


def _dominant(left: Sequence[tuple[Explanation, Misfit]], shares: Shares, rules: Rules) -> int:
    """Index of the explanation to try next.

    It is the best one with the smallest number of causes to which further causes each add less than
    `Rules.further_share`. It is determined again after a rejection, without the rejected explanation, which
    is no argument against a set of more causes.
    """
    best: dict[int, int] = {}
    for k, (e, _) in enumerate(left):
        best.setdefault(len(e.names), k)
    smallest, *more = sorted(best)
    chosen = smallest
    for size in more:
        gained = shares.share(left[best[size]][1]).value - shares.share(left[best[chosen]][1]).value
        if gained >= rules.further_share * (size - chosen):
            chosen = size
    return best[chosen]


def _judge(
    model: MeasurementModel,
    baseline: Fit,
    explanation: Explanation,
    misfit: Misfit,
    held_out: HeldOut,
    sound: Sequence[tuple[Explanation, Misfit]],
    shares: Shares,
    rules: Rules,
    noise: NoiseKnown,
) -> Assessed:
    share = shares.share(misfit)
    drawn = shares.drawn(misfit)
    at_least = float(np.quantile(drawn, 1.0 - rules.replicate_level)) if shares.groups.count > 1 else -np.inf
    at_least = min(at_least, share.value)
    against = []
    if not inside_bounds(model, explanation):
        against.append("an amplitude is at its bound")
    if share.value < rules.least_share:
        against.append(f"it explains less than {100.0 * rules.least_share:.0f} % of the misfit beyond noise")
    elif at_least < rules.least_share_low:
        against.append(
            f"over {shares.groups.over} its explained fraction is not reliably"
            f" {100.0 * rules.least_share_low:.0f} % or more"
        )
    if within_smooth_error(model, baseline, noise, rules):
        part = relative_rms(model, baseline) or 0.0
        size = f"{100.0 * part:.2g} % of full scale" if part > 0.0 else "no larger than the estimated noise"
        against.append(f"the misfit is {size}, which a smooth unstated error may have")
    against += _held_out(held_out, explanation, at_least, rules)
    others = [
        shares.drawn(m)
        for e, m in sound
        if e.names != explanation.names and len(e.names) == len(explanation.names)
    ]
    first = np.mean(np.all([drawn >= o for o in others], axis=0)) if others else 1.0
    return Assessed(
        explanation=explanation,
        share=share,
        at_least=at_least,
        confidence=float(first),
        alternatives=_alternatives(explanation, share, drawn, sound, shares, rules),
        held_out=held_out,
        against=tuple(against),
    )


def _held_out(held_out: HeldOut, explanation: Explanation, at_least: float, rules: Rules) -> list[str]:
    if not held_out.held_out:
        return [held_out.note]
    found = []
    mostly = held_out.helps_mostly(
        least_skill=rules.least_skill, sure=rules.replicate_level, draws=rules.replicates, seed=rules.seed
    )
    if not held_out.helps_everywhere and not mostly:
        worse = held_out.worse
        if len(worse) == 1:
            found.append(f"{worse[0]}, held out, is predicted no better than without it")
        else:
            found.append(
                f"{len(worse)} of {len(held_out.parts)} parts, held out, are predicted no better than without"
                " it"
            )
    if held_out.skill < rules.least_skill:
        least = f"{100.0 * rules.least_skill:.0f} %"
        found.append(f"it predicts less than {least} of the misfit beyond noise in held-out measurements")
    for c, values in zip(explanation.candidates, np.array(held_out.amplitudes).T, strict=True):
        value, sd = explanation.fit.amplitude(c)
        allowed = max(rules.amplitude_tolerance * abs(value), rules.amplitude_tolerance_sds * sd)
        if np.abs(values - value).max() > allowed:
            found.append(f"the amplitude of {c.effect} changes with the part that is left out")
    if held_out.within and at_least < rules.least_share_within_test:
        found.append(
            f"measurements could be held out only from within the tests, where its explained fraction must"
            f" reliably be {100.0 * rules.least_share_within_test:.0f} %"
        )
    return found


def _alternatives(
    explanation: Explanation,
    share: Interval,
    drawn: np.ndarray,
    sound: Sequence[tuple[Explanation, Misfit]],
    shares: Shares,
    rules: Rules,
) -> tuple[tuple[Names, Interval], ...]:
    """Other sets of at most as many names that take as much, in total or in some replicates; best first."""
    found: dict[Names, Misfit] = {}
    for e, m in sound:
        if e.names == explanation.names or len(e.names) > len(explanation.names):
            continue
        if shares.share(m).value < rules.least_share:
            continue
        if set(e.names) < set(explanation.names):
            continue
        as_much = float(np.mean(shares.drawn(m) >= drawn)) > rules.alternative_fraction
        as_much |= shares.share(m).value > share.value - rules.alternative_margin
        if as_much and (e.names not in found or m.value < found[e.names].value):
            found[e.names] = m
    ordered = sorted(found.items(), key=lambda pair: pair[1].value)
    return tuple((names, shares.share(misfit)) for names, misfit in ordered)
