"""Invalid answers, and files that do not fit them: one sentence, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from malformed_files import Case, check_refused, lab, same, swap
from typer.testing import CliRunner

from calibration.new import app
from calibration.new._asking import Nobody
from calibration.new._trial import Work

CASES: dict[str, Case] = {
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


@pytest.mark.parametrize("case", CASES)
def test_malformed_imports_are_refused(case: str, tmp_path: Path) -> None:
    check_refused(CASES[case], tmp_path)


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
