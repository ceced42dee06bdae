"""Workbooks of testing machines are read by openpyxl, or refused in one sentence."""

from __future__ import annotations

import datetime
import io
import sys
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest
from lab_columns import column
from typer.testing import CliRunner

from calibration.errors import InputError
from calibration.lab_files import _workbook, read_lab_file
from calibration.lab_files._open import open_lab_file
from calibration.new import app

openpyxl = pytest.importorskip("openpyxl")

TABLE = [["Time (s)", "Load (N)"], *([0.1 * k, 2 * k] for k in range(4))]


def workbook(path: Path, sheets: dict[str, list[list[object]]]) -> Path:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def another_program(path: Path, **parts: str) -> Path:
    """Write a workbook like another program's, with two sheets without styles.

    Texts are inline in the first sheet and shared in the second, which states a wrong size and leaves out
    empty rows and cells. `parts` replace files of the archive.
    """
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    of = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    numbers = "".join(
        f'<row r="{k}"><c r="B{k}"><v>{0.1 * (k - 6)!r}</v></c><c r="C{k}"><v>-{k - 6}E-1</v></c></row>'
        for k in range(6, 10)
    )
    content = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        f'<Override PartName="/xl/workbook.xml" ContentType="{of}.sheet.main+xml"/>'
        f'<Override PartName="/xl/sharedStrings.xml" ContentType="{of}.sharedStrings+xml"/></Types>',
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets>'
        '<sheet name="Parameter" sheetId="1" r:id="a"/><sheet name="Probe 1" sheetId="2" r:id="b"/>'
        "</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Id="a" Type="{office}/worksheet" Target="worksheets/sheet1.xml"/>'
        f'<Relationship Id="b" Type="{office}/worksheet" Target="/xl/worksheets/sheet2.xml"/>'
        "</Relationships>",
        "xl/sharedStrings.xml": f'<sst xmlns="{main}"><si><t>Standardweg</t></si>'
        "<si><r><t>Standard</t></r><r><t>kraft</t></r></si><si><t>mm</t></si><si><t>N</t></si></sst>",
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{main}"><sheetData><row>'
        '<c t="inlineStr"><is><t>Vorkraft</t></is></c><c><v>0.1</v></c>'
        '<c t="inlineStr"><is><t>N</t></is></c></row></sheetData></worksheet>',
        "xl/worksheets/sheet2.xml": f'<worksheet xmlns="{main}"><dimension ref="A1:B2"/><sheetData>'
        '<row r="4"><c r="B4" t="s"><v>0</v></c><c r="C4" t="s"><v>1</v></c></row>'
        f'<row r="5"><c r="B5" t="s"><v>2</v></c><c r="C5" t="s"><v>3</v></c></row>{numbers}'
        "</sheetData></worksheet>",
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in {**content, **parts}.items():
            archive.writestr(name, text)
    return path


def test_zwick_workbooks_have_a_sheet_a_test(tmp_path: Path) -> None:
    first = [["Prüfzeit", "Standardweg", "Standardkraft"], ["s", "mm", "N"]]
    first += [[k, 0.5 * k, -0.1 * k] for k in range(5)]
    above = [["Vorkraft", 0.1, "N"], ["Datum", datetime.datetime(2026, 11, 23, 9, 30)]]
    path = workbook(tmp_path / "zwick.xlsx", {"Parameter": above, "Probe 1": first, "Probe 2": first[:6]})
    found, tests = read_lab_file(path)
    assert (found, [(t.name, len(t.rows)) for t in tests]) == ("zwick", [("Probe 1", 5), ("Probe 2", 4)])
    assert column(tests[0], "Standardkraft") == pytest.approx([0.0, -0.1, -0.2, -0.3, -0.4])


def test_a_table_in_a_workbook(tmp_path: Path) -> None:
    found, (test,) = read_lab_file(workbook(tmp_path / "table.xlsx", {"Sheet1": TABLE}))
    assert found == "csv"
    assert column(test, "Load") == pytest.approx([0.0, 2.0, 4.0, 6.0])
    (bad,) = read_lab_file(workbook(tmp_path / "bad.xlsx", {"Sheet1": [*TABLE, [5.0, "lost"]]}))[1]
    said = "bad.xlsx: sheet Sheet1: row 6: column Load: expected a number, got 'lost'"
    with pytest.raises(InputError, match=said):
        bad.numbers(bad.columns[1])


def test_a_workbook_of_another_program(tmp_path: Path) -> None:
    found, (test,) = read_lab_file(another_program(tmp_path / "other.xlsx"))
    assert (found, test.name, test.rows) == ("zwick", "Probe 1", (6, 7, 8, 9))
    assert test.columns[1].cells[3] == "0.30000000000000004"  # full precision
    assert column(test, "Standardweg").tolist() == [0.0, 0.1e-3, 0.2e-3, (0.1 * 3) * 1e-3]
    assert column(test, "Standardkraft").tolist() == [0.0, -0.1, -0.2, -0.3]


def test_cells_keep_their_values(tmp_path: Path) -> None:
    """Numbers are exact, and other values do not become numbers, for example the day count of a date."""
    day = datetime.date(2026, 11, 23)
    values = [0.1, 1e-300, -7, 10**15, True, day, datetime.time(9, 30), " a ", None, "#DIV/0!"]
    (sheet,) = open_lab_file(workbook(tmp_path / "cells.xlsx", {"Sheet1": [[], values]})).sheets
    assert [row.number for row in sheet.rows] == [1, 2]
    assert sheet.rows[1].cells[:5] == ("0.1", "1e-300", "-7", "1000000000000000", "TRUE")
    assert sheet.rows[1].cells[5:] == ("2026-11-23T00:00:00", "09:30:00", "a", "", "#DIV/0!")


def test_a_share_shown_in_percent_is_the_number_that_is_shown(tmp_path: Path) -> None:
    path = workbook(
        tmp_path / "a.xlsx", {"Sheet1": [["Strain [%]", "Stress (kPa)"], *([0.1 * k, k] for k in range(6))]}
    )
    book = openpyxl.load_workbook(path)
    for row in range(2, 8):
        book.active.cell(row, 1).number_format = "0.00%"
    book.save(path)
    (test,) = read_lab_file(path)[1]
    assert column(test, "Strain") == pytest.approx(0.1 * np.arange(6))


def test_openpyxl_warns_nobody(tmp_path: Path) -> None:
    """openpyxl's warnings, for example about missing styles, are suppressed."""
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    path = another_program(tmp_path / "a.xlsx", **{"xl/styles.xml": f'<styleSheet xmlns="{main}"/>'})
    with pytest.warns(UserWarning, match="no stylesheet"):
        openpyxl.load_workbook(path)
    with warnings.catch_warnings(record=True, action="always") as given:
        read_lab_file(path)
    assert not given


def zipped(**parts: bytes) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, part in parts.items():
            archive.writestr(name, part)
    return content.getvalue()


def test_what_is_no_workbook_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.xlsx"

    def said() -> str:
        with pytest.raises(InputError) as caught:
            read_lab_file(path)
        return str(caught.value).removeprefix(f"{path}: ")

    damaged = "expected a workbook (.xlsx) that can be unpacked, it is damaged"
    path.write_bytes(zipped(**{"word/document.xml": b"<a/>"}))
    assert said() == "expected a workbook (.xlsx) or text, it is another kind of archive"
    path.write_bytes(zipped(**{"xl/workbook.xml": b"<a/>"}))
    assert said() == damaged
    another_program(path, **{"xl/sharedStrings.xml": "<sst>"})
    assert said() == damaged
    lines = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 10))
    entities = f'<!DOCTYPE sst [<!ENTITY a0 "{"a" * 100}">{lines}]><sst>&a9;</sst>'
    another_program(path, **{"xl/sharedStrings.xml": entities})
    assert said() == damaged
    workbook(path, {"Sheet1": [], "Sheet2": []})
    assert said() == "expected a sheet with cells, the workbook is empty"
    clock = datetime.datetime(2026, 11, 23, 9)
    workbook(path, {"Sheet1": [["Time", "Load (N)"], *([clock, k] for k in range(5))]})
    assert said().startswith("expected rows of two or more numbers, found none (a row with a word, date or")
    another_program(path)
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size // 2)
    assert said() == damaged
    for row, expected in (("A99999999999", "at most 1048576 rows"), ("ALM1", "at most 1000 columns")):
        number = row.lstrip("ALM")
        rows = f'<row r="{number}"><c r="{row}"><v>1</v></c></row>'
        main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
        sheet = f'<worksheet xmlns="{main}"><sheetData>{rows}</sheetData></worksheet>'
        another_program(path, **{"xl/worksheets/sheet1.xml": sheet})
        assert expected in said()
    monkeypatch.setattr(_workbook, "LARGEST_FILE", 1000)
    assert said() == "expected at most 0 MB when unpacked"


def test_damage_is_read_or_refused_in_a_sentence(tmp_path: Path) -> None:
    """Changed or removed bytes of the archive's files, 60 times: no error other than InputError occurs."""
    rng = np.random.default_rng(7)
    with zipfile.ZipFile(another_program(tmp_path / "whole.xlsx")) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    path = tmp_path / "damaged.xlsx"
    said = []
    for _ in range(60):
        name = list(parts)[rng.integers(len(parts))]
        content = bytearray(parts[name])
        at = int(rng.integers(len(content)))
        if rng.integers(2):
            content[at] = int(rng.integers(32, 127))
        else:
            del content[at : at + int(rng.integers(1, 20))]
        path.write_bytes(zipped(**{**parts, name: bytes(content)}))
        try:
            for test in read_lab_file(path)[1]:
                for given in test.columns:
                    test.numbers(given)
        except InputError as error:
            said.append(str(error))
    assert len(said) > 10
    assert all(text.startswith(f"{path}:") and "\n" not in text for text in said)


def test_a_workbook_without_openpyxl_ends_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = workbook(tmp_path / "table.xlsx", {"Sheet1": TABLE})
    shown = CliRunner().invoke(app, ["--show", str(path)])
    assert (shown.exit_code, "Load" in shown.stdout) == (0, True)
    monkeypatch.setitem(sys.modules, "openpyxl", None)  # as if it were not installed
    done = CliRunner().invoke(app, ["--show", str(path)])
    assert done.exit_code == 2
    assert done.stderr.strip() == "error: the package openpyxl is not installed: pip install 'tisim[lab]'"
