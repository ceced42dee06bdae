"""Choice of the next experiment: the one whose predictions differ most between equivalent explanations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.explanation import Explanation
from calibration.measurements._design import Gauge
from calibration.measurements._model import MeasurementModel

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Advice:
    """An experiment, and how far it would separate the chosen explanation from each of the others.

    Attributes
    ----------
    name : name of the experiment.
    sentence : the experiment, for people.
    separations : expected increase of chi-square for each other explanation; inf if that has no solution in
        the experiment, which would be noticed at once.
    enough : separation from which on two explanations count as separated.
    """

    name: str
    sentence: str
    separations: tuple[float, ...]
    enough: float

    @property
    def separation(self) -> float:
        """Separation from the nearest explanation that has a solution; 0 if none has."""
        return min((s for s in self.separations if np.isfinite(s)), default=0.0)

    @property
    def separated(self) -> float:
        """Number of explanations that it separates from the chosen one; partial separations as fractions."""
        return sum(min(s / self.enough, 1.0) for s in self.separations)


def advise(model: MeasurementModel, explanations: Sequence[Explanation]) -> list[Advice]:
    """All experiments of a model, the recommended one first.

    If `model.separates` is "all", they are ranked by the separation from the nearest explanation, up to
    `model.enough`. If it is "most", they are ranked by the number of separated explanations, since possibly
    no experiment separates all. Ties are in the order of `model.experiments`, cheapest first.
    """
    first, others = explanations[0], explanations[1:]
    found = []
    for e in model.experiments:
        if isinstance(e, Gauge):
            apart = gauged(e.sds, first, others)
        else:
            apart = measured(model.predicted_in(e, first.fit.state), first, others)
        found.append(Advice(name=e.name, sentence=e.sentence, separations=tuple(apart), enough=model.enough))

    def rank(a: Advice) -> float:
        return min(a.separation, a.enough) if model.separates == "all" else round(a.separated, 2)

    return sorted(found, key=lambda a: -rank(a))  # stable


def advice(model: MeasurementModel, explanations: Sequence[Explanation]) -> str:
    """The recommended experiment in a sentence; "" if the model has no experiments."""
    if not model.experiments:
        return ""
    best = advise(model, explanations)[0]
    return (all_parted if model.separates == "all" else most_parted)(best, explanations)


def gauged(sds: Mapping[str, float], first: Explanation, others: Sequence[Explanation]) -> list[float]:
    """Separation of the first explanation from each other one by a direct measurement of amplitudes.

    It is the sum over effects of the squared difference of the amplitudes, divided by the sum of the
    variances of the gauge and of both amplitudes. `sds` are the gauge's standard deviations by effect [SI].
    """
    return [_gauged(sds, first, other) for other in others]


def _gauged(sds: Mapping[str, float], one: Explanation, other: Explanation) -> float:
    total = 0.0
    for effect, sd in sds.items():
        values, spread = [], sd**2
        for e in (one, other):
            mine = [e.fit.amplitude(c) for c in e.candidates if c.effect == effect]
            values.append(sum(v for v, _ in mine))
            spread += sum(s**2 for _, s in mine)
        total += (values[0] - values[1]) ** 2 / spread
    return total


def measured(new: MeasurementModel | None, first: Explanation, others: Sequence[Explanation]) -> list[float]:
    """Separation of the first explanation from each other one by new measurements.

    It is the increase of the minimum squared distance between the predictions of the two, over the other's
    free parameters, if the new measurements are added to the old ones.

    new : model of the new measurements, with the first explanation's predictions as data; None if they cannot
    be made, which gives separations of 0.
    """
    if new is None:
        return [0.0] * len(others)
    found = []
    for other in others:
        try:
            linear = new.linearise(other.fit.state, other.candidates)
        except ValueError:
            found.append(np.inf)
            continue
        old = other.fit.z - first.fit.z
        m = new.points  # the prior's rows are in the old data already
        jacobian = np.column_stack([linear.by_u, linear.columns])[:m]
        both = np.vstack([other.fit.jacobian, jacobian])
        found.append(_left(np.concatenate([old, linear.z[:m]]), both) - _left(old, other.fit.jacobian))
    return found


def _left(values: Array, jacobian: Array) -> float:
    size = np.linalg.norm(jacobian, axis=0)
    q, _ = np.linalg.qr(jacobian[:, size > 0] / size[size > 0])
    return float(values @ values - np.sum((q.T @ values) ** 2))


def all_parted(best: Advice, explanations: Sequence[Explanation]) -> str:
    """The recommended experiment in a sentence, if all explanations are to be separated."""
    names = ", ".join(_told_apart(explanations))
    if best.separation < 1.0:
        return f"no experiment of the catalogue parts {names}"
    apart = float(np.sqrt(best.separation))
    sure = _sure(best, best.separation)
    return f"{best.sentence}: {names} part there by {_deviations(apart)}{sure}"


def most_parted(best: Advice, explanations: Sequence[Explanation]) -> str:
    """The recommended experiment in a sentence, if it may separate the chosen cause from some others only."""
    first, *others = _told_apart(explanations)
    parted = [n for n, s in zip(others, best.separations, strict=True) if s >= 1.0]
    if not parted:
        return f"no experiment of the catalogue parts {first} from {', '.join(others)}"
    apart = float(np.sqrt(min(s for s in best.separations if s >= 1.0)))
    left = [n for n in others if n not in parted]
    rest = f"; nothing of the catalogue parts it from {', '.join(left)}" if left else ""
    return (
        f"{best.sentence}: {first} parts there from {', '.join(parted)} by {_deviations(apart)}"
        f"{_sure(best, apart**2)}{rest}"
    )


def _told_apart(explanations: Sequence[Explanation]) -> list[str]:
    """Names of each explanation's effects, without those common to all."""
    common = set.intersection(*(set(e.names) for e in explanations))
    return [" + ".join([n for n in e.names if n not in common] or e.names) for e in explanations]


def _deviations(apart: float) -> str:
    return f"{apart:.0f} standard deviation{'s' if round(apart) != 1 else ''}"


def _sure(best: Advice, separation: float) -> str:
    return "" if separation >= best.enough else ", which will help but may not settle it"
