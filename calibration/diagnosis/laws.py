"""A diagnosis in two rounds: the usual causes beside the simplest law, then all causes beside the best law.

Where the first round leaves the data unexplained, laws are compared by how well they predict what their fit
has not seen. The best one enters the second round as a cause of its own (the effect whose `richer` is set),
so that what else is wrong is asked beside it; causes that are rare, or free in their form (`further`), enter
with it. They are asked, too, where the first round needs several causes, and taken if fewer explain the data,
or as many clearly better.
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
from calibration.parameters import parametrisation
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
    """A law as baseline.

    Attributes
    ----------
    law, terms, label : which.
    constants : free ones, of all materials together, without moduli of specimens.
    chi2 : of its fit to everything.
    held_out : chi-square of the measurements, each predicted from the others.
    rms : of these predictions, in SI.
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
    """Laws that were compared, the simplest first.

    Attributes
    ----------
    folds : what was left out. points : measurements that were predicted.
    missing : laws without an answer, or without a fit that converges, with the reason.
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
        """The simplest law of which no richer one takes away WORTH of the held-out misfit, and more of it
        than noise would."""
        chosen, noise = self.scores[0], SURE * np.sqrt(2.0 * self.points)
        for s in sorted(self.scores[1:], key=lambda s: s.constants):
            if s.held_out < chosen.held_out - max(WORTH * chosen.held_out, noise):
                chosen = s
        return chosen

    def sentence(self) -> str:
        """What was compared, and what choosing was worth."""
        each = ", ".join(f"{s.label} {s.held_out:.4g}" for s in self.scores)
        worth = 1.0 - self.best.held_out / self.simplest.held_out
        return (
            f"laws compared by chi-square of {self.points} measurements that their fits had not seen"
            f" ({self.folds}): {each}; {self.best.label} was taken, which is worth {worth:.0%} of what"
            f" {self.simplest.label} leaves" + "".join(f"; {m}" for m in self.missing)
        )


def law_of(text: str) -> Law:
    """Name and terms of "ogden:2" or "neo-hookean". InputError where no law of that name is known."""
    name, _, terms = text.partition(":")
    try:
        number = int(terms) if terms else 1
        parametrisation(name, terms=number)
    except ValueError as error:
        raise InputError(f"--law {text}: expected auto, or NAME or NAME:TERMS of a law: {error}") from error
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
    """A diagnosis, and the model that it was made with.

    Parameters
    ----------
    make : the model, of its options law, terms and richer (without them the simplest law), and further.
    rules, gain, noise : see `engine.run.diagnose`.
    law : "auto", or a name with terms ("ogden:2"), which is then the baseline's in both rounds.

    Raises
    ------
    InputError : the law is unknown, or the kind of measurement has one law only.
    ValueError : the baseline has no answer anywhere.
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
    """A cause that these records cannot tell from what is in no catalogue explains in part at most; and so do
    several in one and the same test, of several: so many follow any smooth curve, and nothing but the points
    that they were fitted to speaks for them."""
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
    """The one test, of several, that several causes are in, where nothing else explains the data; "" else."""
    chosen, tests = found.chosen, [test_of(r) for r in model.records]
    if chosen is None or len(chosen.names) < 2 or found.finding.verdict != "found":
        return ""
    reached = {tests[k] for c in chosen.candidates for k in np.flatnonzero(model.reached(c))}
    return reached.pop() if len(reached) == 1 < len(set(tests)) else ""


def _causes(found: Finding) -> int:
    """How many are named together."""
    return 0 if found.chosen is None else len(found.chosen.candidates)


def _better_round(
    first: Searched, again: Searched | None, richer: bool, *, gain: bool, on_progress: OnMessage
) -> tuple[MeasurementModel, Diagnosis]:
    """What the rounds come to. Only what is said is concluded, where the search tells which round that is.

    richer : the second round has a law that predicts better.
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
    """How much a verdict says: nothing that explains, something in part, all."""
    verdict = found.finding.verdict
    return 2 if verdict in EXPLAINED else 0 if verdict == "unexplained" else 1


def _simpler(again: Finding, found: Finding, rules: Rules) -> bool:
    """True if fewer causes explain the data about as well, or as many clearly better; constants that they
    bring count in the score."""
    if again.chosen is None or found.chosen is None or again.verdict not in EXPLAINED:
        return False
    better = found.chosen.score - again.chosen.score
    fewer = _causes(found) - _causes(again)
    return better >= (-rules.score_tolerance if fewer > 0 else rules.score_tolerance) and fewer >= 0


def choose_law(model: MeasurementModel, *, on_progress: OnMessage = lambda _: None) -> LawChoice:
    """Compare a model's laws as baselines, without effects, by measurements that their fits have not seen.

    ValueError where the simplest has no answer.
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
    """A law as the baseline of some measurements. squares : of the predictions' errors, in SI."""

    constants: int
    chi2: float
    held_out: float
    squares: float
    points: int
    folds: str


def _compared(own: MeasurementModel) -> _Compared:
    """ValueError where there is no answer."""
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
    """A fit that is sharp enough to compare laws: where a law misses by much, the usual tolerance asks for
    many steps along constants that nearly hide each other."""
    z = model.residuals([start])[0]
    return fit(model, start, max_steps=STEPS, tolerance=max(TOLERANCE, SHARP * float(z @ z)))
