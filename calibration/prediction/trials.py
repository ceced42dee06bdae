"""A prediction of some trials of an experiment from a fit to others."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis._card_numbers import model_error
from calibration.diagnosis.engine.fitting import Fit, fit
from calibration.errors import InputError, OptionError
from calibration.experiment.model import Experiment, Trial
from calibration.measurements._effect import Candidate
from calibration.measurements._kinds import Kind, kind_of
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise_known import NoiseKnown
from calibration.measurements._state import State
from calibration.prediction._interval import Calibrated, all_moduli, of_unseen, predict_records
from calibration.prediction.run import (
    BASELINE,
    EXTENDED,
    UNSEEN,
    Name,
    Prediction,
    beyond,
    from_cards,
)
from calibration.progress import OnMessage

Rows = NDArray[np.bool_]
Make = Callable[..., MeasurementModel]


def from_trials(
    experiment: Experiment,
    fitted: Sequence[Trial],
    wanted: Sequence[Trial],
    *,
    domain: str | None = None,
    law: str = "auto",
    extend: Sequence[str] = (),
    seed: int = 0,
    workers: int | None = None,
    on_progress: OnMessage = lambda _: None,
) -> Prediction:
    """Trials of an experiment, predicted from a diagnosis of others: its baseline, and the causes that it
    names. Trials of another kind of measurement, and others that its model does not take, are predicted from
    the cards that it would write.

    Parameters
    ----------
    fitted, wanted : its trials to fit, and those to predict.
    domain : the kind of measurement of the fit, where it is not plain.
    law : law of the diagnosis' baseline, as `calibration.diagnose` takes it.
    extend : effects of the extension, in place of a search for them.

    Raises
    ------
    InputError : trials cannot be fitted or predicted.
    """
    begun = time.monotonic()
    ours = replace(experiment, trials=tuple(fitted))
    theirs = replace(experiment, trials=tuple(wanted))
    kind = kind_of(ours, domain)
    source = f"a fit to {', '.join(t.id for t in fitted)}"
    for t in wanted:
        if t.material not in {f.material for f in fitted}:
            raise InputError(f"trial {t.id}: material {t.material}: expected one of the trials to fit")
    if _same_model(kind, theirs):
        found = _within(
            kind,
            experiment,
            fitted,
            wanted,
            law=law,
            extend=extend,
            seed=seed,
            workers=workers,
            on_progress=on_progress,
        )
        return replace(found, source=source, seconds=time.monotonic() - begun)
    if extend:
        raise OptionError("extend", ", ".join(extend), "expected trials of one kind of measurement")
    from calibration.diagnosis import Rules, model_of
    from calibration.diagnosis.card import write_cards
    from calibration.diagnosis.laws import diagnose_with_law

    make = partial(model_of, ours, kind=kind.name, workers=workers)
    try:
        diagnosis, _ = diagnose_with_law(
            make, law=law, rules=Rules(seed=seed), gain=False, on_progress=on_progress
        )
    except ValueError as error:  # the baseline has no equilibrium anywhere
        raise InputError(f"{ours.folder}: the baseline cannot be calibrated: {error}") from error
    with tempfile.TemporaryDirectory(prefix="calibration-") as folder:
        write_cards(Path(folder), diagnosis, ours)
        found = from_cards(
            Path(folder), theirs, workers=workers, source=source, unseen=True, on_progress=on_progress
        )
    notes = (diagnosis.sentence(), *found.notes)
    return replace(found, notes=notes, seconds=time.monotonic() - begun)


def _same_model(kind: Kind, wanted: Experiment) -> bool:
    """True if the model of a kind takes the trials to predict: it knows more than cards say."""
    try:
        return kind_of(wanted, kind.name) is kind and kind.whole(wanted)
    except InputError:
        return False


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fitted:
    """Fits to the trials that are fitted, by name; the model's options; what was found, for people; their
    noise; fits of what the trials cannot tell from the extension."""

    model: MeasurementModel
    options: dict[str, Any]
    fits: dict[Name, Fit]
    sentence: str
    noise: NoiseKnown
    alternatives: tuple[Fit, ...] = ()


def _searched(make: Make, *, law: str, seed: int, on_progress: OnMessage) -> _Fitted:
    """By a diagnosis."""
    from calibration.diagnosis import Rules
    from calibration.diagnosis.laws import diagnose_with_law

    asked: dict[int, dict[str, Any]] = {}

    def noted(**options: Any) -> MeasurementModel:
        made = make(**options)
        asked[id(made)] = options
        return made

    found, model = diagnose_with_law(
        noted, law=law, rules=Rules(seed=seed), gain=False, on_progress=on_progress
    )
    fits: dict[Name, Fit] = {BASELINE: found.finding.baseline}
    alternatives: tuple[Fit, ...] = ()
    if found.chosen is not None:
        fits[EXTENDED] = found.chosen.fit
        alike = set(found.finding.equivalent) - {found.chosen.names}
        best = {e.names: e.fit for e in sorted(found.finding.explanations, key=lambda e: -e.score)}
        alternatives = tuple(best[names] for names in sorted(alike))
    return _Fitted(
        model=model,
        options=asked[id(model)],
        fits=fits,
        sentence=found.sentence(),
        noise=found.noise,
        alternatives=alternatives,
    )


def _stated(make: Make, *, law: str, effects: Sequence[str], on_progress: OnMessage) -> _Fitted:
    """Fit with the requested effects, each in all trials that can have it, in its best variant."""
    from calibration.diagnosis.catalogue import true_name
    from calibration.diagnosis.laws import AUTO, law_of

    options: dict[str, Any] = {} if law == AUTO else dict(zip(("law", "terms"), law_of(law), strict=True))
    model = make(**options)
    names = [true_name(model.kind, n) for n in effects]
    shared = list(dict.fromkeys(c.effect for c in model.candidates if c.at == "all"))

    def unknown(name: str) -> OptionError:
        text = f"expected effects that these trials can show, of {', '.join(shared)}"
        return OptionError("extend", name, text)

    for name in names:  # before the fits, which take minutes
        if name not in shared:
            raise unknown(name)
    on_progress("fitting the baseline")
    known = model.settle_noise("stated")
    start = State(u=model.start())
    model.update_nuisances(start)
    base = best = fit(model, start)
    for name in names:
        on_progress(f"fitting {name}")
        forms = [
            c for c in model.candidates if c.effect == name and c.at == "all" and model.visible.get(c, True)
        ]
        tried = [f for c in forms if (f := _with(model, best, c)) is not None]
        if not tried:
            raise unknown(name)
        best = min(tried, key=lambda f: f.chi2)
    return _Fitted(
        model=model,
        options=options,
        fits={BASELINE: base, EXTENDED: best},
        sentence=f"The extension was asked for, not found: {best.label}.",
        noise=known,
    )


STARTS = (0.0, 0.03, 0.3)  # of the way to a bound: a fit may end in the wrong valley from one of them


def _with(model: MeasurementModel, before: Fit, candidate: Candidate) -> Fit | None:
    """The best fit with one effect more; None where it has no answer."""
    tried = []
    for amplitude in dict.fromkeys(
        part * end for end in model.effects[candidate.effect].bounds for part in STARTS
    ):
        start = replace(before.state, amplitudes={**before.state.amplitudes, candidate: amplitude})
        try:
            tried.append(fit(model, start, (*before.candidates, candidate)))
        except ValueError:
            continue
    return min(tried, key=lambda f: f.chi2, default=None)


def _within(
    kind: Kind,
    experiment: Experiment,
    fitted: Sequence[Trial],
    wanted: Sequence[Trial],
    *,
    law: str,
    extend: Sequence[str],
    seed: int,
    workers: int | None,
    on_progress: OnMessage,
) -> Prediction:
    """The diagnosis' model once more, of all these trials, of which a part is fitted: coordinates and effects
    are the same."""
    from calibration.diagnosis import model_of

    def make(**options: Any) -> MeasurementModel:
        own = replace(experiment, trials=tuple(fitted))
        return model_of(own, kind=kind.name, workers=workers, **options)

    ids = {t.id for t in wanted}
    some = ids | {t.id for t in fitted}
    together = replace(experiment, trials=tuple(t for t in experiment.trials if t.id in some))
    notes = []
    try:
        if extend:
            found = _stated(make, law=law, effects=extend, on_progress=on_progress)
        else:
            found = _searched(make, law=law, seed=seed, on_progress=on_progress)
        model = model_of(together, kind=kind.name, workers=workers, **found.options)
        fold = np.isin(model.row_record, [k for k, r in enumerate(model.records) if r.groups["trial"] in ids])
        train = model.subset(fold, others=True)
        train.take_noise(found.noise)
        on_progress("predicting")

        def ahead() -> MeasurementModel:
            test = model.subset(fold, others=False)
            test.take_noise(found.noise, predicted=True)
            return test

        def again(old: Fit, name: str) -> tuple[MeasurementModel, Calibrated]:
            known = dict(zip(found.model.names, old.state.u, strict=True))
            u = np.array([known.get(n, x) for n, x in zip(model.names, model.start(), strict=True)])
            start = replace(old.state, u=u)
            train.update_nuisances(start)
            new = fit(train, start, old.candidates)
            if not new.converged:
                notes.append(f"the fit of {name} did not converge: {new.message}")
            return ahead(), _calibrated(model, fold, new, name)

        made: dict[Name, tuple[MeasurementModel, Calibrated]] = {
            name: again(old, name) for name, old in found.fits.items()
        }
        alternatives = [again(old, old.label) for old in found.alternatives]
        if alternatives:
            others = ", ".join(known.label for _, known in alternatives)
            notes.append(f"the trials that were fitted do not tell {made[EXTENDED][1].label} from {others}")
        records = predict_records(ahead(), made, {EXTENDED: alternatives} if alternatives else {})
    except ValueError as error:
        raise InputError(f"{experiment.folder}: the trials cannot be predicted: {error}") from error
    materials = model.baseline.materials
    return Prediction(
        experiment=replace(experiment, trials=tuple(wanted)),
        source="",
        labels={name: known.label for name, (_, known) in made.items()},
        model_errors={n: dict.fromkeys(materials, known.model_error) for n, (_, known) in made.items()},
        shear_moduli={n: model.shear_moduli(known.state.u) for n, (_, known) in made.items()},
        records=records,
        notes=(found.sentence, *notes, *_extrapolations(model, fold)),
    )


def _extrapolations(model: MeasurementModel, fold: Rows) -> list[str]:
    """In what the predicted records are unlike those that were fitted, a sentence each: there the model's
    error may be larger than the fit shows."""
    ahead = set(np.unique(model.row_record[fold]).tolist())
    wanted = [r for k, r in enumerate(model.records) if k in ahead]
    fitted = [r for k, r in enumerate(model.records) if k not in ahead]
    found: dict[str, None] = {}
    for r in wanted:
        for level, label in r.groups.items():
            if level in ("material", "specimen", "trial"):
                continue
            if label not in {f.groups.get(level) for f in fitted}:
                found[f"{level} {label}"] = None
    for name in dict.fromkeys(n for r in wanted for n in r.ranges):
        seen = [x for f in fitted for x in f.ranges.get(name, ())]
        here = [x for r in wanted for x in r.ranges.get(name, ())]
        if not seen:
            found[f"{name} {min(here):.3g} to {max(here):.3g}"] = None
        else:
            found |= dict.fromkeys(beyond(name, seen, here))
    if not found:
        return []
    return [f"not among the trials that were fitted: {', '.join(found)}; {UNSEEN}"]


def _calibrated(model: MeasurementModel, fold: Rows, found: Fit, name: str) -> Calibrated:
    """Result of a fit to all rows but those of a fold.

    If it leaves more than noise, its covariance is scaled by the reduced chi-square, but not the scatter
    between specimens of a material.
    """
    jacobian = found.jacobian
    specimens = of_unseen(model, fold, jacobian)
    used = int(np.count_nonzero(np.linalg.norm(jacobian, axis=0)))
    reduced = found.chi2 / max(len(found.z) - used, 1)
    return Calibrated(
        label=found.label if found.candidates else name,
        state=found.state,
        candidates=found.candidates,
        parameters=(found.covariance() - specimens) * max(reduced, 1.0),
        specimens=specimens,
        model_error=model_error(found, all_moduli(model, found.state.u)),
    )
