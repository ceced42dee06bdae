"""Columns of a test from a lab file."""

from __future__ import annotations

import numpy as np

from calibration.lab_files import LabTest


def column(test: LabTest, header: str) -> np.ndarray:
    """Numbers of the column with this header [SI]."""
    (found,) = (c for c in test.columns if c.header == header)
    assert found.unit is not None
    return test.numbers(found) * found.unit.factor
