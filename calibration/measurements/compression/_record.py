"""Selection of the records of cylinders between platens, and of their compared range."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import CouponMode
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import goes_into_compression, goes_into_tension

Array = NDArray[np.float64]

# Largest strain of the comparison: up to it the mesh error of a bonded cylinder is below 1 %, and a law with
# a negative share of the second invariant has an equilibrium (studies/compression).
LAST = 0.5


def between_platens(mode: CouponMode, stretch: Array) -> bool:
    """True for a test that goes into compression alone, as platens drive it that do not pull."""
    return goes_into_compression(mode, stretch) and not goes_into_tension(mode, stretch)


def is_compressed(record: Record) -> bool:
    return between_platens(record.mode, record.stretch)


def up_to(last: float, mode: CouponMode, stretch: Array) -> NDArray[np.bool_]:
    """Mask (k,) of the points of a test up to a strain, if it is one of compression; else of all."""
    strain = 1.0 - stretch if between_platens(mode, stretch) else np.zeros(stretch.shape)
    return np.asarray(strain <= last)


def compared(record: Record, last: float) -> Record:
    """Record of compression up to a strain; other records unchanged.

    InputError for a record that lies beyond it as a whole.
    """
    if not is_compressed(record):
        return record
    kept = up_to(last, record.mode, record.stretch)
    if not kept.any():
        low, high = record.stretch.min(), record.stretch.max()
        raise InputError(
            f"trial {record.name}: record: expected some points with a stretch of {1.0 - last:g} or more"
            f" (compression is compared up to a strain of {last:g}), got {low:.3g} to {high:.3g}; does the"
            " column stretch hold strain?"
        )
    return record.only(kept)


def pushed(record: Record) -> Record:
    """Mark the course of a compression record as driven by platens, which push but do not pull.

    Other records are returned unchanged.
    """
    if record.course is None or not is_compressed(record):
        return record
    return replace(record, course=replace(record.course, pushes=True))
