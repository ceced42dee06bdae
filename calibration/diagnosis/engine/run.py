"""A complete diagnosis: search, refinement of the explanation, held-out predictions, advice."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from calibration.diagnosis.engine.advice import advice
from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import AS_FITTED, Fit, fit
from calibration.diagnosis.engine.held_out import HeldOut, held_out_improvement
from calibration.diagnosis.engine.model_error import model_error_of
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.partly import Assessed, assess, within_smooth_error
from calibration.diagnosis.engine.remainder import about_remainder, remainder_of
from calibration.diagnosis.engine.search import Finding, Rules, search
from calibration.diagnosis.engine.shares import Interval, Shares
from calibration.diagnosis.engine.verdict import Diagnosis, Numbers, Subject, reduced, undetectable
from calibration.measurements._baseline import SPECIMENS
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise_known import NoiseKnown, Source
from calibration.measurements._state import State
from calibration.progress import OnMessage

# Nuisances and the mesh's error are taken at an explanation again as long as it moves by more than this
# fraction of its standard deviation: effects next to a clamp act a third too strongly on the search's mesh.
UPDATES, SETTLED = 4, 0.25
SMALL = "the misfit is so small that it may be a smooth unstated error"


@dataclass(frozen=True, eq=False, kw_only=True)
class Searched:
    """A completed search before `concluded`, without held-out predictions and advice, which are costlier.

    Attributes
    ----------
    model : measurements with effects that were searched.
    finding : result of the search.
    noise : knowledge of the noise.
    rules : significance levels and limits that were used.
    begun : start of the search on the monotonic clock [s].
    """

    model: MeasurementModel
    finding: Finding
    noise: NoiseKnown
    rules: Rules
    begun: float


def diagnose(
    model: MeasurementModel,
    *,
    rules: Rules | None = None,
    gain: bool = True,
    noise: Source = "stated",
    on_progress: OnMessage = lambda _: None,
) -> Diagnosis:
    """Search for the effects that the baseline lacks, and reach a verdict.

    Parameters
    ----------
    model : measurements of one kind, with effects.
    rules : significance levels and limits; None for the defaults.
    gain : predict held-out data as well. Explanations that leave more than noise are always tested on them.
    noise : source of the noise level if the data contradict the stated one: "stated" or "data".
    on_progress : called with a sentence at each step.

    Raises
    ------
    ValueError : the baseline has no solution anywhere.
    """
    found = searched(model, rules=rules, noise=noise, on_progress=on_progress)
    return concluded(found, gain=gain, on_progress=on_progress)


def searched(
    model: MeasurementModel,
    *,
    rules: Rules | None = None,
    noise: Source = "stated",
    before: Searched | None = None,
    on_progress: OnMessage = lambda _: None,
) -> Searched:
    """First stage of `diagnose`: noise and search.

    before : search of the same measurements with a smaller catalogue, whose converged fits are reused, and
    whose time counts. A misfit within an unstated smooth error (`within_smooth_error`) is not attributed to
    any cause.
    """
    begun = time.monotonic() if before is None else before.begun
    rules = rules or Rules()
    known = model.settle_noise(noise)
    model.noise_scale = known.scale
    earlier = None if before is None else before.finding
    finding = search(model, rules=rules, before=earlier, on_progress=on_progress)
    if finding.verdict in ("found", "ambiguous") and within_smooth_error(
        model, finding.baseline, known, rules
    ):
        # what a smooth error may have made is named neither wholly nor in part
        finding = replace(finding, verdict="unexplained", equivalent=(), confidence=0.0, doubt=SMALL)
    return Searched(model=model, finding=finding, noise=known, rules=rules, begun=begun)


def concluded(found: Searched, *, gain: bool = True, on_progress: OnMessage = lambda _: None) -> Diagnosis:
    """Second stage of `diagnose`: partial explanations, refinement, held-out predictions and advice."""
    model, finding, known, rules = found.model, found.finding, found.noise, found.rules
    baseline = finding.baseline
    before = _numbers(model, baseline, finding.lack_of_fit.p_value)
    nearest: Assessed | None = None
    if finding.verdict == "unexplained":
        finding, nearest = _in_degrees(model, finding, known, rules, on_progress)
    after: Numbers | None = None
    held_out: HeldOut | None = None
    refined: Explanation | None = None
    shares: Shares | None = None
    causes: dict[Candidate, Interval] = {}
    if finding.chosen is not None:
        on_progress("refining what was found")
        next_experiment = _advice(model, finding, on_progress)
        noise_there = model.noise
        refined, baseline, null = _refined(model, finding, rules)
        after = _numbers(model, refined.fit, refined.lack_of_fit.p_value)
        if gain and nearest is not None and nearest.held_out is not None and model.noise is noise_there:
            held_out = nearest.held_out  # no nuisance was taken anew: it would be the same
        elif gain:
            on_progress("predicting held-out measurements")
            held_out = held_out_improvement(model, baseline, refined.fit)
            if not held_out.held_out and nearest is not None and nearest.held_out is not None:
                # as it was found: where nuisances are taken anew, a fold may have no answer
                held_out = nearest.held_out
        shares = _shares(model, baseline, rules, known)
        causes = shares.of_causes(model, baseline, refined, null)
    else:
        next_experiment = _no_cause(model, finding)
        if finding.verdict == "unexplained":
            shares = _shares(model, baseline, rules, known)
    fit_now = baseline if refined is None else refined.fit
    left = remainder_of(model, fit_now, negligible=rules.negligible_fraction) if shares is not None else None
    named_whole = finding.verdict in ("none", "found", "ambiguous")
    if left is not None and not named_whole:
        next_experiment = "; ".join(x for x in (next_experiment, about_remainder(left)) if x)
    return Diagnosis(
        finding=finding,
        chosen=refined,
        effects=dict(model.effects),
        baseline=before,
        extended=after,
        held_out=held_out,
        subject=Subject.of(model, finding.baseline if refined is None else refined.fit),
        next_experiment=next_experiment,
        undetectable=undetectable(model, finding),
        notes=tuple(_notes(model, finding, refined, rules, known)),
        seconds=time.monotonic() - found.begun,
        share=shares.share(shares.misfit(refined.fit)) if shares and refined else None,
        shares=causes,
        resampled=shares.groups.over if shares else "",
        nearest=nearest if refined is None else None,
        equally_large=dict(nearest.alternatives) if nearest is not None and refined is not None else {},
        remainder=left,
        model_error=model_error_of(model, fit_now, left, shares, reduced(fit_now))
        if shares is not None and left is not None and not named_whole
        else None,
        noise=known,
    )


def _shares(model: MeasurementModel, baseline: Fit, rules: Rules, noise: NoiseKnown) -> Shares:
    return Shares(
        model,
        baseline,
        draws=rules.replicates,
        seed=rules.seed,
        noise_dof=noise.dof,
        noise_scale=noise.scale,
    )


def _in_degrees(
    model: MeasurementModel, finding: Finding, noise: NoiseKnown, rules: Rules, on_progress: OnMessage
) -> tuple[Finding, Assessed | None]:
    """The finding, "partly explained" if that applies, and the assessed explanation (`partly.assess`)."""
    shares = _shares(model, finding.baseline, rules, noise)
    nearest = assess(
        model,
        finding.baseline,
        finding.explanations,
        shares,
        rules,
        noise,
        on_progress=on_progress,
    )
    if nearest is None or nearest.against or finding.p_value > rules.false_alarm_rate:
        return finding, nearest
    named = replace(
        finding,
        verdict="partly explained",
        dominant=nearest.explanation,
        equivalent=(nearest.explanation.names, *(names for names, _ in nearest.alternatives)),
        confidence=nearest.confidence,
    )
    return named, nearest


def _refined(model: MeasurementModel, finding: Finding, rules: Rules) -> tuple[Explanation, Fit, Null]:
    """Refit the chosen explanation and the baseline with nuisances estimated at the explanation.

    The two fits are comparable with each other but not with those of the search, whose nuisances and
    discretisation errors differ.
    """
    chosen = finding.chosen
    assert chosen is not None
    again, null = chosen, finding.null
    for _ in range(UPDATES):
        noise_there = model.noise
        model.update_nuisances(again.fit.state)
        if model.noise is noise_there and again.fit.converged:  # it would be the same
            return again, fit(model, State(u=finding.baseline.state.u), tolerance=AS_FITTED), null
        null = Null.of(model, len(again.fit.z), seed=rules.seed)
        before = again.fit.state.amplitudes
        taken = explain(model, again.fit, again.candidates, list(before.values()), null)
        assert taken is not None, "there was an answer when it was found"
        again = taken
        found = [(c, *again.fit.amplitude(c)) for c in again.candidates]
        if all(abs(value - before[c]) < SETTLED * sd for c, value, sd in found):
            break
    return again, fit(model, State(u=finding.baseline.state.u), tolerance=AS_FITTED), null


def _numbers(model: MeasurementModel, found: Fit, p: float) -> Numbers:
    return Numbers(
        reduced_chi2=reduced(found),
        p_value=p,
        rms=model.distance_rms(found.state) * model.unit[1],
        shear_modulus_Pa=model.shear_moduli(found.state.u),
    )


def _advice(model: MeasurementModel, finding: Finding, on_progress: OnMessage) -> str:
    chosen = finding.chosen
    assert chosen is not None
    if len(finding.equivalent) == 1:
        return "; ".join(f"to confirm: {model.effects[name].remedy}" for name in chosen.names)
    named = dict.fromkeys(name for names in finding.equivalent for name in names)
    own = [e for e in (model.effects[name] for name in named) if e.belongs_to == "simulator"]
    if own:  # a simulator that is wrong would answer for another experiment as well
        return "; ".join(f"before another experiment: {e.remedy} ({e.name})" for e in own)
    on_progress("looking for the experiment that would separate the explanations")
    one_each = [next(e for e in finding.explanations if e.names == names) for names in finding.equivalent]
    return advice(model, one_each)


def _no_cause(model: MeasurementModel, finding: Finding) -> str:
    if finding.verdict == "unexplained":
        left = finding.explanations[0].lack_of_fit if finding.explanations else finding.lack_of_fit
        if left.worst == SPECIMENS:
            return (
                "check that each measurement is assigned to its own specimen and material: moduli within a"
                " material differ by more than its specimens do"
            )
        return ""
    never = [e for name, e in model.effects.items() if _never(finding, name)]
    return "; ".join(dict.fromkeys(f"{e.remedy} ({e.name} cannot be seen)" for e in never))


def _never(finding: Finding, name: str) -> bool:
    sizes = [
        s
        for c, s in zip(finding.screened.candidates, finding.screened.sizes, strict=True)
        if c.effect == name
    ]
    return bool(sizes) and max(sizes) == 0.0


def _notes(
    model: MeasurementModel, finding: Finding, chosen: Explanation | None, rules: Rules, noise: NoiseKnown
) -> list[str]:
    found = noise.sentences() + model.remarks()
    found += _at_limits(model, chosen) + _other_scopes(model, finding, rules)
    for e in (finding.baseline, *(x.fit for x in finding.explanations)):
        if not e.converged:
            found.append(f"fit of {e.label}: {e.message}")
    return found


def _at_limits(model: MeasurementModel, chosen: Explanation | None) -> list[str]:
    """Sentences on causes whose amplitude is at a physical limit."""
    found = []
    for c, a in chosen.fit.state.amplitudes.items() if chosen is not None else ():
        effect = model.effects[c.effect]
        if a in effect.physical_limits and not effect.switch:
            found.append(f"{c.label}: {effect.in_file(a):.3g} {effect.parameter} is at its physical limit")
    return found


def _other_scopes(model: MeasurementModel, finding: Finding, rules: Rules) -> list[str]:
    """Sentences on equivalent scopes and positions of the same causes, with their amplitudes and moduli."""
    chosen = finding.chosen
    found: list[str] = []
    for e in finding.explanations[1:] if chosen is not None else ():
        assert chosen is not None
        if e.names == chosen.names and e.score <= chosen.score + rules.score_tolerance:
            moduli = ", ".join(
                f"{name} {1e-3 * shear:.4g} kPa" for name, shear in model.shear_moduli(e.fit.state.u).items()
            )
            found.append(
                f"the data cannot separate {chosen.fit.label} from {e.fit.label}, which would be"
                f" {_amplitudes(model, e)} with shear moduli of {moduli}"
            )
    return found


def _amplitudes(model: MeasurementModel, e: Explanation) -> str:
    parts = []
    for c in e.candidates:
        effect = model.effects[c.effect]
        value, sd = (effect.in_file(x) for x in e.fit.amplitude(c))
        parts.append(f"{value:.3g} +- {sd:.2g} {effect.parameter}")
    return " and ".join(parts)
