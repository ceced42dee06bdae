"""Which experiment would part causes that coupons cannot: by how far their predictions part there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import advice
from calibration.diagnosis.advice import Advice, from_most, gauged, measured
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.experiments import EXPERIMENTS, CouponTest
from calibration.diagnosis.experiments import Gauge
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.nested import Nested, State
from calibration.experiment.model import CouponTrial

Array = NDArray[np.float64]

ENOUGH = 60.0  # of chi-square: such rivals part in the test by more than a verdict asks, whatever its noise


class Coupons(Nested, Protocol):
    """What advice needs of a model of coupons."""

    records: Sequence[Record]

    def measuring(self, trials: Sequence[CouponTrial]) -> Self: ...

    def stresses(self, state: State) -> list[Array]: ...


def advise(model: Coupons, rivals: Sequence[Explanation]) -> list[Advice]:
    """All experiments, the advised one first: that which parts the first of these explanations from most
    others; of several the cheapest (in the catalogue's order)."""

    def apart(e: CouponTest | Gauge, first: Explanation, others: Sequence[Explanation]) -> Sequence[float]:
        if isinstance(e, Gauge):
            return gauged(e.sds, first, others)
        return measured(_predicted(model, e, first.fit.state), first, others)

    return advice.advise(EXPERIMENTS, rivals, apart, enough=ENOUGH, rank=from_most)


def _predicted(model: Coupons, test: CouponTest, state: State) -> Nested | None:
    """The same specimens in a new test, as a state predicts it; None where there is no stress."""
    trials = test.of_each(model.records)
    if not trials:
        return None
    new = model.measuring(trials)
    predicted = new.stresses(state)
    if not all(np.isfinite(p).all() for p in predicted):
        return None
    new.records = [replace(r, stress=p) for r, p in zip(new.records, predicted, strict=True)]
    return new
