"""Choose an experiment that separates equivalent explanations, by the distance of their predictions."""

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
    """An experiment, with its separation of the chosen explanation from each of the others.

    Attributes
    ----------
    separations : increase of chi-square for each other explanation; inf if it has no equilibrium in this
        experiment, which would be visible at once.
    enough : separation from which on two explanations count as separated.
    """

    name: str
    sentence: str
    separations: tuple[float, ...]
    enough: float

    @property
    def separation(self) -> float:
        """Separation from the closest explanation with an equilibrium; 0 if there is none."""
        return min((s for s in self.separations if np.isfinite(s)), default=0.0)

    @property
    def separated(self) -> float:
        """Number of explanations separated from the chosen one; partial separations count as fractions."""
        return sum(min(s / self.enough, 1.0) for s in self.separations)


def advise(model: MeasurementModel, explanations: Sequence[Explanation]) -> list[Advice]:
    """All experiments of a model, in order of their value.

    If `model.separates` is "all", experiments are ordered by the separation from the closest explanation, up
    to `enough`; if it is "most", by the number of separated explanations, since no experiment may separate
    all. Of equal experiments the cheapest comes first (the order of `model.experiments`).
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
    """Sentence on the best experiment; "" if the model has none."""
    if not model.experiments:
        return ""
    best = advise(model, explanations)[0]
    return (all_parted if model.separates == "all" else most_parted)(best, explanations)


def gauged(sds: Mapping[str, float], first: Explanation, others: Sequence[Explanation]) -> list[float]:
    """Separations of the first explanation from the others by a direct measurement of amplitudes.

    A separation is the squared difference of the amplitudes over the sum of their variances and that of the
    gauge; `sds` has the gauge's standard deviations [SI] by effect.
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
    """Separations of the first explanation from the others by new measurements.

    A separation is the increase of the least squared distance between the predictions of the two, over the
    free coordinates of the other, which are fitted to old and new data together. `new` is the model of the
    new measurements as the first explanation predicts them; None if they cannot be made.
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
    """Sentence on the best experiment, if all explanations are to be separated."""
    names = ", ".join(_told_apart(explanations))
    if best.separation < 1.0:
        return f"no experiment of the catalogue parts {names}"
    apart = float(np.sqrt(best.separation))
    sure = _sure(best, best.separation)
    return f"{best.sentence}: {names} part there by {apart:.0f} standard deviations{sure}"


def most_parted(best: Advice, explanations: Sequence[Explanation]) -> str:
    """Sentence on the best experiment, if it may separate the chosen cause from some others only."""
    first, *others = _told_apart(explanations)
    parted = [n for n, s in zip(others, best.separations, strict=True) if s >= 1.0]
    if not parted:
        return f"no experiment of the catalogue parts {first} from {', '.join(others)}"
    apart = float(np.sqrt(min(s for s in best.separations if s >= 1.0)))
    left = [n for n in others if n not in parted]
    rest = f"; nothing of the catalogue parts it from {', '.join(left)}" if left else ""
    return (
        f"{best.sentence}: {first} parts there from {', '.join(parted)} by {apart:.0f} standard"
        f" deviations{_sure(best, apart**2)}{rest}"
    )


def _told_apart(explanations: Sequence[Explanation]) -> list[str]:
    """Names of each explanation, without the causes common to all."""
    common = set.intersection(*(set(e.names) for e in explanations))
    return [" + ".join([n for n in e.names if n not in common] or e.names) for e in explanations]


def _sure(best: Advice, separation: float) -> str:
    return "" if separation >= best.enough else ", which will help but may not settle it"
