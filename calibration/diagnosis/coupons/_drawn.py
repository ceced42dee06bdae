"""What the pictures of coupons are drawn from: records with their simulated stresses, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.model import CouponModel
from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.verdict import Diagnosis

Array = NDArray[np.float64]

Kind = Literal["loading", "unloading", "loading again"]

MOST = 24  # panels of one picture
NAMED, PARTIAL = "extended", "best of the library, which is not the cause"


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRecord:
    """A record with the stress [Pa] that the baseline makes of its stretches, and the extension; None where
    there is none."""

    record: Record
    before: Array
    after: Array | None

    def left(self, which: str) -> Array:
        """Measured less simulated [Pa]; which: "before" or "after"."""
        return np.asarray(self.record.stress - getattr(self, which))

    def rms(self, which: str) -> float:
        return float(np.sqrt(np.mean(self.left(which) ** 2)))

    @property
    def size(self) -> float:
        """Its departure from the baseline, in standard deviations."""
        return float(np.sqrt(np.mean((self.left("before") / self.record.sd) ** 2)))

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
    """All records. Where nothing is named, what explains most of an unexplained departure stands for the
    extension."""
    shown = shown_explanation(diagnosis)
    before = model.stresses(diagnosis.finding.baseline.state)
    after: Sequence[Array | None] = [None] * len(before) if shown is None else model.stresses(shown.fit.state)
    return [
        DrawnRecord(record=r, before=b, after=a) for r, b, a in zip(model.records, before, after, strict=True)
    ]


def shown_explanation(diagnosis: Diagnosis) -> Explanation | None:
    finding = diagnosis.finding
    if diagnosis.chosen is not None:
        return diagnosis.chosen
    best = finding.explanations[0] if finding.explanations else None
    return best if finding.verdict == "unexplained" and finding.chance < 0.01 else None


def legend_of(diagnosis: Diagnosis) -> str:
    """What the lines after are called."""
    shown = shown_explanation(diagnosis)
    if shown is None:
        return ""
    names = " + ".join(shown.names)
    return f"{NAMED if diagnosis.chosen is not None else PARTIAL} ({names})"


def most_telling(records: Sequence[DrawnRecord]) -> tuple[list[DrawnRecord], int]:
    """Those that have a panel, in the file's order, and how many depart too little to have one."""
    largest = sorted(records, key=lambda d: -d.size)[:MOST]
    return [d for d in records if d in largest], len(records) - len(largest)
