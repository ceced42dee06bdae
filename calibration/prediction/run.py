"""A prediction, and how cards make one."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import rms_of
from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.inference import WIDTH
from calibration.measurements._baseline import SCATTER
from calibration.measurements._contribution import FitContext
from calibration.measurements._kinds import Kind, compared
from calibration.measurements._kinds import models as models_of
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State
from calibration.measurements.outlines.simulators import TISIM
from calibration.parameters import OPTIONS
from calibration.prediction._cards import (
    CardFile,
    CardModel,
    baseline_model,
    extended_model,
    read_cards,
)
from calibration.prediction._interval import Calibrated, Record, predict_records
from calibration.progress import OnMessage

Array = NDArray[np.float64]

Name = Literal["baseline", "extended"]
BASELINE: Final = "baseline"
EXTENDED: Final = "extended"
NAMES: tuple[Name, ...] = (BASELINE, EXTENDED)
SAME_MODULUS = 1e-4  # of ln G: cards have six digits
NARROW = 0.8  # of the points in their 95 % intervals, below which these are said to be too narrow


@dataclass(frozen=True, eq=False, kw_only=True)
class Prediction:
    """Measured against predicted for trials that no model was fitted to.

    Attributes
    ----------
    experiment : whose trials were predicted.
    source : description of the source of the models ("cards in DIR", "a fit to a, b").
    labels : labels of the models that predict, by name: baseline and extended, or one of them.
    model_errors : relative, by model and material.
    shear_moduli : [Pa], by model and material.
    records : measured and predicted.
    notes : sentences for the reader.
    seconds : that it took.
    fitted : True if the models were fitted to this very experiment.
    """

    experiment: Experiment
    source: str
    labels: Mapping[Name, str]
    model_errors: Mapping[str, Mapping[str, float]]
    shear_moduli: Mapping[str, Mapping[str, float]]
    records: Sequence[Record]
    notes: tuple[str, ...] = ()
    seconds: float = 0.0
    fitted: bool = False

    @property
    def models(self) -> tuple[Name, ...]:
        return tuple(self.labels)

    def of_kind(self) -> dict[str, list[Record]]:
        """Records by kind of measurement: units differ between kinds."""
        found: dict[str, list[Record]] = {}
        for r in self.records:
            found.setdefault(r.kind, []).append(r)
        return found

    def rms(self, records: Sequence[Record], model: str) -> float:
        """Root mean square of predicted minus measured over the records' points [SI]."""
        return rms_of(r.error(model) for r in records)

    def noise(self, records: Sequence[Record]) -> float:
        """Expected `rms` of noise alone [SI]."""
        return rms_of(r.sd(self.models[-1], "noise") for r in records)

    def skill(self, records: Sequence[Record]) -> float | None:
        """(rms_base^2 - rms_ext^2) / (rms_base^2 - rms_noise^2): the fraction of what the baseline gets wrong
        beyond noise that the extension takes away. None without both, or where there is nothing to take."""
        if set(self.models) != {BASELINE, EXTENDED}:
            return None
        base, ext = self.rms(records, BASELINE), self.rms(records, EXTENDED)
        explainable = base**2 - self.noise(records) ** 2
        return (base**2 - ext**2) / explainable if explainable > 0.0 else None

    def coverage(self, records: Sequence[Record], model: str) -> float:
        """Fraction of the points that lie within their 95 % intervals."""
        inside = [np.abs(r.error(model)) <= WIDTH * r.sd(model) for r in records]
        return float(np.mean(np.concatenate(inside)))

    def sentence(self) -> str:
        """Results by kind of measurement, as text."""
        said = []
        for kind, mine in self.of_kind().items():
            unit, per_si = mine[0].shown.unit
            trials = len({r.trial for r in mine})
            *others, best = (
                f"the {m} model{_named(m, self.labels[m])} is off by {per_si * self.rms(mine, m):.3g} {unit}"
                for m in self.models
            )
            skill, inside = self.skill(mine), self.coverage(mine, self.models[-1])
            quality = "" if skill is None else f" (skill {skill:.2f})"
            unseen = ", to which the models were fitted" if self.fitted else " that no model was fitted to"
            text = (
                f"In {trials} trial{'s' * (trials > 1)} ({kind}){unseen}, {best} rms"
                f"{''.join(f', {o}' for o in others)}, and noise alone would be"
                f" {per_si * self.noise(mine):.3g} {unit}{quality}. {inside:.0%} of the points lie within the"
                " 95 % intervals"
            )
            said.append(f"{text}{', which are too narrow there' if inside < NARROW else ''}.")
        return " ".join(said)


def _named(model: str, label: str) -> str:
    return "" if label == model else f" ({label})"


def from_cards(
    cards: Path,
    experiment: Experiment,
    *,
    baseline: Path | None = None,
    domain: str | None = None,
    specimen_scatter: float | None = None,
    workers: int | None = None,
    source: str = "",
    unseen: bool = False,
    on_progress: OnMessage = lambda _: None,
) -> Prediction:
    """All trials of an experiment whose material has a card, predicted from the cards.

    Parameters
    ----------
    cards : folder of cards, or one.
    baseline : cards that stand beside them in place of the baseline that they state.
    domain : the kind of measurement, where not all are wanted.
    specimen_scatter : sd of ln G of a specimen that is named; that of a careful lab where left out.
    source : description of the source of the models.
    unseen : True where the cards were fitted to other trials of this experiment.

    Raises
    ------
    InputError : a card, or a trial, cannot be used.
    """
    begun = time.monotonic()
    known = read_cards(cards)
    yardstick = read_cards(baseline) if baseline is not None else {}
    scatter = SCATTER if specimen_scatter is None else specimen_scatter
    wanted = [m for m in dict.fromkeys(t.material for t in experiment.trials) if m in known]
    if not wanted:
        used = ", ".join(dict.fromkeys(t.material for t in experiment.trials))
        raise InputError(f"{cards}: expected a card of {used}, found {', '.join(known)}")
    notes = [
        f"no card of {m}: its trials are not predicted"
        for m in dict.fromkeys(t.material for t in experiment.trials)
        if m not in known
    ]
    records: list[Record] = []
    labels: dict[Name, str] = {}
    errors: dict[str, dict[str, float]] = {}
    moduli: dict[str, dict[str, float]] = {}
    of_material = {m: _of_card(known[m], yardstick.get(m)) for m in wanted}
    if any(len(models) == len(NAMES) for models in of_material.values()):
        # what was found in one material only leaves another's model as it was
        of_material = {
            m: {**models, EXTENDED: models[BASELINE]} if set(models) == {BASELINE} else models
            for m, models in of_material.items()
        }
    for material, models in of_material.items():
        for name, m in models.items():
            old = labels.get(name, m.label)
            if m.label == BASELINE:
                labels.setdefault(name, old)
            else:
                labels[name] = m.label if old in (m.label, BASELINE) else f"{old}, {m.label}"
            errors.setdefault(name, {})[material] = m.model_error
            moduli.setdefault(name, {})[material] = m.law.moduli(m.u).shear_modulus
            notes += m.notes
        mine = replace(experiment, trials=tuple(t for t in experiment.trials if t.material == material))
        for kind, own in compared(mine):
            if domain not in (None, kind.name, kind.old_name):
                continue
            on_progress(f"predicting {kind.name} of {material}")
            predicted, outside = _by_cards(kind, own, models, scatter, workers)
            records += predicted
            notes += outside
    if not records:
        raise InputError(
            f"{experiment.folder / 'experiment.yaml'}: trials: expected some that can be compared"
            + ("" if domain is None else f" as {domain}")
        )
    fitted = not unseen and any(_is_fit(known[r.material], r, experiment) for r in records)
    if fitted:
        notes.append("the cards were fitted to these measurements: this is a fit, not a prediction")
    if len({frozenset(r.predicted) for r in records}) > 1:
        raise InputError(f"{cards}: expected a baseline in all cards, or in none")
    return Prediction(
        experiment=experiment,
        source=source or f"cards in {cards}",
        labels={n: labels[n] for n in NAMES if n in labels},
        model_errors=errors,
        shear_moduli=moduli,
        records=records,
        notes=tuple(dict.fromkeys(notes)),
        seconds=time.monotonic() - begun,
        fitted=fitted,
    )


def _is_fit(card: CardFile, record: Record, experiment: Experiment) -> bool:
    """True if a card was fitted to measurements of this kind in this experiment."""
    origin = card.origin
    if origin is None or not origin.sha256 or not experiment.digest.startswith(origin.sha256):
        return False
    return not origin.kinds or record.kind in origin.kinds


def _of_card(card: CardFile, yardstick: CardFile | None) -> dict[Name, CardModel]:
    """The models that a card has: one, if it has no effects and parts, and the modulus of its baseline.

    With another modulus, a fault of the rig or of the camera was found, and taken out of it.
    """
    extended = extended_model(card)
    base = baseline_model(card) if yardstick is None else replace(extended_model(yardstick), label=BASELINE)
    if base is None:
        return {EXTENDED: extended}
    if yardstick is not None or card.effects or extended.law.parts:
        return {BASELINE: base, EXTENDED: extended}
    moved = extended.u[0] - base.u[0]  # of ln G
    if extended.law.law == base.law.law and abs(moved) < SAME_MODULUS:
        return {BASELINE: base}
    note = (
        f"the modulus of {card.material} differs by {100.0 * (np.exp(moved) - 1.0):+.2g} % from that of its"
        " baseline, since faults of the rig or the camera were taken out of its measurements"
    )
    return {
        BASELINE: base,
        EXTENDED: replace(extended, label="corrected for the rig", notes=(*extended.notes, note)),
    }


def _by_cards(
    kind: Kind,
    own: Experiment,
    models: Mapping[Name, CardModel],
    scatter: float,
    workers: int | None,
) -> tuple[list[Record], list[str]]:
    """Records with their predictions, and notes: what is not compared of them, and where they lie outside of
    what the cards' effects were measured in."""
    parts: dict[Name, list[tuple[MeasurementModel, Calibrated]]] = {}
    not_compared: dict[str, None] = {}
    records: list[Record] = []
    tests: list[MeasurementModel] = []
    try:
        for name, m in models.items():
            _check_parts(kind, own, m)
            made, left_out = models_of(kind, own, FitContext(law=m.law, simulator=TISIM, workers=workers))
            parts[name] = [(model, _from_card(model, m, scatter)) for model in made]
            not_compared |= dict.fromkeys(left_out)
        for some in zip(*parts.values(), strict=True):
            tests.append(some[0][0])
            records += predict_records(some[0][0], dict(zip(parts, some, strict=True)))
    except ValueError as error:
        ids = ", ".join(t.id for t in own.trials)
        raise InputError(f"trials {ids}: the cards predict nothing of them: {error}") from error
    known = [m for m in models.values() if m.ranges]
    outside = {
        f"{own.trials[0].material}: {text}": None
        for m in known
        for name, seen in m.ranges.items()
        for text in beyond(name, seen, [x for t in tests for r in t.records for x in r.ranges.get(name, ())])
    }
    return records, [*(f"not used: {x}" for x in not_compared), *(f"{x}; {UNSEEN}" for x in outside)]


UNSEEN = "there the model's error may be larger than the intervals know"
BEYOND = 0.02  # of a range that was fitted: a prediction further outside is said


def beyond(name: str, seen: Sequence[float], here: Sequence[float]) -> list[str]:
    """A text if a quantity is predicted outside the range in which it was fitted (`seen`); else empty."""
    if not here:
        return []
    low, high, slack = min(seen), max(seen), BEYOND * (max(seen) - min(seen))
    if min(here) >= low - slack and max(here) <= high + slack:
        return []
    return [f"{name} {min(here):.3g} to {max(here):.3g} is predicted from {low:.3g} to {high:.3g}"]


def _from_card(model: MeasurementModel, card: CardModel, scatter: float) -> Calibrated:
    """Coordinates of the measurement model beside the card's have their prior."""
    extras = model.baseline.extras
    size = len(model.names)
    law = slice(0, size - len(extras))
    covariance = np.zeros((size, size))
    covariance[law, law] = card.covariance
    covariance[range(law.stop, size), range(law.stop, size)] = [e.sd**2 for e in extras]
    return Calibrated(
        label=card.label,
        state=State(u=np.concatenate([card.u, [e.centre for e in extras]])),
        parameters=covariance,
        specimens=np.zeros_like(covariance),
        model_error=card.model_error,
        unseen_scatter=scatter,
    )


def _check_parts(kind: Kind, own: Experiment, card: CardModel) -> None:
    """InputError where a kind of measurement does not follow what a material has beside its law."""
    follows = None if kind.over_time is None else kind.over_time()
    for part in card.law.parts:
        option = OPTIONS[part.field]
        if follows is None or option not in follows.options:
            why = "which do not follow it yet" if follows is None else follows.why_not
            raise InputError(f"trial {own.trials[0].id}: {part.field}: expected no {kind.name}, {why}")
