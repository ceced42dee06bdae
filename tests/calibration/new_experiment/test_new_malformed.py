"""Invalid files of machines, and invalid answers: one sentence, exit code 2, nothing written."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.testing import CliRunner

from calibration.new import app
from calibration.new._asking import Nobody
from calibration.new._trial import Work

SAMPLES = Path(__file__).resolve().parents[3] / "datasets" / "lab-files"

Change = Callable[[str], str | bytes]


def swap(old: str, new: str) -> Change:
    """Replace the first occurrence, which must exist."""

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


def lines(start: int, end: int, *instead: str) -> Change:
    """Replace lines `start` to `end`, counted from 1, both included."""

    def change(text: str) -> str:
        rows = text.split("\n")
        return "\n".join([*rows[: start - 1], *instead, *rows[end:]])

    return change


def same(text: str) -> str:
    return text


# trial of datasets/lab-files/answers.yaml, change of its file, change of its answers, location and message
CASES: dict[str, tuple[str, Change, dict[str, Any], str, str]] = {
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
    # missing values
    "no unit": (
        "strip",
        swap("strain %", "strain"),
        {},
        "answers.yaml: missing key strip.units.strain:",
        "1 or %",
    ),
    "no such column": (
        "strip",
        same,
        {"columns": {"stress": "Sigma"}},
        "plain.csv:",
        "expected a column 'Sigma' (columns.stress), there are Time, strain, Stress",
    ),
    "no stress": (
        "strip",
        swap("Stress (kPa)", "Laune"),
        {},
        "plain.csv:",
        "expected a column of stress, force or",
    ),
    "two strains": (
        "strip",
        lambda _: "Time/s,strain 1 %,strain 2 %,Stress (kPa)\n0,0,0,0\n1,5,6,4\n2,10,11,7\n",
        {},
        "answers.yaml: missing key strip.columns.strain:",
        "which column holds the strain: strain 1 | strain 2",
    ),
    "no displacement": (
        "push",
        lambda text: text.replace("Position (z), mm\tFz, gf", "Fx, gf\tFz, gf"),
        {},
        "mach-1.txt: test Move Relative:",
        "expected a column of displacement",
    ),
    "a force for the time": (
        "push",
        same,
        {"columns": {"time": "Fz"}},
        "mach-1.txt: test Move Relative:",
        "expected a unit of time for the time, the file says gf",
    ),
    "no time for a poke": (
        "push",
        lambda text: text.replace("Time, s", "Sample"),
        {},
        "mach-1.txt: test Move Relative:",
        "expected a column of time",
    ),
    "which test": (
        "squeeze",
        same,
        {"test": None},
        "answers.yaml: missing key squeeze.test:",
        "which test of zwick.txt, by name or number: Druckversuch 1 | Druckversuch 2",
    ),
    "no such test": (
        "squeeze",
        same,
        {"test": "Zugversuch"},
        "zwick.txt: key squeeze.test:",
        "expected one of",
    ),
    "no such number": (
        "squeeze",
        same,
        {"test": 7},
        "zwick.txt: key squeeze.test:",
        "expected 1 to 2, got 7",
    ),
    "which direction": (
        "squeeze",
        same,
        {"displacement_positive": None},
        "answers.yaml: missing key squeeze.displacement_positive:",
        "tension or compression",
    ),
    "no length": (
        "squeeze",
        swap("Probenhöhe", "Probe"),
        {"rest_length_mm": None},
        "answers.yaml: missing key squeeze.rest_length_mm:",
        "length at rest",
    ),
    "no area": (
        "squeeze",
        swap("Probendurchmesser", "Probe"),
        {"diameter_mm": None},
        "answers.yaml: missing key squeeze.area_mm2:",
        "or diameter_mm, or width_mm and thickness_mm",
    ),
    "no mode": (
        "strip",
        same,
        {"mode": None},
        "answers.yaml: missing key strip.mode:",
        "uniaxial, equibiaxial",
    ),
    "no file": (
        "strip",
        same,
        {"file": "gone.csv"},
        "gone.csv: key strip.file:",
        "expected a file, there is none",
    ),
    # answers
    "unknown key": (
        "strip",
        same,
        {"lenght_mm": 3.0},
        "answers.yaml: unknown key trials[strip].lenght_mm:",
        "expected",
    ),
    "no unit at all": (
        "strip",
        same,
        {"units": {"strain": "furlong"}},
        "answers.yaml: key trials[strip].units.strain:",
        "furlong",
    ),
    "unit of another thing": (
        "strip",
        same,
        {"units": {"strain": "N"}},
        "plain.csv: units.strain:",
        "expected a unit of ratio, got N",
    ),
    "unit of no column": (
        "strip",
        same,
        {"units": {"Strian": "%"}},
        "plain.csv: units.Strian:",
        "expected a column of this name, there are Time, strain, Stress",
    ),
    "two areas": (
        "squeeze",
        same,
        {"area_mm2": 700.0},
        "answers.yaml: key trials[squeeze].area_mm2:",
        "expected one of area_mm2, diameter_mm, or width_mm and thickness_mm",
    ),
    "a length for a strain": (
        "strip",
        same,
        {"rest_length_mm": 40.0},
        "plain.csv: rest_length_mm:",
        "here it comes from the column strain",
    ),
    "an area for a stress": ("strip", same, {"area_mm2": 24.0}, "plain.csv:", "expected a column of force"),
    "force against stress": (
        "strip",
        lambda _: "Time/s,strain %,Stress (kPa),Load (N)\n0,0,0,0\n1,10,7,7\n2,20,13,13\n",
        {"area_mm2": 10.0},
        "answers.yaml: key strip:",
        "the file's force is 100 times its stress on the area of 10 mm2",
    ),
    "negative length": (
        "squeeze",
        same,
        {"rest_length_mm": -15.0},
        "answers.yaml: key trials[squeeze].rest_length_mm:",
        "more than 0",
    ),
    "a poke that leaves the block": (
        "push",
        same,
        {"start_mm": [40.0, 0.0, 20.0]},
        "answers.yaml: key trials[push].start_mm:",
        "above the block's base",
    ),
    "unknown check": (
        "strip",
        same,
        {"accept": ["everything"]},
        "answers.yaml: key trials[strip].accept:",
        "expected names of modulus",
    ),
    "no outline": (
        "beam",
        same,
        {"captures": [{"time_s": 1.0, "outline": "o.csv"}]},
        "o.csv: key beam.captures[#1].outline:",
        "expected a file",
    ),
    # implausible units
    "MPa for kPa": (
        "strip",
        swap("(kPa)", "(MPa)"),
        {},
        "answers.yaml: key strip:",
        "a Young's modulus of 74.9 MPa in a specimen that is stretched to 1.6 is implausible",
    ),
    "Pa for kPa": ("strip", swap("(kPa)", "(Pa)"), {}, "answers.yaml: key strip:", "modulus of 74.9 Pa"),
    "a ratio for %": (
        "strip",
        swap("strain %", "strain [-]"),
        {},
        "answers.yaml: key strip:",
        "stretch of 61 is implausible; is the strain in %",
    ),
    "% for a ratio": (
        "strip",
        lambda _: "Time/s,strain %,Stress (kPa)\n0,0,0\n10,0.05,3.6\n20,0.1,7\n",
        {"accept": ["modulus"]},
        "answers.yaml: key strip:",
        "the largest strain is 0.001",
    ),
    "cm for mm": ("pull", same, {"rest_length_mm": 2.0}, "answers.yaml: key pull:", "stretch of 26"),
    "the push as a pull": (
        "squeeze",
        same,
        {"displacement_positive": "tension", "force_positive": "compression"},
        "answers.yaml: key squeeze:",
        "100% of the stresses act against the strain; which direction is positive?",
    ),
    "ms for seconds": (
        "strip",
        swap("Time/s", "Time/ms"),
        {},
        "answers.yaml: key strip:",
        "a test of 0.03 s",
    ),
    "deeper than the block": (
        "push",
        same,
        {"block_mm": [60.0, 60.0, 1.5], "accept": ["modulus"]},
        "answers.yaml: key push:",
        "more than the block's height",
    ),
    "a rod that pulls": (
        "push",
        same,
        {"displacement_positive": "compression"},
        "answers.yaml: key push:",
        "never goes into the block",
    ),
    "a beam in metres": (
        "beam",
        same,
        {"free_length_mm": 0.1},
        "answers.yaml: key beam:",
        "0.1 mm free length",
    ),
}


def lab(folder: Path, trial: str, change: Change, keys: dict[str, Any]) -> Path:
    """Write a copy of one trial of the example with its file and answers changed; return the answers file."""
    answers = yaml.safe_load((SAMPLES / "answers.yaml").read_text(encoding="utf-8"))
    (own,) = (t for t in answers["trials"] if t["id"] == trial)
    if own["kind"] != "beam":
        changed = change((SAMPLES / own["file"]).read_text(encoding="utf-8"))
        (folder / own["file"]).write_bytes(changed if isinstance(changed, bytes) else changed.encode())
    else:
        outline = SAMPLES / own["captures"][0]["outline"]
        own["captures"][0]["outline"] = "outline.csv"
        shutil.copyfile(outline, folder / "outline.csv")
    for key, value in keys.items():
        if value is None:
            own.pop(key, None)
        else:
            own[key] = value
    answers["trials"] = [own]
    path = folder / "answers.yaml"
    path.write_text(yaml.safe_dump(answers, allow_unicode=True), encoding="utf-8")
    return path


@pytest.mark.parametrize("case", CASES)
def test_malformed_imports_are_refused(case: str, tmp_path: Path) -> None:
    trial, change, keys, place, said = CASES[case]
    path = lab(tmp_path, trial, change, keys)
    before = sorted(p.name for p in tmp_path.iterdir())
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(tmp_path / "lab")])
    assert done.exit_code == 2, (done.output, done.exception)
    (sentence,) = done.stderr.strip().splitlines()
    assert place in sentence, sentence
    assert said in sentence, sentence
    assert sentence.startswith(f"error: {tmp_path}") or case == "unknown format", sentence
    assert done.stdout == ""
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_a_material_that_no_trial_has_is_refused(tmp_path: Path) -> None:
    """A name that was misspelt left the trial's material without the density that stood under it."""
    path = lab(tmp_path, "strip", same, {"material": "gell"})
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(tmp_path / "lab")])
    assert done.exit_code == 2
    assert done.stderr == f"error: {path}: key materials.gel: expected a material of a trial (gell)\n"
    assert not (tmp_path / "lab").exists()


def test_the_lab_may_say_that_the_implausible_is_right(tmp_path: Path) -> None:
    """A modulus of 75 MPa is accepted if the answers name the check."""
    trial, change, _, _, _ = CASES["MPa for kPa"]
    path = lab(tmp_path, trial, change, {"accept": ["modulus"]})
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(tmp_path / "lab")])
    assert done.exit_code == 0, done.output


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("name: x\n", "missing key trials: expected it here"),
        ("name: x\ntrials: []\n", "key trials: expected at least 1, got 0"),
        ("- 1\n", "expected keys and values at the top level"),
        ("name: x\nname: y\n", "line 2: key name stands there twice"),
        ("name: [x\n", "line 2: expected valid YAML"),
        (
            "name: x\nphotographs: {board_distance_mm: 12.0}\ntrials:\n- {id: a, kind: coupon, file: f}\n",
            "key photographs: expected none without a capture that has a photo",
        ),
        # the list of trials is not said to be wrong beside its one wrong trial
        (
            "name: x\ntrials:\n- {id: a, kind: coupon, file: f, mode: pull}\n",
            "'planar' or 'simple-shear', got 'pull'\n",
        ),
        (
            "name: x\ntrials:\n- {id: a, kind: coupon, file: f}\n- {id: a, kind: coupon, file: f}\n",
            "expected different ids, trial #2 has the id a again",
        ),
        (
            "name: x\ntrials:\n- {id: a, kind: coupon, file: f}\n- {id: A, kind: coupon, file: f}\n",
            "expected ids that differ in more than letter case, trial #2 has the id A, another a",
        ),
    ],
)
def test_malformed_answers_are_refused(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "answers.yaml"
    path.write_text(text)
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(tmp_path / "lab")])
    assert done.exit_code == 2
    assert done.stderr.startswith(f"error: {path}: "), done.stderr
    assert said in done.stderr
    assert not (tmp_path / "lab").exists()


def test_copies_of_one_name_but_for_case_get_another(tmp_path: Path) -> None:
    """DSC1.JPG of one day and dsc1.jpg of another are one file on some disks."""
    work = Work(base=tmp_path, asker=Nobody(tmp_path / "answers.yaml"))
    names = [
        work.copy(tmp_path / day / name, "photos") for day, name in (("a", "DSC1.JPG"), ("b", "dsc1.jpg"))
    ]
    assert names == ["photos/DSC1.jpg", "photos/dsc1-2.jpg"]
    assert work.copy(tmp_path / "b" / "dsc1.jpg", "photos") == "photos/dsc1-2.jpg"
    assert sorted(work.copies) == names
