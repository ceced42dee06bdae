"""What the pictures of pokes are drawn from: records with their simulated forces, before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.drawing import DrawnCurve, shown_explanation
from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.model import PokeModel
from calibration.diagnosis.verdict import Diagnosis

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRecord(DrawnCurve):
    """A record with the force [N] that the baseline gives it, and the extension (None where there is none).
    What is left of them is without the likeliest mesh error and touch."""

    record: Record
    before: Array
    after: Array | None

    def phases(self) -> list[tuple[NDArray[np.bool_], bool]]:
        """Points of each phase, and whether it is a loading."""
        found = []
        for p in np.unique(self.record.phase):
            mine = self.record.phase == p
            found.append((mine, bool((self.record.kind[mine] > 0).all())))
        return found


def drawn(model: PokeModel, diagnosis: Diagnosis) -> list[DrawnRecord]:
    """All records, with what stands for the extension."""
    shown = shown_explanation(diagnosis.finding, diagnosis.chosen)
    base = diagnosis.finding.baseline.state
    before, left_before = model.forces(base), model.registered(base)
    after: Sequence[Array | None] = [None] * len(before)
    left_after: Sequence[Array | None] = after
    if shown is not None:
        after, left_after = model.forces(shown.fit.state), model.registered(shown.fit.state)
    return [
        DrawnRecord(
            name=r.name,
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
