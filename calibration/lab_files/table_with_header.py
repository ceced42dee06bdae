"""Plain tables: the first line names the columns ("Force [N]", "Extension (mm)", "strain %", "Time/s").

Where the format is stated, lines above the names are passed over.
"""

from __future__ import annotations

from calibration.lab_files._formats import Importer, register
from calibration.lab_files._table import LabTest, blocks, from_block, parameters_of, without_numbers
from calibration.lab_files._text import LabFile


def _recognises(file: LabFile) -> bool:
    if file.sections or len(file.sheets) > 1:
        return False
    found, _ = blocks(file, file.sheets[0])
    if not found:  # a sheet of words
        return False
    first = next(row for row in file.rows if not row.empty)
    return found[0].header == first and found[0].units is None


def _read(file: LabFile) -> tuple[LabTest, ...]:
    if len(file.sheets) > 1:
        names = ", ".join(s.name for s in file.sheets)[:200]
        raise file.error(f"expected a workbook of one sheet, got {names}")
    found, separator = blocks(file, file.sheets[0])
    if not found:
        raise without_numbers(file)
    if len(found) > 1:
        raise file.error("expected one table, a second begins here", found[1].header)
    parameters = parameters_of(found[0].above, (separator,))
    return (from_block(file, found[0], separator, parameters=parameters, sheet=file.sheets[0].name),)


register(
    Importer(
        name="csv",
        about="any table whose first line names the columns, with units in the names",
        recognises=_recognises,
        read=_read,
    )
)
