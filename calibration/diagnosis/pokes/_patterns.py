"""What a departure that no effect explains might look like: smooth in depth and in time, phase by phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.records import Columns, legendre

Array = NDArray[np.float64]

BEND = 4  # highest degree


def patterns_of(records: Sequence[Record], forces: Sequence[Array]) -> Mapping[str, Array]:
    """Columns (points, k) [N], by name; forces [N]: simulated, since the noise of measured ones would be
    found again.

    trial bends: of each trial, degrees up to BEND in the depth, in parts of its force. phase bends: the same
    for each phase of it. drifts: of each trial, in its time. shared bends: as trial bends, one for all trials
    of a specimen.
    """
    columns = Columns([r.points for r in records])
    for k, r in enumerate(records):
        largest = float(np.abs(forces[k]).max(initial=0.0))
        size = np.abs(forces[k]) + 0.02 * largest
        phases = np.unique(r.phase)
        for degree in range(BEND + 1):
            columns.add("trial bends", [(k, size * legendre(r.depth, degree))])
            columns.add("drifts", [(k, largest * legendre(r.time, degree))])
            for p in phases if phases.size > 1 and degree < BEND else []:
                mine = r.phase == p
                # in a hold the depth stands still, and time goes on
                x = r.time if not r.kind[mine].any() else r.depth
                bend = legendre(x, degree, (float(x[mine].min()), float(x[mine].max())))
                columns.add("phase bends", [(k, np.where(mine, size * bend, 0.0))])
    specimens = dict.fromkeys(r.specimen for r in records)
    if len(specimens) < len(records):
        for s in specimens:
            alike = [k for k, r in enumerate(records) if r.specimen == s]
            low = min(float(records[k].depth.min()) for k in alike)
            high = max(float(records[k].depth.max()) for k in alike)
            for degree in range(BEND + 1):
                columns.add(
                    "shared bends",
                    [(k, np.abs(forces[k]) * legendre(records[k].depth, degree, (low, high))) for k in alike],
                )
    return columns.by_name()
