"""TA Instruments TRIOS, .txt: tab-separated, a header of the file, then [Step] blocks.

Both exports of text are read. "Export to LIMS": `Step name`, `Number of points`, `Variables` with the names
of the columns, `Units` with theirs, and rows that begin with `Data point`. Plain text: the step's name, a row
of names, a row of units, rows. Each step is a test.
"""

from __future__ import annotations

from collections.abc import Iterator

from calibration.lab_files._formats import Importer, register
from calibration.lab_files._table import LabTest, parameters_of, table
from calibration.lab_files._text import LabFile, Row, is_numeric, split

_TAB = "\t"


def _recognises(file: LabFile) -> bool:
    return file.has("[step]")


def _read(file: LabFile) -> tuple[LabTest, ...]:
    marks = [k for k, row in enumerate(file.rows) if row.text.strip().lower() == "[step]"]
    if not marks:
        raise file.error("expected [step] blocks, found none")
    parameters = parameters_of([r for r in file.rows[: marks[0]] if not r.text.startswith("[")], _TAB)
    tests = []
    for start, end in zip(marks, [*marks[1:], len(file.rows)], strict=True):
        found = _step(file, file.rows[start], list(_block(file.rows[start + 1 : end])), parameters)
        if found is not None:
            tests.append(found)
    if not tests:
        raise file.error("expected a [step] with rows of numbers, all are empty")
    return tuple(tests)


def _block(rows: tuple[Row, ...]) -> Iterator[Row]:
    """Rows up to the next section, [file parameters] for instance."""
    for row in rows:
        text = row.text.strip()
        if text.startswith("[") and text.endswith("]") and _TAB not in text:
            return
        if not row.empty:
            yield row


def _step(file: LabFile, mark: Row, rows: list[Row], parameters: dict[str, str]) -> LabTest | None:
    keys = [split(row, _TAB) for row in rows]
    lims = next((k for k, cells in enumerate(keys) if cells[0].lower() == "variables"), None)
    if lims is not None:
        named = {cells[0].lower(): cells[1] for cells in keys[:lims] if len(cells) > 1}
        name, at, skip = named.get("step name", ""), lims, 1
    else:
        name, at, skip = (rows[0].text.strip() if rows else ""), 1, 0
    if len(rows) <= at + 1:
        return None  # a step without points: conditioning, or stopped at once
    stated_units: tuple[str, ...] | None = keys[at + 1][skip:]
    body = rows[at + 2 :]
    if not skip and is_numeric(keys[at + 1]):  # its row of units is blank
        stated_units, body = None, rows[at + 1 :]
    if skip:
        body = [r for r in body if split(r, _TAB)[0].lower() == "data point"]
        stated = next((c[1] for c in keys[:at] if c[0].lower() == "number of points" and len(c) > 1), None)
        if stated is not None and stated.isdigit() and int(stated) != len(body):
            raise file.error(f"step {name}: expected {stated} points, as it states, got {len(body)}", mark)
    if not body:
        return None
    return table(
        file,
        keys[at][skip:],
        stated_units,
        body,
        _TAB,
        name=name,
        parameters=parameters,
        header_line=rows[at].number,
        skip=skip,
    )


register(
    Importer(
        name="trios",
        about="TA Instruments TRIOS: tab-separated .txt with [step] blocks",
        recognises=_recognises,
        read=_read,
    )
)
