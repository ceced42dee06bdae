"""What a reader of a verdict on pokes should know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.records import listed


def remarks_on(records: Sequence[Record], left_out: Sequence[str]) -> list[str]:
    """Sentences: where the errors come from, what is not in the library, what was taken for granted."""
    found = list(left_out)
    guessed = [r for r in records if r.estimated]
    if guessed:
        parts = [float(np.median(r.own_sd * np.sqrt(r.count)) / np.abs(r.force).max()) for r in guessed]
        found.append(
            f"the lab states no error of the force of {listed(guessed)}: it was estimated from the scatter"
            " about a smooth curve, at least 0.5 % of the force; its median is"
            f" {100 * float(np.median(parts)):.2g} % of the largest force"
        )
    if any(r.begun[0] > 0.0 for r in records):
        again = [r for r in records if r.begun[0] > 0.0]
        found.append(
            f"{listed(again)}: taken to follow the pokes of the same specimen that the file lists before"
        )
    found.append(
        "a stiffer skin and a base that slips are not in the library of pokes: the simulator cannot have them"
        " yet"
    )
    return found
