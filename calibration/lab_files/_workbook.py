"""Sheets of an .xlsx workbook by openpyxl (`pip install 'tisim[lab]'`): values of cells, no formulas."""

from __future__ import annotations

import contextlib
import warnings
import zipfile
from collections.abc import Iterator
from datetime import date, datetime, time
from io import BytesIO
from pathlib import Path
from typing import Any

from calibration.errors import InputError
from calibration.lab_files._text import LARGEST_FILE, LabFile, Row, Sheet

_MOST_ROWS = 1_048_576  # of the format
_MOST_COLUMNS = 1000


def workbook(path: Path, content: bytes) -> LabFile:
    """The sheets of a workbook, with their cells as text.

    Raises
    ------
    InputError
        It is no workbook, or damaged, or larger than a machine writes one.
    ModuleNotFoundError
        openpyxl is not installed.
    """
    _check_archive(path, content)
    with warnings.catch_warnings():
        # of styles, headers and extensions that it does not know, none of which is read
        warnings.simplefilter("ignore")
        from openpyxl import load_workbook

        try:
            with contextlib.closing(
                load_workbook(BytesIO(content), read_only=True, data_only=True, keep_links=False)
            ) as book:
                sheets = []
                for sheet in book.worksheets:
                    sheet.reset_dimensions()  # as stated in the file, by some programs wrongly
                    rows = tuple(_rows(sheet.iter_rows(), f"{path}: sheet {sheet.title}:"))
                    if not all(row.empty for row in rows):
                        sheets.append(Sheet(name=sheet.title, rows=rows))
        except (InputError, MemoryError):
            raise
        except Exception as error:  # openpyxl states none of its own: damage shows as whatever it met
            raise _damaged(path) from error
    if not sheets:
        raise InputError(f"{path}: expected a sheet with cells, the workbook is empty")
    return LabFile(path=path, sheets=tuple(sheets), workbook=True)


def _check_archive(path: Path, content: bytes) -> None:
    """Refuse what is no workbook, and what would fill the memory, before anything is unpacked."""
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            entries = archive.infolist()
    except (zipfile.BadZipFile, NotImplementedError, ValueError, EOFError) as error:
        raise _damaged(path) from error
    if sum(entry.file_size for entry in entries) > LARGEST_FILE:
        raise InputError(f"{path}: expected at most {LARGEST_FILE / 1e6:.0f} MB when unpacked")
    if not any(entry.filename.startswith("xl/") for entry in entries):
        raise InputError(f"{path}: expected a workbook (.xlsx) or text, it is another kind of archive")


def _damaged(path: Path) -> InputError:
    return InputError(f"{path}: expected a workbook (.xlsx) that can be unpacked, it is damaged")


def _rows(values: Iterator[tuple[Any, ...]], where: str) -> Iterator[Row]:
    """Rows, counted from 1 as the workbook shows them; of empty ones that follow each other the first."""
    filled = True
    for number, row in enumerate(values, 1):
        if number > _MOST_ROWS:
            raise InputError(f"{where} expected at most {_MOST_ROWS} rows")
        if len(row) > _MOST_COLUMNS:
            raise InputError(f"{where} row {number}: expected at most {_MOST_COLUMNS} columns")
        cells = tuple(_text(cell.value, cell.number_format) for cell in row)
        shares = frozenset(k for k, cell in enumerate(row) if "%" in (cell.number_format or ""))
        if filled or any(cells):
            yield Row(number=number, text="\t".join(cells), cells=cells, percent=shares)
        filled = any(cells)


def _text(value: object, shown: str) -> str:
    """A cell as the importers read it: numbers without loss, dates and clock times as text, no numbers.

    A share that the workbook shows in percent (`shown` is its format) is the number that it shows.
    """
    if isinstance(value, int | float) and not isinstance(value, bool) and "%" in shown:
        value = float(f"{100 * value:.15g}")
    match value:
        case None:
            return ""
        case bool():
            return str(value).upper()
        case float():
            return repr(value)
        case datetime() | date() | time():
            return value.isoformat()
        case _:
            return str(value).strip()
