"""Which experiment would part causes that pokes cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import advice
from calibration.diagnosis.advice import Advice, from_nearest, gauged, measured
from calibration.diagnosis.experiments import Gauge
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Nested, State
from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.experiments import EXPERIMENTS, PokeTest
from calibration.errors import InputError
from calibration.experiment.model import PokeTrial

Array = NDArray[np.float64]

ENOUGH = 25.0  # of chi-square: rivals that part by 5 standard deviations are separated


class Pokes(Nested, Protocol):
    """What advice needs of a model of pokes."""

    records: Sequence[Record]

    def measuring(self, trials: Sequence[PokeTrial]) -> Self: ...

    def forces(self, state: State) -> list[Array]: ...


def advise(model: Pokes, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: of those that part the first of these explanations from all
    others the cheapest (the catalogue's order), else the one that comes nearest to it."""

    def apart(e: PokeTest | Gauge, first: Explanation, others: Sequence[Explanation]) -> Sequence[float]:
        if isinstance(e, Gauge):
            return gauged(e.sds, first, others)
        return measured(_predicted(model, e, first.fit.state), first, others)

    return advice.advise(EXPERIMENTS, rivals, apart, enough=ENOUGH, rank=from_nearest)


def _predicted(model: Pokes, test: PokeTest, state: State) -> Nested | None:
    """The same specimens in a new test, as a state predicts it; None where there is no force."""
    trials = test.of_each(model.records)
    if not trials:
        return None
    try:
        new = model.measuring(trials)
        predicted = new.forces(state)
    except (InputError, ValueError):
        return None  # no room for it on the block, or no equilibrium: not an experiment to advise
    new.records = [replace(r, force=p) for r, p in zip(new.records, predicted, strict=True)]
    new.retake(State(u=state.u))
    return new
