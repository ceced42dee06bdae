"""ZwickRoell testXpert: a row of names, a row of bare units, numbers; one block, or one sheet, a test.

Names and units may be quoted. Rows above a block name its test and its parameters. Sheets of a workbook that
hold no such table (parameters, results) are passed over.
"""

from __future__ import annotations

import re

from calibration.errors import InputError
from calibration.lab_files._formats import Importer, register
from calibration.lab_files._table import LabTest, blocks, from_block, parameters_of
from calibration.lab_files._text import LabFile, Row, Sheet, split

_WORDS = re.compile(r"\bzwick|\btestxpert", re.IGNORECASE)


def _bare(row: Row | None, separator: str) -> bool:
    if row is None:
        return False
    return not any(c[0] in "([" for c in split(row, separator) if c)


def _recognises(file: LabFile) -> bool:
    if file.workbook:
        return any(_measured(file, sheet) for sheet in file.sheets)
    if file.sections:
        return False
    found, separator = blocks(file, file.sheets[0])
    return any(_bare(b.units, separator) or any(_WORDS.search(r.text) for r in b.above) for b in found)


def _measured(file: LabFile, sheet: Sheet) -> bool:
    try:
        found, separator = blocks(file, sheet)
    except InputError:
        return False
    return any(_bare(b.units, separator) for b in found)


def _read(file: LabFile) -> tuple[LabTest, ...]:
    tests: list[LabTest] = []
    sheets = [s for s in file.sheets if _measured(file, s)] if file.workbook else list(file.sheets)
    if not sheets:
        raise file.error("expected a sheet with a row of names, a row of units and rows of numbers")
    for sheet in sheets:
        found, separator = blocks(file, sheet)
        for number, block in enumerate(found, 1):
            if not _bare(block.units, separator):
                if file.workbook:
                    continue  # a table of results on the same sheet
                raise file.error(
                    "expected a row of units (s, N, mm) between the names of the columns and the numbers",
                    block.rows[0],
                )
            parameters = parameters_of(block.above, (separator, ";", "\t"))
            # a block's own title: the one cell of the row above its names
            title = [c for c in split(block.above[-1], separator) if c] if block.above else []
            name = title[0] if len(title) == 1 and ":" not in title[0] else f"block {number}"
            if file.workbook:
                name = sheet.name if len(found) == 1 else f"{sheet.name}, {name}"
            tests.append(
                from_block(file, block, separator, name=name, parameters=parameters, sheet=sheet.name)
            )
    return tuple(tests)


register(
    Importer(
        name="zwick",
        about="ZwickRoell testXpert: names, a row of units, numbers; one block or one sheet (.xlsx) a test",
        recognises=_recognises,
        read=_read,
    )
)
