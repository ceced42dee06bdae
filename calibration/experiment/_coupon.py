"""A coupon in experiment.yaml: its keys, and what they say in SI."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from calibration.experiment._fields import CsvFile, Name, Noise, Strict
from calibration.experiment._files import Files
from calibration.experiment._table import parse_table
from calibration.experiment.model import CouponMode, CouponTrial

_KPA = 1e3


class CouponEntry(Strict):
    """A homogeneous test."""

    id: Name
    kind: Literal["coupon"]
    material: Name
    specimen: Name | None = None
    mode: CouponMode
    record: CsvFile
    stretch_sd: Annotated[float, Field(ge=0, le=1)] = 0.0
    stress_sd_kPa: Noise | None = None


def read_coupon(entry: CouponEntry, files: Files, where: str) -> CouponTrial:
    """The trial in SI, with its record; where: its place in experiment.yaml, for errors."""
    table = parse_table(
        files.read(entry.record, f"{where}.record"),
        files.folder / entry.record,
        numbers=("stretch", "nominal_stress_kPa"),
        optional=("time_s",),
    )
    table.need_rows(3)
    if "time_s" in table:
        table.need_growing("time_s", of=" s")
    stretch = table.numbers["stretch"]
    bad = np.flatnonzero(stretch <= 0)
    if bad.size and entry.mode != "simple-shear":  # there it is 1 + gamma, of any sign
        row = int(bad[0])
        raise table.error(row, f"column stretch: expected more than 0, got {stretch[row]:g}")
    return CouponTrial(
        id=entry.id,
        material=entry.material,
        specimen=entry.specimen,
        mode=entry.mode,
        stretch=stretch,
        stress=table.numbers["nominal_stress_kPa"] * _KPA,
        time=table.numbers.get("time_s"),
        stretch_sd=entry.stretch_sd,
        stress_sd=None if entry.stress_sd_kPa is None else entry.stress_sd_kPa * _KPA,
    )
