"""A homogeneous test from a machine's record: stretch and nominal stress."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.lab_files import Column, Quantity
from calibration.new._answers import CouponAnswers
from calibration.new._asking import one_of
from calibration.new._plausible import Curve
from calibration.new._record import Record, open_record
from calibration.new._trial import Array, Work, csv_text

_MODES = ("uniaxial", "equibiaxial", "planar", "simple-shear")
# in order of preference: nothing is derived where the machine says it itself
_STRAINS: tuple[Quantity, ...] = ("stretch", "strain", "displacement", "true-strain")
_STRESSES: tuple[Quantity, ...] = ("stress", "force", "true-stress")
_CROSSHEAD = 0.1  # mm, of a length between grips
_STRETCH_SD = 0.002
_LARGEST_TRUE = 10.0  # true strain, beyond any specimen and far below where exp overflows


def make_coupon(work: Work, entry: CouponAnswers) -> tuple[dict[str, Any], Curve]:
    """Keys of the trial in experiment.yaml, and its curve; its table goes into `work`.

    Raises
    ------
    InputError
        The record has no strain or no stress, is damaged, or something is left open that has no default.
    """
    mode = work.settle(
        entry.id, "mode", entry.mode, f"the mode of the test: {', '.join(_MODES)}", one_of(_MODES)
    )
    record = open_record(work, entry)  # after what does not hang on it
    strain_kind, strain_column = _first(record, _STRAINS)
    stress_kind, stress_column = _first(record, _STRESSES)
    if mode != "uniaxial" and "true" in f"{strain_kind}{stress_kind}":
        raise record.error(f"expected nominal strain and stress (or force) of a test in mode {mode}")
    time = record.time(needed=False)
    raw = record.si(strain_column, strain_kind)
    length = None
    if strain_kind == "stretch":
        if entry.displacement_positive is not None:
            raise record.error(
                f"displacement_positive: expected none beside the column of stretch {strain_column.header}"
            )
        stretch = raw
    else:
        sign = record.towards_tension(strain_column, raw)
        if strain_kind == "displacement":
            raw = record.zeroed(strain_column, raw, "where the specimen is at rest")
            sheared = mode == "simple-shear"
            length = record.length(
                "rest_length_mm",
                "" if sheared else r"length|gauge|gage|\bheight\b|\bl0\b|messlange|einspannlange|hohe\b",
                "height over which the specimen is sheared: between the plates [mm]"
                if sheared
                else "length at rest that is stretched: between the grips, or a cylinder's height [mm]",
            )
            raw = raw / length
        if strain_kind == "true-strain":
            stretch = np.exp(sign * np.clip(raw, -_LARGEST_TRUE, _LARGEST_TRUE))
        else:
            stretch = 1.0 + sign * raw
    if length is None and entry.rest_length_mm is not None:
        raise record.error(
            f"rest_length_mm: expected only where the stretch comes from a displacement, here it comes from"
            f" the column {strain_column.header} (columns: {{displacement: NAME}} takes the other)"
        )
    if length is None and strain_kind != "displacement" and entry.displacement_zero_mm is not None:
        raise record.error(
            f"displacement_zero_mm: expected only where the stretch comes from a displacement, here it comes"
            f" from the column {strain_column.header}"
        )
    if stress_kind != "force" and entry.force_zero_N:
        raise record.error(
            f"force_zero_N: expected only where the stress comes from a force, here it comes from the column"
            f" {stress_column.header} (columns: {{force: NAME}} takes the other)"
        )
    load = record.si(stress_column, stress_kind) - (entry.force_zero_N if stress_kind == "force" else 0.0)
    load = load * record.force_sign(load, stretch)
    section = record.area(sheared=mode == "simple-shear") if stress_kind == "force" else 1.0
    # of a stretch by answers that are missing, only once all of them are asked for
    if strain_kind == "true-strain":
        _refuse(record, strain_column, raw, np.abs(raw) > _LARGEST_TRUE, f"at most {_LARGEST_TRUE:g}", "")
    if mode != "simple-shear":
        _refuse(
            record, strain_column, stretch, stretch <= 0, "a stretch above 0", ", or its sign turned round"
        )
    force = area = None
    if stress_kind == "force":
        stress = load / section
    elif stress_kind == "true-stress":
        stress = load / stretch  # at constant volume: nominal = true / stretch
        work.defaults.append(f"{entry.id}: nominal stress from true stress at constant volume")
    else:
        stress = load
        force, area = _beside(record)
    columns: dict[str, Array] = {} if time is None else {"time_s": time}
    columns |= {"stretch": stretch, "nominal_stress_kPa": stress * 1e-3}
    name = f"coupons/{entry.id}.csv"
    work.tables[name] = csv_text(columns)
    if length is None:
        proposal, why = _STRETCH_SD, "of a strain by the machine"
    else:
        proposal, why = _CROSSHEAD * 1e-3 / length, f"{_CROSSHEAD:g} mm of {length * 1e3:g} mm"
    trial: dict[str, Any] = {"mode": mode, "record": name}
    trial["stretch_sd"] = work.settle_sd(
        entry.id, "stretch_sd", entry.stretch_sd, "a stretch", float(f"{proposal:.2g}"), why
    )
    if entry.stress_sd_kPa is not None:
        trial["stress_sd_kPa"] = entry.stress_sd_kPa
    else:
        work.defaults.append(f"{entry.id}.stress_sd_kPa left out (estimated from the scatter of the curve)")
    return trial, Curve(mode=mode, stretch=stretch, stress=stress, time=time, force=force, area=area)


def _refuse(
    record: Record, column: Column, values: Array, wrong: NDArray[np.bool_], expected: str, or_else: str
) -> None:
    """InputError at the first row whose value is wrong."""
    if wrong.any():
        row = int(np.argmax(wrong))
        got = f"expected {expected}, got {values[row]:.4g}"
        raise record.line(row, f"column {column.header}: {got}; is the strain in %{or_else}?")


def _first(record: Record, kinds: tuple[Quantity, ...]) -> tuple[Quantity, Column]:
    """The first of these quantities that the answers name, or else that the file holds."""
    named = [k for k in kinds if k in record.entry.columns]
    for kind in named or kinds:
        column = record.column(kind)
        if column is not None:
            return kind, column
    headers = ", ".join(c.header for c in record.test.columns if c.header)[:300]
    raise record.error(
        f"expected a column of {', '.join(kinds[:-1])} or {kinds[-1]}, found {headers}"
        f" (columns: {{{kinds[0]}: NAME}} says which it is)"
    )


def _beside(record: Record) -> tuple[Array | None, float | None]:
    """The force beside a column of stress, and the area that the answers or the header state, to compare."""
    found = record.test.with_quantity("force")
    if not found and record.entry_area is not None:
        raise record.error("an area is stated: expected a column of force, the file has a stress and none")
    area = record.entry_area or record.header_area()
    if len(found) != 1 or found[0].unit is None or area is None:
        return None, None
    return record.si(found[0], "force"), area
