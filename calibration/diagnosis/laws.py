"""Diagnosis in two rounds: usual causes with the simplest law, then all causes with the best law.

If the first round does not explain the data, laws are compared by their predictions of held-out measurements.
The best one enters the second round as a cause of its own (the effect whose `richer` is set), so that other
causes are tested together with it; causes that are rare or flexible in form (`further`) are added as well.
The second round also takes place if the first needs several causes. It then replaces the first if fewer
causes explain the data about as well, or as many clearly better.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from calibration.diagnosis.engine.fitting import TOLERANCE, Fit, fit
from calibration.diagnosis.engine.resampling import test_of
from calibration.diagnosis.engine.rules import Rules
from calibration.diagnosis.engine.run import Searched, concluded, searched
from calibration.diagnosis.engine.search import Finding
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.errors import InputError
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise_known import Source
from calibration.measurements._state import State
from calibration.parameters import is_series, parametrisation
from calibration.progress import OnMessage

AUTO = "auto"
PREFERRED = "leave-one-fifth-out"  # folds; others where the model has none of these
WORTH = 0.1  # part of the simpler law's held-out misfit that further constants have to take away
SHARP = 1e-3  # of chi-square: laws that are compared are fitted as sharp as that, which WORTH does not see
STEPS = 5  # of such a fit that gain less than a tenth each
SURE = 2.0  # standard deviations of a chi-square of so many points, that is noise
EXPLAINED = ("none", "found", "ambiguous")  # verdicts after which no other law is asked

Law = tuple[str, int]  # name, terms
Make = Callable[..., MeasurementModel]


@dataclass(frozen=True, kw_only=True)
class LawScore:
    """Scores of a law as baseline.

    Attributes
    ----------
    law, terms, label : name, number of terms, and label for people.
    constants : number of free constants of all materials together, without moduli of specimens.
    chi2 : chi-square of its fit to all measurements.
    held_out : chi-square of the measurements, each fold predicted from the others.
    rms : rms error of these predictions [SI].
    """

    law: str
    terms: int
    label: str
    constants: int
    chi2: float
    held_out: float
    rms: float


@dataclass(frozen=True, kw_only=True)
class LawChoice:
    """Result of a comparison of laws.

    Attributes
    ----------
    scores : scores of the laws, the simplest first.
    folds : name of the set of folds.
    points : number of measurements that were predicted.
    missing : laws that could not be compared, with the reason.
    """

    scores: tuple[LawScore, ...]
    folds: str
    points: int
    missing: tuple[str, ...] = ()

    @property
    def simplest(self) -> LawScore:
        return self.scores[0]

    @property
    def best(self) -> LawScore:
        """The law chosen by ascending number of constants.

        A richer law replaces the current choice if it reduces the held-out chi-square by more than the
        fraction `WORTH` and by more than `SURE` standard deviations of that of noise, sqrt(2 points).
        """
        chosen, noise = self.scores[0], SURE * np.sqrt(2.0 * self.points)
        for s in sorted(self.scores[1:], key=lambda s: s.constants):
            if s.held_out < chosen.held_out - max(WORTH * chosen.held_out, noise):
                chosen = s
        return chosen

    def sentence(self) -> str:
        """The comparison and the benefit of the chosen law in a sentence."""
        each = ", ".join(f"{s.label} {s.held_out:.4g}" for s in self.scores)
        worth = 1.0 - self.best.held_out / self.simplest.held_out
        return (
            f"laws compared by chi-square of {self.points} measurements that their fits had not seen"
            f" ({self.folds}): {each}; {self.best.label} was taken, which is worth {worth:.0%} of what"
            f" {self.simplest.label} leaves" + "".join(f"; {m}" for m in self.missing)
        )


def law_of(text: str) -> Law:
    """Parse "ogden:2" or "neo-hookean" to name and number of terms. InputError if no such law is known."""
    name, _, terms = text.partition(":")
    try:
        number = int(terms) if terms else 1
        parametrisation(name, terms=number)
    except ValueError as error:
        raise InputError(f"--law {text}: expected auto, or NAME or NAME:TERMS of a law: {error}") from error
    if number > 1 and not is_series(name):
        raise InputError(f"--law {text}: expected no number of terms, {name} is no series")
    return name, number


def diagnose_with_law(
    make: Make,
    *,
    law: str = AUTO,
    rules: Rules | None = None,
    gain: bool = True,
    noise: Source = "stated",
    on_progress: OnMessage = lambda _: None,
) -> tuple[Diagnosis, MeasurementModel]:
    """Diagnose in two rounds; returns the diagnosis and the model of the round that it is from.

    Parameters
    ----------
    make : builds the model from the options law, terms, richer (by default the simplest law) and further.
    law : "auto", or a law with its terms ("ogden:2") that is the baseline in both rounds.
    rules, gain, noise, on_progress : see `engine.run.diagnose`.

    Raises
    ------
    InputError : the law is unknown, or the kind of measurement has one law only.
    ValueError : the baseline has no solution anywhere.
    """
    options: dict[str, object] = {}
    if law != AUTO:
        options["law"], options["terms"] = law_of(law)
    model = make(further=False, **options)
    first = searched(model, rules=rules, noise=noise, on_progress=on_progress)
    if first.finding.verdict in EXPLAINED and _causes(first.finding) < 2:
        return concluded(first, gain=gain, on_progress=on_progress), model
    choice = None
    if law == AUTO and model.laws:
        choice = choose_law(model, on_progress=on_progress)
    if choice is not None and choice.best is not choice.simplest:
        options["richer"] = choice.best.law, choice.best.terms
    fuller = make(**options)
    again: Searched | None = None
    if any(fuller.visible[c] for c in fuller.candidates if fuller.effects[c.effect].further):
        on_progress("asking further causes, since no usual one explains the data alone")
        again = searched(fuller, rules=rules, noise=noise, before=first, on_progress=on_progress)
    model, found = _better_round(first, again, "richer" in options, gain=gain, on_progress=on_progress)
    notes = () if choice is None else (choice.sentence(),)
    return _no_more_than_shown(replace(found, notes=(*found.notes, *notes)), model), model


def _no_more_than_shown(found: Diagnosis, model: MeasurementModel) -> Diagnosis:
    """Downgrade an explanation that these records cannot confirm to "partly explained".

    This concerns causes that the records cannot distinguish from an effect missing in the catalogue
    (`EffectModel.conclusive`), and several causes that all act in a single test out of several: together they
    can follow any smooth curve, and no other test confirms them.
    """
    if found.chosen is None or found.finding.verdict not in EXPLAINED:
        return found
    doubts, said = [], []
    for c in found.chosen.candidates:
        effect = model.effects[c.effect]
        hit = [r for r, here in zip(model.records, model.reached(c), strict=True) if here]
        if not effect.conclusive(hit, model.records):
            doubts.append(f"{c.label} may stand in for anything that is smooth along these records")
            said.append(f"{doubts[-1]}: {effect.remedy}")
    if only := _in_one_test(found, model):
        doubts.append(f"all of it is in {only}, and no other test confirms it")
    if not doubts:
        return found
    finding = replace(
        found.finding,
        verdict="partly explained",
        dominant=found.finding.explanations[0],
        doubt="; and ".join(doubts),
    )
    return replace(found, finding=finding, notes=(*found.notes, *said))


def _in_one_test(found: Diagnosis, model: MeasurementModel) -> str:
    """Name of the single test, out of several, in which all of several named causes act; "" otherwise.

    It applies to the verdict "found" only.
    """
    chosen, tests = found.chosen, [test_of(r) for r in model.records]
    if chosen is None or len(chosen.names) < 2 or found.finding.verdict != "found":
        return ""
    reached = {tests[k] for c in chosen.candidates for k in np.flatnonzero(model.reached(c))}
    return reached.pop() if len(reached) == 1 < len(set(tests)) else ""


def _causes(found: Finding) -> int:
    """Number of causes that are named together."""
    return 0 if found.chosen is None else len(found.chosen.candidates)


def _better_round(
    first: Searched, again: Searched | None, richer: bool, *, gain: bool, on_progress: OnMessage
) -> tuple[MeasurementModel, Diagnosis]:
    """Model and diagnosis of the better of two rounds; only this one is concluded if the search decides.

    richer : True if the second round has a law that predicts better.
    """

    def conclude(one: Searched) -> Diagnosis:
        return concluded(one, gain=gain, on_progress=on_progress)

    if again is None:
        return first.model, conclude(first)
    if first.finding.verdict in EXPLAINED:
        one = again if _simpler(again.finding, first.finding, first.rules) else first
        return one.model, conclude(one)
    second = conclude(again)
    # what a cause takes beside a law that predicts worse may be the law's: the better one is asked
    if richer or _explains(second):
        return again.model, second
    found = conclude(first)
    return (first.model, found) if _explains(found) else (again.model, second)


def _explains(found: Diagnosis) -> int:
    """Rank of a verdict: 0 explains nothing, 1 explains in part, 2 explains all."""
    verdict = found.finding.verdict
    return 2 if verdict in EXPLAINED else 0 if verdict == "unexplained" else 1


def _simpler(again: Finding, found: Finding, rules: Rules) -> bool:
    """True if the second round explains the data as well with fewer causes, or clearly better with as many.

    Scores include the penalty for constants that the causes introduce.
    """
    if again.chosen is None or found.chosen is None or again.verdict not in EXPLAINED:
        return False
    better = found.chosen.score - again.chosen.score
    fewer = _causes(found) - _causes(again)
    return better >= (-rules.score_tolerance if fewer > 0 else rules.score_tolerance) and fewer >= 0


def choose_law(model: MeasurementModel, *, on_progress: OnMessage = lambda _: None) -> LawChoice:
    """Compare a model's laws as baselines, without effects, by cross-validation.

    ValueError if the simplest law has no solution.
    """
    scores: list[LawScore] = []
    missing: list[str] = []
    name, points = "", 0
    for law, terms in model.laws:
        label = parametrisation(law, terms=terms).label
        on_progress(f"comparing laws: {label}")
        try:
            parts = [_compared(own) for own in model.with_law(law, terms)]
        except ValueError as error:
            if not scores:
                raise
            missing.append(f"{label} could not be compared ({error})")
            continue
        held_out, squares = sum(p.held_out for p in parts), sum(p.squares for p in parts)
        if not np.isfinite(held_out):
            missing.append(f"{label} has no stress at some measurements that its fit has not seen")
            continue
        name, points = parts[0].folds, sum(p.points for p in parts)
        scores.append(
            LawScore(
                law=law,
                terms=terms,
                label=label,
                constants=sum(p.constants for p in parts),
                chi2=sum(p.chi2 for p in parts),
                held_out=held_out,
                rms=float(np.sqrt(squares / points)),
            )
        )
    return LawChoice(scores=tuple(scores), folds=name, points=points, missing=tuple(missing))


@dataclass(frozen=True, kw_only=True)
class _Compared:
    """As `LawScore` for a subset of the measurements.

    squares : sum of squared prediction errors [SI]. points : number of predicted measurements. folds : name
    of the set of folds.
    """

    constants: int
    chi2: float
    held_out: float
    squares: float
    points: int
    folds: str


def _compared(own: MeasurementModel) -> _Compared:
    """Fit all measurements and cross-validate. ValueError if there is no solution."""
    whole = _near_enough(own, State(u=own.start()))
    folds = own.folds()
    name = PREFERRED if PREFERRED in folds else next(iter(folds))
    held_out, squares, points = 0.0, 0.0, 0
    for _, fold in folds[name]:
        trained = _near_enough(own.subset(fold, others=True), whole.state).state
        left = own.subset(fold, others=False)
        z = left.residuals([trained])[0][: left.points]
        held_out += float(z @ z)
        if np.isfinite(held_out):
            squares += left.distance_rms(trained) ** 2 * left.points
        points += left.points
    constants = len(own.baseline.free) * len(own.baseline.materials)
    return _Compared(
        constants=constants, chi2=whole.chi2, held_out=held_out, squares=squares, points=points, folds=name
    )


def _near_enough(model: MeasurementModel, start: State) -> Fit:
    """Fit to a tolerance that is sufficient to compare laws.

    If a law misfits strongly, the usual tolerance would take many steps along nearly collinear constants.
    """
    z = model.residuals([start])[0]
    return fit(model, start, max_steps=STEPS, tolerance=max(TOLERANCE, SHARP * float(z @ z)))
