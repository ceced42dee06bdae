"""Formats of machines: which there are, and which one a file is in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from calibration.errors import InputError
from calibration.lab_files._open import open_lab_file
from calibration.lab_files._table import LabTest
from calibration.lab_files._text import LabFile


@dataclass(frozen=True, kw_only=True)
class Importer:
    """Reader of the files of one machine.

    Attributes
    ----------
    name : str
        Name in answers files and messages.
    about : str
        The layout in a sentence.
    recognises : callable
        A file to whether it is in this format, from its content; it raises nothing.
    read : callable
        A file to its tests, one or more; raises InputError, one sentence with the file and the line.
    """

    name: str
    about: str
    recognises: Callable[[LabFile], bool]
    read: Callable[[LabFile], tuple[LabTest, ...]]


FEWEST_ROWS = 3  # of a test

_IMPORTERS: dict[str, Importer] = {}


def register(importer: Importer) -> None:
    """Make a format known. ValueError where its name is taken."""
    if importer.name in _IMPORTERS:
        raise ValueError(f"importer {importer.name}: it is registered already")
    _IMPORTERS[importer.name] = importer


def importers() -> tuple[Importer, ...]:
    """All formats that are known."""
    return tuple(_IMPORTERS.values())


def read_lab_file(path: str | Path, *, format: str | None = None) -> tuple[str, tuple[LabTest, ...]]:
    """The tests of a file that a machine wrote.

    Parameters
    ----------
    path : path
    format : str, optional
        Name of its importer; left out, it is found from the file's content.

    Returns
    -------
    format : str
    tests : tuple of LabTest

    Raises
    ------
    InputError
        No importer recognises the file, more than one does, or it is damaged: one sentence with the file, the
        line, and what was expected.
    """
    if format is not None and format not in _IMPORTERS:
        raise InputError(f"format {format}: expected one of {', '.join(_IMPORTERS)}")
    file = open_lab_file(Path(path))
    if format is None:
        found = [i.name for i in _IMPORTERS.values() if _recognises(i, file)]
        if len(found) > 1:
            raise InputError(
                f"{path}: it reads as {' and as '.join(found)}: expected one format, state which (format)"
            )
        if not found:
            raise _unknown(file)
        format = found[0]
    tests = _IMPORTERS[format].read(file)
    long_enough = tuple(test for test in tests if len(test.rows) >= FEWEST_ROWS)
    if not long_enough:  # next to longer ones these are steps that were stopped at once, or find the contact
        few = tests[0]
        got = f"expected at least {FEWEST_ROWS} rows of numbers, got {len(few.rows)}"
        raise file.error(got, few.rows[0] if few.rows else None, sheet=few.sheet)
    return format, long_enough


def _recognises(importer: Importer, file: LabFile) -> bool:
    try:
        return importer.recognises(file)
    except InputError:  # damaged: said by the format that it is in, or by `_unknown`
        return False


def _unknown(file: LabFile) -> InputError:
    """Why no importer took a file: what is wrong with its table, or that there is none that it knows."""
    from calibration.lab_files._table import blocks, without_numbers

    try:
        tables = [blocks(file, sheet)[0] for sheet in file.sheets]
    except InputError as error:
        return error
    if not any(tables):
        return without_numbers(file)
    return InputError(
        f"{file.path}: expected an export of {', '.join(_IMPORTERS)}, its content is none of them (csv: the"
        " line with the names of the columns comes first, or state format: csv)"
    )
