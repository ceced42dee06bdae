"""Sentences for reports on indentations: points left out, errors, order of trials, missing effects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.measurements._records import listed
from calibration.measurements.indentation._record import Record


def remarks_on(records: Sequence[Record], left_out: Sequence[str]) -> list[str]:
    """Sentences on points left out, estimated errors, assumed order of trials, and missing effects."""
    found = list(left_out)
    guessed = [r for r in records if r.estimated]
    if guessed:
        relative = [float(np.median(r.own_sd * np.sqrt(r.count)) / np.abs(r.force).max()) for r in guessed]
        found.append(
            f"the lab states no error of the force of {listed(guessed)}: it was estimated from the"
            " scatter about a smooth curve, at least 0.5 % of the force; its median is"
            f" {100 * float(np.median(relative)):.2g} % of the largest force"
        )
    again = [r for r in records if r.unloaded[0] > 0.0]
    if again:
        text = "taken to follow the indentations of the same specimen that the file lists before"
        found.append(f"{listed(again)}: {text}")
    found.append(
        "the catalogue of indentation has no stiffer skin and no base that slips: they are not simulated yet"
    )
    return found


def described_noise(records: Sequence[Record], points: int) -> str:
    """Description of the noise model of records with this number of compared values."""
    estimated = any(r.estimated for r in records)
    return (
        f"{len(records)} records, {points} values (of long records the means of neighbours);"
        " the force and depth errors that the lab states, white from point to point"
        + (" (where it states none, an error from the scatter of the record)" if estimated else "")
        + "; first touch, off by the depth's error once a record; the simulation's mesh error: 1.1 %"
        " common to all forces (twice that deeper than 1.5 radii), wandering by 0.5 % with the depth, by"
        " more near the surface; the shear modulus free for each specimen."
    )
