"""A diagnosis from beginning to end: search, refine what was found, measure the gain, advise."""

from __future__ import annotations

import time
from typing import Protocol

import numpy as np

from calibration.diagnosis.explanation import Explanation, explain
from calibration.diagnosis.fitting import Fit, fit
from calibration.diagnosis.heldout import Foldable, Gain, held_out_gain
from calibration.diagnosis.nested import State
from calibration.diagnosis.null import Null
from calibration.diagnosis.search import Finding, Rules, Tell, search
from calibration.diagnosis.specimens import SPECIMENS
from calibration.diagnosis.verdict import Diagnosis, Numbers, invisible, reduced

# Nuisances and the mesh's error are taken where an explanation is, as often as it moves by more than this
# part of its standard deviation: effects next to a clamp act a third too strongly on the mesh of the search.
RETAKES, SETTLED = 4, 0.25


class Diagnosable(Foldable, Protocol):
    """A domain's model (beams, coupons, pokes) with what a verdict needs besides the search.

    unit: of `distance_rms` in files, and how many of them one SI unit is.
    """

    @property
    def unit(self) -> tuple[str, float]: ...

    def shear_moduli(self, u: np.typing.NDArray[np.float64]) -> dict[str, float]: ...

    def advice(self, rivals: list[Explanation]) -> str:
        """The experiment that would part explanations that the data cannot; "" where none is known."""

    def remarks(self) -> list[str]:
        """What a reader of the verdict should know of the model."""


def diagnose(
    model: Diagnosable, *, rules: Rules | None = None, gain: bool = True, tell: Tell = lambda _: None
) -> Diagnosis:
    """Search for what the baseline lacks, and say what is known. gain: measure it on held-out data too.

    ValueError where the baseline has no answer anywhere.
    """
    begun = time.monotonic()
    finding = search(model, rules=rules, tell=tell)
    baseline = finding.baseline
    before = _numbers(model, baseline, finding.departure.p)
    after: Numbers | None = None
    held_out: Gain | None = None
    refined: Explanation | None = None
    if finding.chosen is not None:
        tell("refining what was found")
        advice = _advice(model, finding, tell)
        refined, baseline = _refined(model, finding, rules or Rules())
        after = _numbers(model, refined.fit, refined.departure.p)
        if gain:
            tell("predicting what the fit has not seen")
            held_out = held_out_gain(model, baseline, refined.fit)
    else:
        advice = _no_cause(model, finding)
    return Diagnosis(
        finding=finding,
        chosen=refined,
        effects=dict(model.effects),
        baseline=before,
        extended=after,
        gain=held_out,
        unit=model.unit,
        next_experiment=advice,
        invisible=invisible(model, finding),
        notes=tuple(_notes(model, finding, refined, rules or Rules())),
        seconds=time.monotonic() - begun,
    )


def _refined(model: Diagnosable, finding: Finding, rules: Rules) -> tuple[Explanation, Fit]:
    """The chosen explanation and the baseline, fitted with nuisances and discretisation errors taken where
    the explanation is; they compare with each other only, not with what the search found."""
    chosen = finding.chosen
    assert chosen is not None
    again = chosen
    for _ in range(RETAKES):
        model.retake(again.fit.state)
        null = Null(len(again.fit.z), model.patterns(), seed=rules.seed)
        before = again.fit.state.amplitudes
        taken = explain(model, again.fit, again.candidates, list(before.values()), null)
        assert taken is not None, "there was an answer when it was found"
        again = taken
        found = [(c, *again.fit.amplitude(c)) for c in again.candidates]
        if all(abs(value - before[c]) < SETTLED * sd for c, value, sd in found):
            break
    return again, fit(model, State(u=finding.baseline.state.u))


def _numbers(model: Diagnosable, found: Fit, p: float) -> Numbers:
    return Numbers(
        reduced_chi2=reduced(found),
        p_value=p,
        rms=model.distance_rms(found.state) * model.unit[1],
        shear_modulus_Pa=model.shear_moduli(found.state.u),
    )


def _advice(model: Diagnosable, finding: Finding, tell: Tell) -> str:
    chosen = finding.chosen
    assert chosen is not None
    if finding.verdict == "found":
        return "; ".join(f"to confirm: {model.effects[name].remedy}" for name in chosen.names)
    named = dict.fromkeys(name for names in finding.rivals for name in names)
    own = [e for e in (model.effects[name] for name in named) if e.belongs_to == "simulator"]
    if own:  # what a specimen is asked would be answered by a simulator that is wrong
        return "; ".join(f"before another experiment: {e.remedy} ({e.name})" for e in own)
    tell("looking for the experiment that would tell the rivals apart")
    one_each = [next(e for e in finding.explanations if e.names == names) for names in finding.rivals]
    return model.advice(one_each)


def _no_cause(model: Diagnosable, finding: Finding) -> str:
    if finding.verdict == "unexplained":
        left = finding.explanations[0].departure if finding.explanations else finding.departure
        if left.worst == SPECIMENS:
            return (
                "see whether each measurement is filed under its own specimen and material: moduli within a"
                " material differ by more than its specimens do"
            )
        return "look at the residuals; repeat the measurements that depart most, in another pose"
    never = [e for name, e in model.effects.items() if _never(finding, name)]
    return "; ".join(dict.fromkeys(f"{e.remedy} ({e.name} cannot be seen)" for e in never))


def _never(finding: Finding, name: str) -> bool:
    sizes = [
        s
        for c, s in zip(finding.screened.candidates, finding.screened.sizes, strict=True)
        if c.effect == name
    ]
    return bool(sizes) and max(sizes) == 0.0


def _notes(model: Diagnosable, finding: Finding, chosen: Explanation | None, rules: Rules) -> list[str]:
    found = model.remarks() + _at_the_end(model, chosen) + _other_places(model, finding, rules)
    for e in (finding.baseline, *(x.fit for x in finding.explanations)):
        if not e.converged:
            found.append(f"fit of {e.reports()}: {e.message}")
    return found


def _at_the_end(model: Diagnosable, chosen: Explanation | None) -> list[str]:
    """Causes that are as large as they can be."""
    found = []
    for c, a in chosen.fit.state.amplitudes.items() if chosen is not None else ():
        effect = model.effects[c.effect]
        if a in effect.ends:
            found.append(f"{c.label}: {effect.in_file(a):.3g} {effect.parameter} is as far as it goes")
    return found


def _other_places(model: Diagnosable, finding: Finding, rules: Rules) -> list[str]:
    """Where else the same causes may sit, for all that the data say, with what amplitudes and moduli."""
    chosen = finding.chosen
    found: list[str] = []
    for e in finding.explanations[1:] if chosen is not None else ():
        assert chosen is not None
        if e.names == chosen.names and e.score <= chosen.score + rules.within:
            moduli = ", ".join(
                f"{name} {1e-3 * shear:.4g} kPa" for name, shear in model.shear_moduli(e.fit.state.u).items()
            )
            found.append(
                f"the data do not tell {chosen.fit.reports()} from {e.fit.reports()}, where it would be"
                f" {_amplitudes(model, e)} with shear moduli of {moduli}"
            )
    return found


def _amplitudes(model: Diagnosable, e: Explanation) -> str:
    told = []
    for c in e.candidates:
        effect = model.effects[c.effect]
        value, sd = (effect.in_file(x) for x in e.fit.amplitude(c))
        told.append(f"{value:.3g} +- {sd:.2g} {effect.parameter}")
    return " and ".join(told)
