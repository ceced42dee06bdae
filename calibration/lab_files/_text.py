"""A file of a machine as rows of cells: its separator and its decimals found and not guessed."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from calibration.errors import InputError

LARGEST_FILE = 300_000_000  # bytes
SEPARATORS = {"\t": "tabs", ";": "semicolons", ",": "commas"}

_MARK = re.compile(r"\[[A-Za-z][\w /-]*\]|<[A-Za-z][\w /-]*>")
_POINT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_COMMA = re.compile(r"[+-]?(\d+,?\d*|,\d+)([eE][+-]?\d+)?")
_THOUSANDS_POINT = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d+)?")  # 1,234.5 and 1,234
_THOUSANDS_COMMA = re.compile(r"[+-]?[1-9]\d{0,2}(\.\d{3})+(,\d+)?")  # 1.234,5 and 1.234


@dataclass(frozen=True, kw_only=True)
class Row:
    """A line of a file, or a row of a sheet, counted from 1.

    cells : cells of a sheet; a line is split later.
    percent : indices of the cells that the workbook shows in percent.
    """

    number: int
    text: str
    cells: tuple[str, ...] = ()
    percent: frozenset[int] = frozenset()

    @property
    def empty(self) -> bool:
        return not self.text.strip(" \t;,\"'")


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Rows of a text file (name ""), or of one sheet of a workbook, whose cells are split already."""

    name: str
    rows: tuple[Row, ...]


@dataclass(frozen=True, kw_only=True)
class LabFile:
    """A file as a machine wrote it.

    Attributes
    ----------
    path : Path
    sheets : tuple of Sheet
        One for a text file.
    workbook : bool
    """

    path: Path
    sheets: tuple[Sheet, ...]
    workbook: bool = False
    _texts: list[str] = field(default_factory=list, repr=False, compare=False)
    tables: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)  # found once, by sheet

    @property
    def rows(self) -> tuple[Row, ...]:
        """Blocks of the first sheet: all of a text file."""
        return self.sheets[0].rows

    def has(self, *marks: str) -> bool:
        """True if lines of their own, but for blanks and case, are these marks."""
        if not self._texts:
            self._texts.extend(r.text.strip().lower() for s in self.sheets for r in s.rows)
        return all(mark.lower() in self._texts for mark in marks)

    @property
    def sections(self) -> bool:
        """True if lines of their own are marks in brackets, [step] or <DATA>: then it is no plain table."""
        return not self.workbook and any(
            row.text[:1] in ("[", "<") and _MARK.fullmatch(row.text.strip()) for row in self.rows
        )

    def error(self, text: str, row: Row | int | None = None, *, sheet: str = "") -> InputError:
        """An error at a line of this file, as one sentence."""
        number = row.number if isinstance(row, Row) else row
        where = f" sheet {sheet}:" if sheet else ""
        line = "" if number is None else f" {'row' if self.workbook else 'line'} {number}:"
        return InputError(f"{self.path}:{where}{line} {text}")


def split(row: Row, separator: str) -> tuple[str, ...]:
    """Cells of a row, without blanks around them, and without the empty one behind a last separator."""
    if row.cells:
        return row.cells
    try:
        cells = next(csv.reader([row.text], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        cells = row.text.split(separator)
    return tuple(cell.strip() for cell in cells)


def is_number(cell: str) -> bool:
    """True if a cell is a number, in either style of decimals."""
    return any(p.fullmatch(cell) for p in (_POINT, _COMMA, _THOUSANDS_POINT, _THOUSANDS_COMMA))


def is_numeric(cells: Sequence[str]) -> bool:
    """True if a row holds two or more numbers and nothing else."""
    given = [c for c in cells if c]
    return len(given) > 1 and all(is_number(c) for c in given)


def separator_of(file: LabFile, rows: Sequence[Row]) -> str:
    """The separator under which most rows are numbers.

    Raises
    ------
    InputError
        None is, or two are alike.
    """
    if file.workbook:
        return "\t"
    counts = {s: sum(is_numeric(split(row, s)) for row in rows) for s in SEPARATORS}
    most = max(counts.values())
    found = [s for s, count in counts.items() if count == most]
    if not most:
        raise file.error(
            "expected rows of two or more numbers, separated by tabs, semicolons or commas, found none"
        )
    if len(found) > 1:
        names = " and as ".join(SEPARATORS[s] for s in found)
        raise file.error(f"expected one separator of columns, its rows read as separated by {names}")
    return found[0]


def decimals_of(
    file: LabFile, cells: Sequence[str], stated: str | None = None, *, separator: str = ""
) -> str:
    """The mark of decimals, "." or ",", that all these cells agree on.

    Parameters
    ----------
    cells : sequence of str
        Cells of numbers.
    stated : {"point", "comma"}, optional
        Decimal separator that the lab states.
    separator : str
        Separator of the columns: a semicolon is that of a language whose decimals have a comma.

    Raises
    ------
    InputError
        Cells contradict each other or the statement, or could be either ("1,234"; "1.234" with semicolons).
    """
    commas = [c for c in cells if "," in c]
    points = [c for c in cells if "." in c]
    # a comma before other than three digits, or behind a zero, is no mark of thousands; and the reverse
    decimal_comma = [c for c in commas if not _THOUSANDS_POINT.fullmatch(c)]
    decimal_point = [c for c in points if not _THOUSANDS_COMMA.fullmatch(c)]
    if stated is not None:
        wrong = decimal_comma if stated == "point" else decimal_point
        if wrong:
            raise file.error(f"expected decimals with a {stated}, as the answers say, got {wrong[0]!r}")
        return "." if stated == "point" else ","
    if decimal_comma and decimal_point:
        raise file.error(
            f"expected one mark of decimals, got {decimal_comma[0]!r} and {decimal_point[0]!r} in one file"
        )
    if decimal_comma:
        return ","
    if decimal_point or not (commas or (points and separator == ";")):
        return "."
    either = [*commas, *points][0]
    raise file.error(
        f"expected decimals that can be told from thousands, {either!r} may be either: state decimals"
        " (comma or point)"
    )


def number(cell: str, decimals: str) -> float:
    """A cell as a number; ValueError where it is none under this mark of decimals."""
    if decimals == ",":
        if not (_COMMA.fullmatch(cell) or _THOUSANDS_COMMA.fullmatch(cell)):
            raise ValueError(cell)
        return float(cell.replace(".", "").replace(",", "."))
    if not (_POINT.fullmatch(cell) or _THOUSANDS_POINT.fullmatch(cell)):
        raise ValueError(cell)
    return float(cell.replace(",", ""))
