"""Which experiment would part causes that bars cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, Self

from calibration.diagnosis import advice
from calibration.diagnosis.advice import Advice, from_most, gauged, measured
from calibration.diagnosis.bars.experiments import EXPERIMENTS, Release
from calibration.diagnosis.experiments import Gauge
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Nested, State

ENOUGH = 60.0  # of chi-square: rivals part there by more than a verdict asks, whatever the noise


class Bars(Nested, Protocol):
    """What advice needs of a model of bars."""

    def released_anew(self, release: Release, state: State) -> Self | None: ...


def advise(model: Bars, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: that which parts the first of these explanations from most
    others; of several the cheapest (in the catalogue's order)."""

    def apart(e: Release | Gauge, first: Explanation, others: Sequence[Explanation]) -> Sequence[float]:
        if isinstance(e, Gauge):
            return gauged(e.sds, first, others)
        return measured(model.released_anew(e, first.fit.state), first, others)

    return advice.advise(EXPERIMENTS, rivals, apart, enough=ENOUGH, rank=from_most)
