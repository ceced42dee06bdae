"""Discrepancy basis of outlines: smooth deformations of edges that photographs share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import arc_length
from calibration.experiment.model import BeamTrial
from calibration.measurements.outlines._photographs import TracedPhotograph

Array = NDArray[np.float64]

BEND = 4  # highest polynomial degree


def discrepancies(
    photographs: Sequence[TracedPhotograph], trials: Sequence[BeamTrial]
) -> Mapping[str, Array]:
    """Sets of columns in the coefficients of all photographs, shape (rows, k).

    trial edges : for each edge of each trial, polynomials of degree 0 to BEND, equal in all its photographs.
    trial bends : for both edges of each trial together, as in bending.
    support bends : as trial bends, common to all trials of one length and support.
    drifts : as trial bends, in proportion to the logarithm of time; trials with photographs at several times.
    """
    times = np.array([p.time for p in photographs])
    sets: dict[str, list[Array]] = {
        "trial edges": [],
        "trial bends": [],
        "support bends": [],
        "drifts": [],
    }
    for i in range(len(trials)):
        for degree in range(BEND + 1):
            mine = np.array([p.beam == i for p in photographs], dtype=float)
            sets["trial edges"] += [_bend(photographs, mine, degree, edge) for edge in ((1, 0), (0, 1))]
            sets["trial bends"].append(_bend(photographs, mine, degree, (1, 1)))
            spread = np.where(mine > 0, np.log(times) - np.log(times[mine > 0]).mean(), 0.0)
            if spread.any():
                sets["drifts"].append(_bend(photographs, spread, degree, (1, 1)))
    for kind in dict.fromkeys((t.supports, t.free_length) for t in trials):
        alike = np.array(
            [(trials[p.beam].supports, trials[p.beam].free_length) == kind for p in photographs], dtype=float
        )
        for degree in range(BEND + 1):
            sets["support bends"].append(_bend(photographs, alike, degree, (1, 1)))
    return {name: np.column_stack(columns) for name, columns in sets.items() if columns}


def _bend(
    photographs: Sequence[TracedPhotograph], weights: Array, degree: int, sides: tuple[int, int]
) -> Array:
    """Legendre polynomial along the edges, in the coefficients of all photographs, shape (rows,).

    weights : factor for each photograph. sides : factors for the upper and the lower edge; equal factors
    shift the whole section, since the distances of both edges have the same sign convention.
    """
    whole = np.zeros(photographs[-1].rows.stop)
    for p, weight in zip(photographs, weights, strict=True):
        if weight == 0.0:
            continue
        values = []
        for side, edge in zip(sides, (p.outline.upper, p.outline.lower), strict=True):
            s = arc_length(edge)
            legendre = np.polynomial.legendre.legval(2.0 * s / s[-1] - 1.0, np.eye(degree + 1)[degree])
            values.append(side * legendre)
        whole[p.rows] = weight * (p.basis.T @ np.concatenate(values))
    return whole
