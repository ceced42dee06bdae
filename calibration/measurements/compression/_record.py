"""Which records are of cylinders between platens, and how much of them is compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

COMPRESSED = 0.97  # stretch below which platens press
# Strain to which simulation and measurement are compared: the mesh of a bonded cylinder is good to 1 % there,
# and a law with a negative second share has an equilibrium (`docs/compression.md`).
LAST = 0.5


def goes_into_compression(mode: str, stretch: Array) -> bool:
    """A uniaxial test that goes into compression, and hardly into tension."""
    return mode == "uniaxial" and bool(stretch.min() < COMPRESSED) and bool(stretch.max() < 2.0 - COMPRESSED)


def is_compressed(record: Record) -> bool:
    return goes_into_compression(record.mode, record.stretch)


def compared(record: Record, last: float) -> Record:
    """The part of a record of compression up to a strain; others as they are."""
    return record.only(1.0 - record.stretch <= last) if is_compressed(record) else record


def pushed(record: Record) -> Record:
    """A record of compression whose course is that of platens, which push and do not pull; others as they
    are."""
    if record.course is None or not is_compressed(record):
        return record
    return replace(record, course=replace(record.course, pushes=True))
