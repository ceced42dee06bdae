"""Tables in a file of a machine: header, units and numbers, and the tests that they are."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.lab_files._quantities import Quantity, quantity
from calibration.lab_files._text import (
    LabFile,
    Row,
    Sheet,
    decimals_of,
    is_number,
    is_numeric,
    number,
    separator_of,
    split,
)
from calibration.lab_files._units import Unit, name_and_unit, unit

Array = NDArray[np.float64]

_SAMPLE = 3000  # rows that tell the separator
_LARGEST = 1e12  # beyond it a number is damage, not a measurement


@dataclass(frozen=True, kw_only=True)
class Block:
    """A table in a file: what stands above it, its header, its row of units, its rows of numbers."""

    above: tuple[Row, ...]
    header: Row
    units: Row | None
    rows: tuple[Row, ...]


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of a test.

    Attributes
    ----------
    header : str
        Name as the file has it, without its unit.
    unit : Unit, optional
    quantity : str, optional
        Quantity of the column, if its name and unit state it.
    cells : tuple of str
    """

    header: str
    unit: Unit | None
    quantity: Quantity | None
    cells: tuple[str, ...] = field(repr=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class LabTest:
    """One test of a file.

    Attributes
    ----------
    file : LabFile
    name : str
        Name of the sheet, step or block; "" if the file has one only.
    columns : tuple of Column
    rows : tuple of int
        Line of each row of numbers.
    parameters : mapping
        Text above the numbers, by name.
    sheet : str
        Name of the sheet of a workbook, for messages.
    """

    file: LabFile
    name: str
    columns: tuple[Column, ...]
    rows: tuple[int, ...]
    parameters: Mapping[str, str] = field(default_factory=dict)
    sheet: str = ""

    def with_quantity(self, wanted: Quantity) -> tuple[Column, ...]:
        """Columns that hold a quantity."""
        return tuple(c for c in self.columns if c.quantity == wanted)

    def numbers(self, column: Column, decimals: str | None = None) -> Array:
        """Numbers of a column in the unit that the file has them in, shape (k,).

        Parameters
        ----------
        column : Column
        decimals : {"point", "comma"}, optional
            Decimal separator, if the lab states it.

        Raises
        ------
        InputError
            A cell is empty or no number; one sentence with the line.
        """
        mark = self._mark(decimals)
        values = np.empty(len(column.cells))
        for k, cell in enumerate(column.cells):
            try:
                values[k] = number(cell, mark)
            except ValueError:
                got = f"got {cell[:60]!r}" if cell else "the cell is empty"
                raise self.file.error(
                    f"column {column.header}: expected a number, {got}", self.rows[k], sheet=self.sheet
                ) from None
            if not abs(values[k]) <= _LARGEST:
                raise self.file.error(
                    f"column {column.header}: expected a number below {_LARGEST:g}, got {cell[:60]!r}",
                    self.rows[k],
                    sheet=self.sheet,
                )
        return values

    def number_above(self, cell: str, decimals: str | None = None) -> float | None:
        """A number above the table; None for what is no number.

        One that can be read in two ways ("1,256") is read as in the table.

        Raises
        ------
        InputError
            The table does not tell how.
        """
        found = []
        for mark in (".", ","):
            with contextlib.suppress(ValueError):
                found.append(number(cell, mark))
        if len(set(found)) < 2:
            return found[0] if found else None
        return number(cell, self._mark(decimals, cell))

    def _mark(self, decimals: str | None, *above: str) -> str:
        """The mark of decimals of the table's numbers, and of some above it."""
        _, separator = self.file.tables.get(self.sheet, ((), ""))
        given = [c for col in self.columns for c in col.cells if is_number(c)]
        return decimals_of(self.file, [*given, *above], decimals, separator=separator)


def blocks(file: LabFile, sheet: Sheet) -> tuple[tuple[Block, ...], str]:
    """All tables of a sheet, and the separator of its columns.

    A table is rows of numbers up to an empty row, or to one without a number; its header is the row above
    them, or the one above a row of units.

    Raises
    ------
    InputError
        There are no numbers, or there is no header above them.
    """
    if sheet.name not in file.tables:
        file.tables[sheet.name] = _find(file, sheet)
    found: tuple[tuple[Block, ...], str] = file.tables[sheet.name]
    return found


def without_numbers(file: LabFile) -> InputError:
    """Error for a workbook whose sheets have no table; for a text file `blocks` raises it."""
    return file.error(
        "expected rows of two or more numbers, found none (a row with a word, date or clock time is none)"
    )


def _find(file: LabFile, sheet: Sheet) -> tuple[tuple[Block, ...], str]:
    separator = separator_of(file, sheet.rows[:_SAMPLE])
    found: list[Block] = []
    above: list[Row] = []
    k = 0
    while k < len(sheet.rows):
        row = sheet.rows[k]
        if row.empty or not is_numeric(split(row, separator)):
            above.append(row)
            k += 1
            continue
        end = k
        while end < len(sheet.rows) and not sheet.rows[end].empty:
            if not any(is_number(c) for c in split(sheet.rows[end], separator)):
                break
            end += 1
        found.append(_block(file, sheet, above, sheet.rows[k:end], separator))
        above, k = [], end
    return tuple(found), separator


def _block(file: LabFile, sheet: Sheet, above: Sequence[Row], rows: tuple[Row, ...], separator: str) -> Block:
    given = [r for r in above if not r.empty]
    names = split(given[-2], separator) if len(given) > 1 else ()
    units = given.pop() if given and is_units(split(given[-1], separator), names) else None
    if not given or any(is_number(c) for c in split(given[-1], separator)):
        raise file.error(
            "expected a line with the names of the columns above the numbers", rows[0], sheet=sheet.name
        )
    header = given.pop()
    return Block(above=tuple(given), header=header, units=units, rows=rows)


def is_units(cells: Sequence[str], names: Sequence[str] = ()) -> bool:
    """True if a row holds units, two or more; of a table with this many names above it, most may suffice."""
    given = [c for c in cells if c]
    known = sum(unit(c) is not None or c in ("()", "[]") for c in given)
    if known < 2 or any(is_number(c) for c in given):
        return False
    below = len([c for c in names if c]) >= len(given) and not any(is_number(c) for c in names)
    return known == len(given) or (below and 2 * known > len(given) and all(len(c) < 12 for c in given))


def table(
    file: LabFile,
    header: Sequence[str],
    units: Sequence[str] | None,
    rows: Sequence[Row],
    separator: str,
    *,
    name: str = "",
    parameters: Mapping[str, str] | None = None,
    sheet: str = "",
    header_line: int | None = None,
    skip: int = 0,
) -> LabTest:
    """A test of these columns and rows.

    Parameters
    ----------
    file, separator
        The file, and what separates its cells.
    header, units : sequence of str
        Cells of the header, and of the row of units where there is one.
    rows : sequence of Row
        Its numbers.
    name, parameters, sheet : optional
        As in `LabTest`.
    header_line : int, optional
        Number of the header's line, for messages.
    skip : int
        Cells before the first column of each row.

    Raises
    ------
    InputError
        A row has too few or too many cells, or a name of a column stands there twice.
    """
    names = list(header)
    while names and not names[-1]:
        names.pop()
    count = len(names)
    for k, text in enumerate(names):
        if text and text in names[:k]:
            raise file.error(
                f"column {text} stands there twice, expected one test below another, not side by side",
                header_line,
                sheet=sheet,
            )
    cells: list[tuple[str, ...]] = []
    for row in rows:
        given = split(row, separator)[skip:]
        if any(given[count:]) or len(given) < count:
            got = max((k + 1 for k, v in enumerate(given) if v), default=0)
            raise file.error(
                f"expected {count} values ({', '.join(names)[:80]}), got {got}", row, sheet=sheet
            )
        cells.append(given[:count])
    columns = []
    for k, text in enumerate(names):
        own, stated = name_and_unit(text)
        below = unit(units[k]) if units is not None and k < len(units) else None
        if below is not None:
            own, stated = (own if stated is not None and stated.dimension == below.dimension else text), below
        values = [row[k] for row in cells]
        if stated is not None and stated.dimension == "ratio" and stated.factor == 1.0:
            # a share that a workbook shows in percent, below a header in mm/mm
            shares = [k + skip in row.percent and is_number(v) for row, v in zip(rows, values, strict=True)]
            values = [f"{float(v) / 100:.15g}" if s else v for v, s in zip(values, shares, strict=True)]
        columns.append(Column(header=own, unit=stated, quantity=quantity(own, stated), cells=tuple(values)))
    return LabTest(
        file=file,
        name=name,
        columns=tuple(columns),
        rows=tuple(r.number for r in rows),
        parameters=dict(parameters or {}),
        sheet=sheet,
    )


def from_block(
    file: LabFile,
    block: Block,
    separator: str,
    *,
    name: str = "",
    parameters: Mapping[str, str],
    sheet: str = "",
) -> LabTest:
    """A test of a block."""
    return table(
        file,
        split(block.header, separator),
        None if block.units is None else split(block.units, separator),
        block.rows,
        separator,
        name=name,
        parameters=parameters,
        sheet=sheet,
        header_line=block.header.number,
    )


def parameters_of(rows: Sequence[Row], separators: Sequence[str]) -> dict[str, str]:
    """Names and values that stand above a table: "Length;33", "Geometry : Diameter,14,mm", "Height: 30mm"."""
    found: dict[str, str] = {}
    for row in rows:
        for separator in separators:
            cells = [c for c in split(row, separator) if c]
            if len(cells) > 1:
                found.setdefault(cells[0].rstrip(": "), " ".join(cells[1:]))
                break
        else:
            name, colon, value = row.text.strip(" \t;,").partition(":")
            if colon and value.strip():
                found.setdefault(name.strip(), value.strip())
    return found
