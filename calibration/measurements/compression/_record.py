"""Selection of the records of cylinders between platens, and of their compared range."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

COMPRESSED = 0.97  # stretch below which a test counts as compression
# Largest strain of the comparison: up to it the mesh error of a bonded cylinder is below 1 %, and a law with
# a negative share of the second invariant has an equilibrium (studies/compression).
LAST = 0.5


def goes_into_compression(mode: str, stretch: Array) -> bool:
    """True for a uniaxial test that goes below COMPRESSED, with less than 3 % of tension."""
    return mode == "uniaxial" and bool(stretch.min() < COMPRESSED) and bool(stretch.max() < 2.0 - COMPRESSED)


def is_compressed(record: Record) -> bool:
    return goes_into_compression(record.mode, record.stretch)


def compared(record: Record, last: float) -> Record:
    """Record of compression up to a strain; other records unchanged."""
    return record.only(1.0 - record.stretch <= last) if is_compressed(record) else record


def pushed(record: Record) -> Record:
    """Mark the course of a compression record as driven by platens, which push but do not pull.

    Other records are returned unchanged.
    """
    if record.course is None or not is_compressed(record):
        return record
    return replace(record, course=replace(record.course, pushes=True))
