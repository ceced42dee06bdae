"""What the pictures of coupons are drawn from: records with their simulated stresses, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.model import CouponModel
from calibration.diagnosis.drawing import DrawnCurve, shown_explanation
from calibration.diagnosis.verdict import Diagnosis

Array = NDArray[np.float64]

Kind = Literal["loading", "unloading", "loading again"]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRecord(DrawnCurve):
    """A record with the stress [Pa] that the baseline makes of its stretches, and the extension; None where
    there is none."""

    record: Record
    before: Array
    after: Array | None

    def branches(self) -> list[tuple[NDArray[np.bool_], Kind]]:
        """Points of each branch, and what it is."""
        found: list[tuple[NDArray[np.bool_], Kind]] = []
        unloaded = self.record.remembers
        for b in np.unique(self.record.branch):
            mine = self.record.branch == b
            if np.isfinite(self.record.turn[mine]).mean() > 0.5:
                found.append((mine, "unloading"))
                unloaded = True
            else:
                found.append((mine, "loading again" if unloaded else "loading"))
        return found


def drawn(model: CouponModel, diagnosis: Diagnosis) -> list[DrawnRecord]:
    """All records, with what stands for the extension."""
    shown = shown_explanation(diagnosis.finding, diagnosis.chosen)
    before = model.stresses(diagnosis.finding.baseline.state)
    after: Sequence[Array | None] = [None] * len(before) if shown is None else model.stresses(shown.fit.state)
    return [
        DrawnRecord(
            name=r.name,
            record=r,
            before=b,
            after=a,
            left_before=r.stress - b,
            left_after=None if a is None else r.stress - a,
            sd=r.sd,
        )
        for r, b, a in zip(model.records, before, after, strict=True)
    ]
