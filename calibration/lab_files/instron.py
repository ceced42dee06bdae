"""Instron Bluehill, .csv: parameters, then a table with a row of units in brackets, or units in its header.

Parameters stand one a line ("Specimen properties : Diameter,14.0,mm", "Specimen Length (mm);33"). A table of
results ("Results Table 1") may stand before that of the raw data; it has no time. Separators and decimals
are those of the computer's language.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from calibration.lab_files._formats import Importer, register
from calibration.lab_files._quantities import plain, quantity
from calibration.lab_files._table import Block, LabTest, blocks, from_block, parameters_of
from calibration.lab_files._text import LabFile, Row, split
from calibration.lab_files._units import name_and_unit, unit

_WORDS = re.compile(r"\b(instron|bluehill)\b|results? table", re.IGNORECASE)
_SIZE = re.compile(
    r"diameter|durchmesser|width|breite|thickness|dicke|area|flache|cross.?section|querschnitt|length|lange"
    r"|height|hohe|gauge|gage|\bl0\b"
)
_PARAMETER = re.compile(r'^"?[^,;:"]+ : [^,;"]+"?[,;]')


def _bracketed(row: Row | None, separator: str) -> bool:
    if row is None:
        return False
    return all(c[0] in "([" and c[-1] in ")]" for c in split(row, separator) if c)


def _recognises(file: LabFile) -> bool:
    if file.workbook or file.sections:
        return False
    found, separator = blocks(file, file.sheets[0])
    return any(
        _bracketed(b.units, separator)
        or any(_WORDS.search(r.text) or _PARAMETER.match(r.text) for r in b.above)
        for b in found
    )


def _timed(block: Block, separator: str) -> bool:
    """True if a table has a column of time: raw data have one, results do not."""
    units = () if block.units is None else split(block.units, separator)
    for k, header in enumerate(split(block.header, separator)):
        name, stated = name_and_unit(header)
        below = unit(units[k]) if k < len(units) else None
        if quantity(name, below or stated) == "time":
            return True
    return False


def _goes_on(block: Block, found: Sequence[Block], separator: str) -> bool:
    """True if a table without time is the rest of the raw data before it, behind a line of text."""
    before = found[[b is block for b in found].index(True) - 1]
    width = len(split(before.rows[-1], separator))
    names = [c for c in split(block.header, separator) if c]
    return block.units is None and len(split(block.rows[0], separator)) == width and len(names) < width


def _read(file: LabFile) -> tuple[LabTest, ...]:
    found, separator = blocks(file, file.sheets[0])
    separators = (separator, *(s for s in (";", ",", "\t") if s != separator))
    common: dict[str, str] = {}  # above the first table, for all specimens
    own: dict[str, str] = {}
    tests: list[LabTest] = []
    results: Block | None = None
    for block in found:
        own |= parameters_of(block.above, separators)
        if _timed(block, separator):
            name = f"table {len(tests) + 1}"
            tests.append(from_block(file, block, separator, name=name, parameters={**common, **own}))
            # the size of a specimen is not that of the next
            common = common or {n: text for n, text in own.items() if not _SIZE.search(plain(n))}
            own = {}
        elif tests and _goes_on(block, found, separator):
            raise file.error(
                "expected rows of numbers up to an empty line, this line of text stands within raw data",
                block.header,
            )
        else:
            results = block
    if not tests:
        row = None if results is None else results.header
        raise file.error("expected a table of raw data with a column of time, as Bluehill exports it", row)
    if len(tests) == 1:
        return (replace(tests[0], name=""),)
    return tuple(tests)


register(
    Importer(
        name="instron",
        about="Instron Bluehill: .csv with parameters, then a table with a row of units in brackets",
        recognises=_recognises,
        read=_read,
    )
)
