"""Biomomentum Mach-1 Motion, .txt: <INFO> to <END INFO>, then functions, each with <DATA> to <END DATA>.

A function begins with its name in angle brackets (<Move Relative>, <Stress Relaxation>) and its parameters;
its data are tab-separated below one header line ("Time, s", "Position (z), mm", "Fz, gf"). <divider> parts
the ramps of one function. Each function, and each ramp, is a test.
"""

from __future__ import annotations

import re

from calibration.lab_files._formats import Importer, register
from calibration.lab_files._table import LabTest, parameters_of, table
from calibration.lab_files._text import LabFile, Row, split

_MARK = re.compile(r"<(?P<name>[^<>]+)>")


def _recognises(file: LabFile) -> bool:
    return file.has("<Mach-1 File>") or file.has("<INFO>", "<DATA>")


def _read(file: LabFile) -> tuple[LabTest, ...]:
    tests: list[LabTest] = []
    counts: dict[str, int] = {}
    info: list[Row] = []
    own: list[Row] = []
    data: list[Row] | None = None
    name, begun, section = "", 0, ""
    for row in file.rows:
        found = _MARK.fullmatch(row.text.strip())
        mark = found["name"].strip().upper() if found else ""
        if data is not None:
            if mark == "END DATA":
                counts[name] = counts.get(name, 0) + 1
                numbered = name if counts[name] == 1 else f"{name} {counts[name]}"
                tests += _function(file, numbered or "data", begun, data, parameters_of([*info, *own], "\t"))
                data, section = None, ""
            elif mark in ("DATA", "INFO"):
                raise file.error(f"expected <END DATA> for the <DATA> of line {begun}, got <{mark}>", row)
            else:
                data.append(row)
        elif mark == "INFO":
            section, info = "info", []
        elif mark == "END INFO":
            section, own = "", []
        elif mark == "DATA":
            data, begun = [], row.number
        elif found and mark not in ("MACH-1 FILE", "END DATA"):
            name, own = found["name"].strip(), []
        elif not row.empty:
            (info if section == "info" else own).append(row)
    if data is not None:
        raise file.error(f"expected <END DATA> for the <DATA> of line {begun}, the file ends before it")
    if not tests:
        raise file.error("expected a <DATA> block, found none")
    return tuple(tests)


def _function(
    file: LabFile, name: str, begun: int, rows: list[Row], parameters: dict[str, str]
) -> list[LabTest]:
    given = [r for r in rows if not r.empty]
    if len(given) < 2:
        return []  # a function that was stopped at once
    header = given[0]
    ramps: list[list[Row]] = [[]]
    cells = split(header, "\t")
    if all(re.fullmatch(r"[-+.\deE]+", c) for c in cells if c):
        raise file.error("expected the names of the columns below <DATA>", header)
    for row in given[1:]:
        if row.text.strip().lower() == "<divider>":
            ramps.append([])
        else:
            ramps[-1].append(row)
    ramps = [r for r in ramps if r]
    return [
        table(
            file,
            cells,
            None,
            ramp,
            "\t",
            name=name if len(ramps) == 1 else f"{name}, ramp {k}",
            parameters=parameters,
            header_line=begun,
        )
        for k, ramp in enumerate(ramps, 1)
    ]


register(
    Importer(
        name="mach-1",
        about="Biomomentum Mach-1 Motion: .txt with <INFO> and <DATA> blocks",
        recognises=_recognises,
        read=_read,
    )
)
