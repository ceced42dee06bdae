"""Invalid files, outlines and tables."""

from __future__ import annotations

from changes import OUTLINE, PULL, RECORD, YAML, Case, cell, loop, metres, put, raw, rows, swap_sides

CASES: dict[str, Case] = {
    # files
    "file missing": (
        put("capture", "outline", "beams/none.csv"),
        YAML,
        "key trials[bar].captures[#1].outline:",
        "expected the file beams/none.csv",
    ),
    "photo missing": (
        put("capture", "photo", "none.png"),
        YAML,
        "key trials[bar].captures[#1].photo:",
        "expected the file none.png",
    ),
    "path out of the folder": (
        put("poke", "record", "../poke.csv"),
        YAML,
        "key trials[poke].record:",
        "expected a path inside the experiment's folder",
    ),
    "path out through a folder": (
        put("poke", "record", "pokes/../../poke.csv"),
        YAML,
        "key trials[poke].record:",
        "expected a path inside",
    ),
    "absolute path": (
        put("poke", "record", "/etc/poke.csv"),
        YAML,
        "key trials[poke].record:",
        "expected a path inside",
    ),
    "Windows path": (
        put("poke", "record", "C:\\poke.csv"),
        YAML,
        "key trials[poke].record:",
        "expected a path inside",
    ),
    "the truth": (
        put("poke", "record", "truth.yaml"),
        YAML,
        "key trials[poke].record:",
        "expected a file .csv",
    ),
    # outlines
    "one side": (
        rows(OUTLINE, list(range(12))),
        OUTLINE,
        "column side:",
        "expected at least 3 points of side lower, got 0",
    ),
    "two points a side": (
        rows(OUTLINE, [0, 11, *range(12, 24)]),
        OUTLINE,
        "column side:",
        "expected at least 3 points of side upper, got 2",
    ),
    "third side": (
        cell(OUTLINE, "side", 3, "left"),
        OUTLINE,
        "line 5: column side:",
        "expected upper or lower, got 'left'",
    ),
    "sides swapped": (swap_sides, OUTLINE, "column side:", "expected upper above lower"),
    "side crosses itself": (
        loop,
        OUTLINE,
        "line 9:",
        "expected an outline that does not cross itself, here it crosses the piece that ends at line 7",
    ),
    "sides cross": (
        cell(OUTLINE, "z_mm", 5, -40.0),
        OUTLINE,
        "line 19:",
        "expected an outline that does not cross itself",
    ),
    "point far off": (
        cell(OUTLINE, "x_mm", 7, 9500.0),
        OUTLINE,
        "line 9:",
        "expected a point within 300 mm (3 free lengths)",
    ),
    "outline in metres": (metres, OUTLINE, "side upper:", "expected at least 10% of the free length"),
    "point NaN": (
        cell(OUTLINE, "z_mm", 2, float("nan")),
        OUTLINE,
        "line 4: column z_mm:",
        "expected a finite number, got 'nan'",
    ),
    "point infinite": (
        cell(OUTLINE, "x_mm", 2, float("-inf")),
        OUTLINE,
        "line 4: column x_mm:",
        "expected a finite number, got '-inf'",
    ),
    "point twice": (
        lambda s: [cell(OUTLINE, c, 4, list(s.tables[OUTLINE][c])[3])(s) for c in ("x_mm", "z_mm")],
        OUTLINE,
        "line 6:",
        "expected a point other than the one before",
    ),
    # tables
    "cell is text": (
        cell(RECORD, "force_N", 1, "0.5N"),
        RECORD,
        "line 3: column force_N:",
        "expected a finite number, got '0.5N'",
    ),
    "cell empty": (
        cell(RECORD, "force_N", 1, ""),
        RECORD,
        "line 3: column force_N:",
        "expected a finite number, got ''",
    ),
    "column's unit": (
        raw(PULL, b"stretch,nominal_stress_MPa\n1,0\n"),
        PULL,
        "line 1: unknown column 'nominal_stress_MPa'",
        "expected stretch,nominal_stress_kPa",
    ),
    "column missing": (
        raw(PULL, b"stretch\n1\n"),
        PULL,
        "line 1: missing column nominal_stress_kPa",
        "expected stretch,nominal_stress_kPa",
    ),
    "column twice": (
        raw(PULL, b"stretch,stretch,nominal_stress_kPa\n"),
        PULL,
        "line 1: column stretch",
        "expected it once",
    ),
    "too few cells": (
        raw(PULL, b"stretch,nominal_stress_kPa\n1,0\n\n1.1\n"),
        PULL,
        "line 4:",
        "expected 2 values (stretch,nominal_stress_kPa), got 1",
    ),
    "semicolons": (
        raw(PULL, b"stretch;nominal_stress_kPa\n1;0\n"),
        PULL,
        "line 1: its columns are separated by semicolons",
        "stretch,nominal_stress_kPa",
    ),
    "empty table": (raw(PULL, b""), PULL, "line 1: missing column", "expected stretch,nominal_stress_kPa"),
    "not text": (raw(PULL, b"\xff\xfe\x00"), PULL, "", "expected UTF-8 text"),
}
