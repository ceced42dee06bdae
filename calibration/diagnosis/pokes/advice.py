"""Which experiment would part causes that pokes cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import State
from calibration.diagnosis.pokes.experiments import EXPERIMENTS, Gauge, Test
from calibration.diagnosis.pokes.model import PokeModel
from calibration.errors import InputError

Array = NDArray[np.float64]

ENOUGH = 25.0  # of chi-square: rivals that part by 5 standard deviations are separated


@dataclass(frozen=True, kw_only=True)
class Advice:
    """An experiment, and by how much chi-square it would part the chosen cause from its nearest rival."""

    name: str
    sentence: str
    separation: float


def advise(model: PokeModel, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: of those that part the first of these explanations from all
    others the cheapest (the catalogue's order), else the one that comes nearest to it."""
    first, others = rivals[0], rivals[1:]
    found: list[Advice] = []
    for e in EXPERIMENTS:
        if isinstance(e, Gauge):
            apart = min((_gauged(e, first, other) for other in others), default=0.0)
        else:
            apart = _tested(model, e, first, others)
        found.append(Advice(name=e.name, sentence=e.sentence, separation=apart))
    order = {a.name: k for k, a in enumerate(found)}
    return sorted(found, key=lambda a: (-min(a.separation, ENOUGH), order[a.name]))


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


def _tested(model: PokeModel, test: Test, first: Explanation, others: Sequence[Explanation]) -> float:
    """What new tests add to the least squared distance between the first explanation's predictions and any
    other's, whose free coordinates may adapt to old and new data alike."""
    specimens = dict.fromkeys(r.specimen for r in model.records)
    trials = [t for s in specimens for t in test.trials([r for r in model.records if r.specimen == s])]
    if not trials:
        return 0.0
    try:
        new = model.measuring(trials)
        predicted = new.forces(first.fit.state)
    except (InputError, ValueError):
        return 0.0  # no room for it on the block, or no equilibrium: not an experiment to advise
    new.records = [replace(r, force=p) for r, p in zip(new.records, predicted, strict=True)]
    new.retake(State(u=first.fit.state.u))
    least = np.inf
    for other in others:
        linear = new.linearise(other.fit.state, other.candidates)
        old = other.fit.z - first.fit.z
        m = new.points  # the prior's rows are in the old data already
        jacobian = np.column_stack([linear.by_u, linear.columns])[:m]
        both = np.vstack([other.fit.jacobian, jacobian])
        apart = _left(np.concatenate([old, linear.z[:m]]), both) - _left(old, other.fit.jacobian)
        least = min(least, apart)
    return float(least) if np.isfinite(least) else 0.0


def _left(values: Array, jacobian: Array) -> float:
    size = np.linalg.norm(jacobian, axis=0)
    q, _ = np.linalg.qr(jacobian[:, size > 0] / size[size > 0])
    return float(values @ values - np.sum((q.T @ values) ** 2))
