"""What the pictures of pokes are drawn from: records with their simulated forces, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.explanation import Explanation
from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.model import PokeModel
from calibration.diagnosis.verdict import Diagnosis

Array = NDArray[np.float64]

MOST = 24  # panels of one picture
NAMED, PARTIAL = "extended", "best of the library, which is not the cause"


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRecord:
    """A record with the force [N] that the baseline gives it, and the extension (None where there is none);
    what is left of them (measured less simulated) once the likeliest mesh error and touch are taken out, and
    each point's own standard deviation [N]."""

    record: Record
    before: Array
    after: Array | None
    left_before: Array
    left_after: Array | None
    sd: Array

    def left(self, which: str) -> Array:
        """which: "before" or "after"."""
        return np.asarray(getattr(self, f"left_{which}"))

    def rms(self, which: str) -> float:
        return float(np.sqrt(np.mean(self.left(which) ** 2)))

    @property
    def size(self) -> float:
        """Its departure from the baseline, in standard deviations."""
        return float(np.sqrt(np.mean((self.left_before / self.sd) ** 2)))

    def phases(self) -> list[tuple[NDArray[np.bool_], bool]]:
        """Points of each phase, and whether it is a loading."""
        found = []
        for p in np.unique(self.record.phase):
            mine = self.record.phase == p
            found.append((mine, bool((self.record.kind[mine] > 0).all())))
        return found


def drawn(model: PokeModel, diagnosis: Diagnosis) -> list[DrawnRecord]:
    """All records. Where nothing is named, what explains most of an unexplained departure stands for the
    extension."""
    shown = shown_explanation(diagnosis)
    base = diagnosis.finding.baseline.state
    before, left_before = model.forces(base), model.registered(base)
    after: Sequence[Array | None] = [None] * len(before)
    left_after: Sequence[Array | None] = after
    if shown is not None:
        after, left_after = model.forces(shown.fit.state), model.registered(shown.fit.state)
    return [
        DrawnRecord(
            record=r,
            before=before[k],
            after=after[k],
            left_before=-left_before[k],
            left_after=_negative(left_after[k]),
            sd=sd,
        )
        for k, (r, sd) in enumerate(zip(model.records, model.deviations(), strict=True))
    ]


def _negative(values: Array | None) -> Array | None:
    return None if values is None else np.asarray(-values)


def shown_explanation(diagnosis: Diagnosis) -> Explanation | None:
    finding = diagnosis.finding
    if finding.chosen is not None:
        return finding.chosen
    best = finding.explanations[0] if finding.explanations else None
    return best if finding.verdict == "unexplained" and finding.chance < 0.01 else None


def legend_of(diagnosis: Diagnosis) -> str:
    """What the lines after are called."""
    shown = shown_explanation(diagnosis)
    if shown is None:
        return ""
    names = " + ".join(shown.names)
    return f"{NAMED if diagnosis.finding.chosen is not None else PARTIAL} ({names})"


def most_telling(records: Sequence[DrawnRecord]) -> tuple[list[DrawnRecord], int]:
    """Those that have a panel, in the file's order, and how many depart too little to have one."""
    largest = sorted(records, key=lambda d: -d.size)[:MOST]
    return [d for d in records if d in largest], len(records) - len(largest)
