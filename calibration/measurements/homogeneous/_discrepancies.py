"""Discrepancy basis of homogeneous tests: smooth functions of the strain, shared in several ways."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._basis import Columns, legendre
from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

BEND, JUMPS = 4, 8  # highest polynomial degree, and number of parts of a record between which steps lie


def discrepancies(records: Sequence[Record], sd: Array) -> Mapping[str, Array]:
    """Sets of columns (rows, k) [Pa], in proportion to the standard deviation `sd` (rows,) of each point.

    trial bends : for each trial, Legendre polynomials of degree 0 to BEND in ln stretch (in the stretch, if
        it is not positive).
    mode bends : for trials of one mode and material together, in the stretch.
    loops : as trial bends, with opposite sign in loading and unloading; trials with an unloading.
    drifts : polynomials in time (in the point's index, without a clock); trials of several branches.
    cycles : one constant per branch; trials of several branches.
    jumps : for each trial, steps between JUMPS parts of its record.
    """
    columns = Columns([r.points for r in records])
    for k, r in enumerate(records):
        back = np.where(np.isfinite(r.turn), -1.0, 1.0)
        turns = np.unique(r.branch)
        for degree in range(BEND + 1):
            bend = legendre(np.log(r.stretch) if (r.stretch > 0).all() else r.stretch, degree)
            columns.add("trial bends", [(k, bend)])
            if r.unloads:
                columns.add("loops", [(k, back * bend)])
            if turns.size > 1:
                columns.add("drifts", [(k, legendre(_clock(r), degree))])
        for part in range(1, JUMPS):
            columns.add("jumps", [(k, (np.arange(r.points) >= part * r.points / JUMPS).astype(float))])
        for b in turns if turns.size > 1 else []:
            columns.add("cycles", [(k, (r.branch == b).astype(float))])
    kinds = dict.fromkeys((r.mode, r.material) for r in records)
    if len(kinds) < len(records):
        for kind in kinds:
            alike = [k for k, r in enumerate(records) if (r.mode, r.material) == kind]
            strains = np.concatenate([records[k].stretch for k in alike])
            for degree in range(BEND + 1):
                values = legendre(strains, degree)
                ends = np.cumsum([records[k].points for k in alike])[:-1]
                columns.add("mode bends", list(zip(alike, np.split(values, ends), strict=True)))
    return {name: sd[:, None] * raw for name, raw in columns.by_name().items()}


def _clock(r: Record) -> Array:
    return r.time if np.isfinite(r.time).all() else np.arange(float(r.points))
