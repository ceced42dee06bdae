"""Sentences for reports on homogeneous tests: stated and estimated errors, single loops, order of trials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.measurements._records import listed
from calibration.measurements.homogeneous._point_sd import ASSUMED
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous._scatter import FEWEST, SMALLEST_RELATIVE


def remarks_on(records: Sequence[Record]) -> list[str]:
    """Sentences on estimated errors, on single loops, and on the assumed order of trials."""
    found = []
    guessed = [r for r in records if r.estimated]
    if guessed:
        typical = float(np.median(np.concatenate([r.sd / np.abs(r.stress).max() for r in guessed])))
        found.append(
            f"the lab states no error of the stress of {listed(guessed)}: it was estimated from the"
            " scatter about a smooth curve, at least 0.5 % of a record's largest stress; its"
            f" median is {100 * typical:.2g} %. Where points scatter by less about a curve than such an"
            " error, a reduced chi-square far below 1 is no fault"
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


def assumed_errors(records: Sequence[Record]) -> list[str]:
    """A sentence on records whose error is assumed, since they have too few points to show a scatter."""
    few = [r for r in records if r.scatter_points == ASSUMED]
    if not few:
        return []
    return [
        f"the lab states no error of the stress of {listed(few)}, and fewer than {FEWEST} points show no"
        f" scatter: {100 * SMALLEST_RELATIVE:g} % of the largest stress is assumed, so that a lack of fit"
        " cannot be told from noise: state stress_sd_kPa"
    ]


def described_noise(records: Sequence[Record], points: int) -> str:
    """Description of the noise model of records with this number of compared points."""
    stated = [r for r in records if not r.estimated]
    parts = []
    if stated:
        parts.append("the stress and stretch errors that the lab states, white from point to point")
    if len(stated) < len(records):
        parts.append(
            "where the lab states none, an error from the scatter about a smooth curve, at least 0.5 % of"
            " the largest stress of the record"
        )
    return (
        f"{len(records)} records, {points} points (of long records the means of neighbours); "
        + "; ".join(parts)
        + "; the shear modulus free for each specimen."
    )
