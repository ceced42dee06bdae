"""Open a file of a machine, text in any of the usual encodings or a workbook, as rows."""

from __future__ import annotations

import codecs
from pathlib import Path

from calibration.errors import InputError
from calibration.lab_files._text import LARGEST_FILE, LabFile, Row, Sheet
from calibration.lab_files._workbook import workbook


def open_lab_file(path: Path) -> LabFile:
    """Read a file's text.

    Raises
    ------
    InputError
        The file is missing, empty, too large, or no text; a sentence that names it.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(f"{path}: expected at most {LARGEST_FILE / 1e6:.0f} MB")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: expected a file that can be read ({error.strerror})") from None
    if content[:4] == b"PK\x03\x04":
        return workbook(path, content)
    if content[:8] == b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1":
        raise InputError(f"{path}: an old Excel workbook (.xls); expected it saved as .xlsx or as text")
    text = _decode(content, path)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: expected the export of a machine, the file is empty")
    rows = tuple(Row(number=k, text=line) for k, line in enumerate(lines, 1))
    return LabFile(path=path, sheets=(Sheet(name="", rows=rows),))


def _decode(content: bytes, path: Path) -> str:
    """UTF-8, UTF-16 with its mark, or Windows' Western code page, as machines write."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        encoding = "utf-16"
    else:
        encoding = "utf-8-sig"
        if b"\0" in content[:4096]:
            raise InputError(f"{path}: expected text, the file is binary")
    try:
        return content.decode(encoding)
    except UnicodeDecodeError:
        try:
            return content.decode("cp1252")
        except UnicodeDecodeError:
            raise InputError(f"{path}: expected text in UTF-8, UTF-16 or Windows-1252") from None
