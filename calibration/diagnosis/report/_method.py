"""Sentences on the methods of a diagnosis, and on fits that failed."""

from __future__ import annotations

from calibration.diagnosis.engine.lack_of_fit import LackOfFit
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.diagnosis.report._evidence import FREQUENT, RARE
from calibration.diagnosis.report._words import SUSPECT, p_text, pattern, tiny
from calibration.measurements._model import MeasurementModel
from calibration.pages import listed, significant


def false_alarms(diagnosis: Diagnosis) -> str:
    """Sentences on the improvement that noise alone gives, and on the p-value of the best cause."""
    finding = diagnosis.finding
    noise = finding.null.max_improvement(finding.screened)
    limits = (
        f"In this design noise alone gives the best of all {len(finding.screened.candidates)} candidates more"
        f" than {significant(noise.threshold(FREQUENT))} in {FREQUENT:.0%} and more than"
        f" {significant(noise.threshold(RARE))} in {RARE:.0%} of experiments."
    )
    single = [e for e in finding.explanations if len(e.candidates) == 1]
    if not single:
        return f"{limits} No cause explained enough to be fitted in the simulator."
    p_value = tiny(finding.p_value)
    if noise.estimated:
        p_value = p_text(finding.p_value, len(finding.null.noise))
    gain = max(finding.baseline.chi2 - e.fit.chi2 - e.multiplicity_penalty for e in single)
    return (
        f"{limits} The best single cause improves χ² by {significant(max(0.0, gain))}, after the"
        f" penalty for the choice of its position; the p-value is {p_value}."
    )


def lack_of_fit(diagnosis: Diagnosis) -> str:
    """Sentences on the lack of fit of the baseline and of the best explanation."""
    finding = diagnosis.finding
    draws = len(finding.null.noise)
    base = finding.lack_of_fit
    kind = diagnosis.subject.kind
    text = (
        f"Against the baseline {_failing(base, kind)} (all tests together: p {p_text(base.p_value, draws)})."
    )
    if not finding.explanations or finding.p_value > RARE:
        return f"{text} No effect in the library improves χ² by more than noise alone would."
    best = finding.explanations[0]
    if finding.doubt:
        return f"{text} With {best.fit.label} only noise remains, but {finding.doubt}."
    return (
        f"{text} The best explanation in the library ({best.fit.label}) improves χ² by"
        f" {significant(finding.baseline.chi2 - best.fit.chi2)}, but its residuals are not noise either:"
        f" {_failing(best.lack_of_fit, kind)} (all tests together: p"
        f" {p_text(best.lack_of_fit.p_value, draws)}). It is therefore not"
        f" {'the whole cause' if finding.verdict == 'partly explained' else 'named as the cause'}."
    )


def _failing(found: LackOfFit, kind: str) -> str:
    """Clause with the tests of the residuals that fail; if none does, the one with the smallest p-value."""
    worst = [n for n, p in found.each.items() if p < SUSPECT] or [found.worst]
    return f"the residuals exceed noise in the {listed([pattern(n, kind) for n in worst])}"


def troubles(diagnosis: Diagnosis) -> list[str]:
    """Sentences on fits that the verdict depends on and that did not converge; others are in the notes."""
    finding = diagnosis.finding
    found = []
    if not finding.baseline.converged:
        found.append(f"The baseline's fit did not converge: {finding.baseline.message}.")
    chosen = diagnosis.chosen
    if chosen is not None and not chosen.fit.converged:
        found.append(f"The fit of {chosen.fit.label} did not converge: {chosen.fit.message}.")
    return found


def method(diagnosis: Diagnosis, model: MeasurementModel, noise: str) -> list[str]:
    """Paragraphs on noise model, null distribution, screening, confidence, bootstrap and computing time."""
    finding = diagnosis.finding
    draws = len(finding.null.noise)
    candidates = finding.screened.candidates
    effects = {c.effect for c in candidates}
    resampled = (
        [
            "Shares are fractions of the explainable misfit, which is χ² minus the χ² of noise alone."
            " Their 95 %"
            f" intervals come from a bootstrap over {diagnosis.resampled}, never over points. Correlated"
            " causes"
            " divide it by Shapley's value. Held-out skill is the fraction of the squared error beyond"
            " noise that"
            " the extension removes in measurements that its fit has not used."
        ]
        if diagnosis.resampled
        else []
    )
    return [
        f"Noise: {model.points} measured values, whitened by their covariance, nuisances included."
        f" {noise}".strip(),
        f"Null distribution: {draws} draws of that noise, fitted to first order with the baseline's free"
        f" coordinates ({len(model.names)}), in place of tabulated values of χ². A p-value below"
        f" {significant(1.0 / (draws + 1), 2)} cannot be counted: it is given as a bound"
        + (
            ". Where the noise was estimated from the scatter of a record, each draw has an error of that"
            " estimate."
            if finding.null.estimated
            else ", and for the best cause extrapolated from the tail of the draws."
        ),
        f"Screening: {len(effects)} effects at {len(candidates)} candidate positions, each an amplitude"
        " in the simulator,"
        f" to first order; {len(finding.explanations)} sets of causes were then fitted in the simulator."
        " The p-value above accounts for the number of candidates.",
        f"Confidence: {min(1000, draws)} replicates of the best explanation with new noise, with all"
        " explanations"
        " refitted to first order: the fraction in which the same set of effects ranks first.",
        *resampled,
        f"This diagnosis took {significant(diagnosis.seconds)} s.",
    ]
