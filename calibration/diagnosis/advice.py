"""Which experiment would part causes that the data cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Nested

Array = NDArray[np.float64]


class Experiment(Protocol):
    """sentence: what to do."""

    @property
    def name(self) -> str: ...

    @property
    def sentence(self) -> str: ...


@dataclass(frozen=True, kw_only=True)
class Advice:
    """An experiment, and by how much chi-square it would part the chosen cause from each of its rivals (inf:
    the rival has no answer there, and would be seen at once). enough: from where on two are parted."""

    name: str
    sentence: str
    separations: tuple[float, ...]
    enough: float

    @property
    def separation(self) -> float:
        """From the nearest rival that has an answer; 0 where none has."""
        return min((s for s in self.separations if np.isfinite(s)), default=0.0)

    @property
    def worth(self) -> float:
        """Rivals that it would part from the chosen cause, those that it parts in part counted so."""
        return sum(min(s / self.enough, 1.0) for s in self.separations)


def from_nearest(advice: Advice) -> float:
    """A rank: experiments that part all rivals are alike, others come by the nearest."""
    return min(advice.separation, advice.enough)


def from_most(advice: Advice) -> float:
    """A rank: by how many rivals are parted, since no experiment may part all."""
    return round(advice.worth, 2)


ExperimentT = TypeVar("ExperimentT", bound=Experiment)
Apart = Callable[[ExperimentT, Explanation, Sequence[Explanation]], Sequence[float]]


def advise(
    experiments: Sequence[ExperimentT],
    rivals: Sequence[Explanation],
    apart: Apart[ExperimentT],
    *,
    enough: float,
    rank: Callable[[Advice], float],
) -> list[Advice]:
    """All experiments, the advised one first: of the highest rank, and of several the cheapest (in the
    catalogue's order). apart: by how much each parts the first of these explanations from the others."""
    first, others = rivals[0], rivals[1:]
    found = [
        Advice(name=e.name, sentence=e.sentence, separations=tuple(apart(e, first, others)), enough=enough)
        for e in experiments
    ]
    return sorted(found, key=lambda a: -rank(a))  # stable


def gauged(sds: Mapping[str, float], first: Explanation, others: Sequence[Explanation]) -> list[float]:
    """By how much a direct measurement parts the first explanation from each other: squared distance of their
    amplitudes, in the gauge's sd and theirs. sds [SI] of the gauge, by effect."""
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


def measured(new: Nested | None, first: Explanation, others: Sequence[Explanation]) -> list[float]:
    """What new measurements add to the least squared distance between the first explanation's predictions and
    each other's, whose free coordinates may adapt to old and new data alike.

    new: the model of these measurements, as the first explanation predicts them; None where they cannot be
    made.
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


def all_parted(best: Advice, rivals: Sequence[Explanation]) -> str:
    """The advised experiment for people, where all rivals are to be parted."""
    names = ", ".join(" + ".join(e.names) for e in rivals)
    if best.separation < 1.0:
        return f"no experiment of the catalogue parts {names}"
    apart = float(np.sqrt(best.separation))
    sure = _sure(best, best.separation)
    return f"{best.sentence}: {names} part there by {apart:.0f} standard deviations{sure}"


def most_parted(best: Advice, rivals: Sequence[Explanation]) -> str:
    """The advised experiment for people, which may part the chosen cause from some rivals only."""
    first, *others = (" + ".join(e.names) for e in rivals)
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


def _sure(best: Advice, separation: float) -> str:
    return "" if separation >= best.enough else ", which will help but may not settle it"
