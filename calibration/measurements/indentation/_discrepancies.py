"""Discrepancy basis of indentations: smooth functions of depth or time, shared in several ways."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._basis import Columns, legendre
from calibration.measurements.indentation._record import Record

Array = NDArray[np.float64]

BEND = 4  # highest polynomial degree


def discrepancies(records: Sequence[Record], forces: Sequence[Array]) -> Mapping[str, Array]:
    """Sets of columns (points of all records, k) [N].

    They scale with the simulated forces (k,) of each record, not with measured ones, whose noise would be
    fitted again.

    trial bends : for each trial, Legendre polynomials of degree 0 to BEND in the depth.
    phase bends : for each phase of a trial of several, degrees below BEND in the depth, or in time in a hold.
    drifts : for each trial, polynomials in time.
    shared bends : as trial bends, common to all trials of a specimen.
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
                x = r.time if not r.direction[mine].any() else r.depth
                bend = legendre(x, degree, (float(x[mine].min()), float(x[mine].max())))
                columns.add("phase bends", [(k, np.where(mine, size * bend, 0.0))])
    specimens = dict.fromkeys(r.specimen for r in records)
    for s in specimens if len(specimens) < len(records) else []:
        alike = [k for k, r in enumerate(records) if r.specimen == s]
        low = min(float(records[k].depth.min()) for k in alike)
        high = max(float(records[k].depth.max()) for k in alike)
        for degree in range(BEND + 1):
            shared = [np.abs(forces[k]) * legendre(records[k].depth, degree, (low, high)) for k in alike]
            columns.add("shared bends", list(zip(alike, shared, strict=True)))
    return columns.by_name()
