"""What a reader of a verdict on coupons should know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.records import listed


def remarks_on(records: Sequence[Record]) -> list[str]:
    """Sentences: where the errors come from, what one loop cannot tell, what order was taken for granted."""
    found = []
    guessed = [r for r in records if r.estimated]
    if guessed:
        typical = float(np.median(np.concatenate([r.sd / np.abs(r.stress).max() for r in guessed])))
        found.append(
            f"the lab states no error of the stress of {listed(guessed)}: it was estimated from the scatter"
            " about a smooth curve, at least 0.5 % of the stress; its median is"
            f" {100 * typical:.2g} % of the largest stress"
        )
    loops = [r for r in records if r.unloads and not r.reloaded]
    if loops:
        found.append(
            f"{listed(loops)}: loaded and unloaded once, and one loop cannot tell hysteresis from the"
            " softening of a first loading (mullins): load the specimen again"
        )
    remembering = [r for r in records if r.remembers]
    if remembering:
        found.append(
            f"{listed(remembering)}: taken to follow the trials of the same specimen that the file lists"
            " before"
        )
    return found
