"""A homogeneous test in experiment.yaml: its keys, read into SI; long records are averaged."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from calibration.errors import InputError
from calibration.experiment._fields import CsvFile, Name, Noise, Strict
from calibration.experiment._files import Files, parse_table
from calibration.experiment._thinning import groups
from calibration.experiment.model import Array, CouponMode, CouponTrial

_KPA = 1e3
_FAR = 10.0  # a record that begins beyond this stretch holds no stretches
_MOST_POINTS = 4000  # of a record: a fit ends in seconds, and a curve has no more to say


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
        table = table.clock(files)
    stretch = table.numbers["stretch"]
    bad = np.flatnonzero(stretch <= 0)
    if bad.size and entry.mode != "simple-shear":  # there it is 1 + gamma, of any sign
        row = int(bad[0])
        raise table.error(row, f"column stretch: expected more than 0, got {stretch[row]:g}")
    if stretch.min() > _FAR and entry.mode != "simple-shear":
        raise InputError(
            f"{table.path}: column stretch: expected stretches from near 1 (at rest) on, the smallest is"
            f" {stretch.min():g}; is the column in percent, or another one?"
        )
    name = entry.record
    files.need_smaller_sd(
        f"{where}.stress_sd_kPa",
        entry.stress_sd_kPa,
        table.numbers["nominal_stress_kPa"],
        f"the largest stress of {name} in kPa",
    )
    files.need_smaller_sd(
        f"{where}.stretch_sd", entry.stretch_sd, stretch - 1.0, f"the largest strain of {name}"
    )
    columns, samples = _averaged(
        {n: table.numbers[n] for n in ("stretch", "nominal_stress_kPa", "time_s") if n in table},
        entry.stretch_sd,
    )
    return CouponTrial(
        id=entry.id,
        material=entry.material,
        specimen=entry.specimen,
        mode=entry.mode,
        stretch=columns["stretch"],
        stress=columns["nominal_stress_kPa"] * _KPA,
        time=columns.get("time_s"),
        samples=samples,
        stretch_sd=entry.stretch_sd,
        stress_sd=None if entry.stress_sd_kPa is None else entry.stress_sd_kPa * _KPA,
    )


def _averaged(columns: dict[str, Array], stretch_sd: float) -> tuple[dict[str, Array], Array | None]:
    """Columns with at most `_MOST_POINTS` rows, means of neighbours, and the number of samples in each.

    The means follow the order of the record, so that loading and unloading stay apart.
    """
    rows = len(columns["stretch"])
    if rows <= _MOST_POINTS:
        return columns, None
    starts = groups(columns["stretch"], _MOST_POINTS, sd=stretch_sd)
    counts = np.diff(np.append(starts, rows)).astype(float)
    return {name: np.add.reduceat(values, starts) / counts for name, values in columns.items()}, counts
