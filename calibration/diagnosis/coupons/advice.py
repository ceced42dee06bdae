"""Which experiment would part causes that coupons cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons.experiments import EXPERIMENTS, Gauge, Test
from calibration.diagnosis.coupons.model import CouponModel
from calibration.diagnosis.explanation import Explanation

Array = NDArray[np.float64]

ENOUGH = 60.0  # of chi-square: such rivals part in the test by more than a verdict asks, whatever its noise


@dataclass(frozen=True, kw_only=True)
class Advice:
    """An experiment, and by how much chi-square it would part the chosen cause from each of its rivals."""

    name: str
    sentence: str
    separations: tuple[float, ...]

    @property
    def worth(self) -> float:
        """Rivals that it would part from the chosen cause, those that it parts in part counted so."""
        return sum(min(s / ENOUGH, 1.0) for s in self.separations)


def advise(model: CouponModel, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: that which parts the first of these explanations from most
    others; of several the cheapest (in the catalogue's order)."""
    first, others = rivals[0], rivals[1:]
    found = []
    for e in EXPERIMENTS:
        if isinstance(e, Gauge):
            apart = [_gauged(e, first, other) for other in others]
        else:
            apart = _tested(model, e, first, others)
        found.append(Advice(name=e.name, sentence=e.sentence, separations=tuple(apart)))
    order = {a.name: k for k, a in enumerate(found)}
    return sorted(found, key=lambda a: (-round(a.worth, 2), order[a.name]))


def _gauged(gauge: Gauge, one: Explanation, other: Explanation) -> float:
    """Squared distance of two explanations' amplitudes in what a gauge measures, in its sd and theirs."""
    total = 0.0
    for effect, sd in gauge.sds.items():
        values, spread = [], sd**2
        for e in (one, other):
            mine = [e.fit.amplitude(c) for c in e.candidates if c.effect == effect]
            values.append(sum(v for v, _ in mine))
            spread += sum(s**2 for _, s in mine)
        total += (values[0] - values[1]) ** 2 / spread
    return total


def _tested(model: CouponModel, test: Test, first: Explanation, others: Sequence[Explanation]) -> list[float]:
    """What new tests add to the least squared distance between the first explanation's predictions and each
    other's, whose free coordinates may adapt to old and new data alike."""
    specimens = dict.fromkeys(r.specimen for r in model.records)
    trials = [t for s in specimens for t in test.trials([r for r in model.records if r.specimen == s])]
    if not trials:
        return [0.0] * len(others)
    new = model.measuring(trials)
    predicted = new.stresses(first.fit.state)
    if not all(np.isfinite(p).all() for p in predicted):
        return [0.0] * len(others)
    new.records = [replace(r, stress=p) for r, p in zip(new.records, predicted, strict=True)]
    found = []
    for other in others:
        try:
            linear = new.linearise(other.fit.state, other.candidates)
        except ValueError:
            found.append(np.inf)  # the rival has no stress so far out: it would be seen at once
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
