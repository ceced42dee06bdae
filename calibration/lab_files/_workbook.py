"""Sheets of an .xlsx workbook (ECMA-376), by the standard library: cells' values, no formulas or formats."""

from __future__ import annotations

import re
import zipfile
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree

from calibration.errors import InputError
from calibration.lab_files._text import LARGEST_FILE, LabFile, Row, Sheet

_MAIN = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"
_LINK = "{http://schemas.openxmlformats.org/officeDocument/2006/relationships}id"
_PACKAGE = "{http://schemas.openxmlformats.org/package/2006/relationships}"
_MOST_COLUMNS = 1000


def workbook(path: Path, content: bytes) -> LabFile:
    """The sheets of a workbook, with their cells as text.

    Raises
    ------
    InputError
        It is no workbook, or damaged, or larger than a machine writes one.
    """
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > LARGEST_FILE:
                raise InputError(f"{path}: expected at most {LARGEST_FILE / 1e6:.0f} MB when unpacked")
            names = set(archive.namelist())
            if "xl/workbook.xml" not in names:
                raise InputError(
                    f"{path}: expected a workbook (.xlsx) or text, it is another kind of archive"
                )
            shared: list[str] = []
            if "xl/sharedStrings.xml" in names:
                for item in _xml(archive, "xl/sharedStrings.xml", path).iter(f"{_MAIN}si"):
                    shared.append("".join(t.text or "" for t in item.iter(f"{_MAIN}t")))
            targets = {
                link.get("Id"): link.get("Target", "")
                for link in _xml(archive, "xl/_rels/workbook.xml.rels", path).iter(f"{_PACKAGE}Relationship")
            }
            sheets = []
            for entry in _xml(archive, "xl/workbook.xml", path).iter(f"{_MAIN}sheet"):
                target = targets.get(entry.get(_LINK), "").lstrip("/")
                part = target if target.startswith("xl/") else f"xl/{target}"
                if part in names:
                    rows = tuple(_rows(_xml(archive, part, path), shared, path))
                    sheets.append(Sheet(name=entry.get("name", ""), rows=rows))
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError, EOFError, NotImplementedError):
        raise InputError(f"{path}: expected a workbook (.xlsx) that can be unpacked, it is damaged") from None
    if not any(sheet.rows for sheet in sheets):
        raise InputError(f"{path}: expected a sheet with cells, the workbook is empty")
    return LabFile(path=path, sheets=tuple(s for s in sheets if s.rows), workbook=True)


def _xml(archive: zipfile.ZipFile, part: str, path: Path) -> ElementTree.Element:
    content = archive.read(part)
    if b"<!DOCTYPE" in content[:2000] or b"<!ENTITY" in content:
        raise InputError(f"{path}: expected a workbook without entities in {part}")
    return ElementTree.fromstring(content)


def _rows(root: ElementTree.Element, shared: list[str], path: Path) -> list[Row]:
    rows: list[Row] = []
    for element in root.iter(f"{_MAIN}row"):
        number = int(element.get("r") or len(rows) + 1)
        cells: list[str] = []
        for cell in element.iter(f"{_MAIN}c"):
            at = _column(cell.get("r", "")) if cell.get("r") else len(cells)
            if at >= _MOST_COLUMNS:
                raise InputError(f"{path}: row {number}: expected at most {_MOST_COLUMNS} columns")
            cells += [""] * (at + 1 - len(cells))
            cells[at] = _value(cell, shared).strip()
        rows += [Row(number=k, text="") for k in range(len(rows) + 1, min(number, len(rows) + 1000))]
        rows.append(Row(number=number, text="\t".join(cells), cells=tuple(cells)))
    return rows


def _column(reference: str) -> int:
    """0 of A7, 27 of AB7."""
    letters = re.match(r"[A-Z]+", reference)
    at = 0
    for letter in letters[0][:4] if letters else "A":
        at = 26 * at + ord(letter) - 64
    return at - 1


def _value(cell: ElementTree.Element, shared: list[str]) -> str:
    if cell.get("t") == "inlineStr":
        return "".join(t.text or "" for t in cell.iter(f"{_MAIN}t"))
    value = cell.find(f"{_MAIN}v")
    text = "" if value is None else value.text or ""
    if cell.get("t") == "s":
        return shared[int(text)] if text.isdigit() and int(text) < len(shared) else ""
    if cell.get("t") in ("str", "b", "e"):
        return text
    return text
