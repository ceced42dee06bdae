"""Invalid files of machines: one sentence, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from malformed_files import Case, check_refused, lines, same, swap

CASES: dict[str, Case] = {
    # files
    "empty": ("pull", lambda _: "", {}, "instron.csv:", "the file is empty"),
    "binary": ("pull", lambda _: b"\x00\x01" * 50, {}, "instron.csv:", "expected text, the file is binary"),
    "old workbook": (
        "pull",
        lambda _: b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 40,
        {},
        "instron.csv:",
        "an old Excel workbook (.xls); expected it saved as .xlsx or as text",
    ),
    "damaged workbook": ("pull", lambda _: b"PK\x03\x04 nothing", {}, "instron.csv:", "it is damaged"),
    "prose": ("pull", lambda _: "dear lab\nhere it is\n", {}, "instron.csv:", "expected rows of two or more"),
    "no header": (
        "strip",
        lines(1, 1),
        {},
        "plain.csv: line 1:",
        "expected a line with the names of the columns above the numbers",
    ),
    "nobody's format": (
        "strip",
        lambda text: "some lab\n" + text,
        {},
        "plain.csv:",
        "expected an export of instron, mach-1, csv, trios, zwick",
    ),
    "two formats": (
        "strip",
        lambda text: "<INFO>\n<DATA>\n[step]\n" + text,
        {},
        "plain.csv:",
        "it reads as mach-1 and as trios",
    ),
    "wrong format stated": ("strip", same, {"format": "trios"}, "plain.csv:", "expected [step] blocks"),
    "unknown format": ("strip", same, {"format": "mts"}, "format mts:", "expected one of instron"),
    # tables
    "a word in a cell": (
        "strip",
        lines(9, 9, "7.00,overload,1.5"),
        {},
        "plain.csv: line 9:",
        "column strain: expected a number, got 'overload'",
    ),
    "an empty cell": ("strip", lines(9, 9, "7.00,,1.5"), {}, "plain.csv: line 9:", "the cell is empty"),
    "not a number": ("strip", lines(9, 9, "7.0,nan,1.5"), {}, "plain.csv: line 9:", "got 'nan'"),
    "a number too large": ("strip", lines(9, 9, "7.0,1e30,1.5"), {}, "plain.csv: line 9:", "below 1e+12"),
    "a short row": ("strip", lines(9, 9, "7.0,1.5"), {}, "plain.csv: line 9:", "expected 3 values"),
    "a long row": ("strip", lines(9, 9, "7.0,7,1.5,8"), {}, "plain.csv: line 9:", "expected 3 values"),
    "two rows": (
        "strip",
        lines(4, 40),
        {},
        "plain.csv: line 2:",
        "expected at least 3 rows of numbers, got 2",
    ),
    "a column twice": (
        "strip",
        swap("Stress (kPa)", "strain %"),
        {},
        "plain.csv: line 1:",
        "column strain % stands there twice",
    ),
    "two tables": (
        "strip",
        lambda text: text + "\n" + text,
        {"format": "csv"},
        "plain.csv: line 34:",
        "expected one table, a second begins here",
    ),
    "points among commas": (
        "pull",
        lines(12, 12, "3,00;2.50;0,06;1"),
        {},
        "instron.csv:",
        "expected one mark of decimals",
    ),
    "thousands or decimals": (
        "strip",
        lambda _: "Time/s;strain %;Stress (kPa)\n1;1,234;1,500\n2;2,345;2,500\n3;3,456;3,500\n",
        {},
        "plain.csv:",
        "'1,234' may be either: state decimals",
    ),
    "decimals stated wrongly": (
        "pull",
        same,
        {"decimals": "point"},
        "instron.csv:",
        "expected decimals with a point, as the answers say",
    ),
    # violations of the formats
    "zwick without units": (
        "squeeze",
        lambda text: text.replace('"s"\t"mm"\t"N"\n', ""),
        {},
        "zwick.txt: line 7:",
        "expected a row of units (s, N, mm)",
    ),
    "trios that lost a point": (
        "shear",
        lines(20, 20),
        {},
        "trios.txt: line 10:",
        "expected 41 points, as it states, got 40",
    ),
    "trios without points": (
        "shear",
        lambda text: text[: text.index("Data point")].replace("41", "0"),
        {},
        "trios.txt:",
        "expected a [step] with rows of numbers",
    ),
    "mach-1 cut off": (
        "push",
        lambda text: text[: text.rindex("<END DATA>")],
        {},
        "mach-1.txt:",
        "expected <END DATA> for the <DATA> of line 38, the file ends before it",
    ),
    "mach-1 data in data": (
        "push",
        lambda text: text.replace("<END DATA>\n", "", 1),
        {},
        "mach-1.txt: line 31:",
        "expected <END DATA> for the <DATA> of line 8, got <INFO>",
    ),
    "mach-1 without names": (
        "push",
        lambda text: text.replace("Time, s\tPosition (z), mm\tFz, gf\n", ""),
        {},
        "mach-1.txt: line 9:",
        "expected the names of the columns below <DATA>",
    ),
    "instron without time": (
        "pull",
        swap("Time;Extension", "Sample;Extension"),
        {},
        "instron.csv: line 7:",
        "expected a table of raw data with a column of time",
    ),
    # clocks
    "a clock that stands": (
        "strip",
        lines(9, 9, "6.00,14.0,9.0"),
        {},
        "plain.csv: line 9:",
        "column Time: expected more than 6 s before it, got 6; leave_out_rows: true",
    ),
    "a clock before 0": ("strip", lines(2, 2, "-1,0,0"), {}, "plain.csv: line 2:", "expected 0 s or more"),
}


@pytest.mark.parametrize("case", CASES)
def test_malformed_records_are_refused(case: str, tmp_path: Path) -> None:
    check_refused(CASES[case], tmp_path)
