"""`python -m calibration.diagnose`: invalid input ends in one sentence, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from _folders import beam_entry, capture_entry, coupon_entry, outline_columns, write_experiment
from typer.testing import CliRunner, Result

from calibration.diagnose import app


def diagnose(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])


@pytest.fixture
def beam(tmp_path: Path) -> Path:
    """A valid experiment with a beam; no test here simulates it."""
    x = np.linspace(1.0, 49.0, 40)
    edges = [np.column_stack([x, side - 1e-3 * x**2]) for side in (10.0, -10.0)]
    return write_experiment(
        tmp_path / "experiment",
        [beam_entry("a", free_length_mm=50.0, captures=[capture_entry(10.0, "a.csv")])],
        tables={"a.csv": outline_columns(*edges)},
    )


@pytest.fixture(autouse=True)
def _no_diagnosis(monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*_: object, **__: object) -> None:
        raise AssertionError("the search began with input that cannot be used")

    monkeypatch.setattr("calibration.diagnosis.laws.searched", stop)


def refused(done: Result, *said: str) -> None:
    assert done.exit_code == 2, (done.output, done.exception)
    (line,) = [text for text in done.stderr.splitlines() if text.strip()]
    assert line.startswith("error: ")
    for words in said:
        assert words in line


def tree(folder: Path) -> dict[Path, bytes]:
    return {p: p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_no_folder(tmp_path: Path) -> None:
    refused(diagnose(tmp_path / "nowhere", "--out", tmp_path / "out"), "nowhere")
    assert not (tmp_path / "out").exists()


def test_no_beams(tmp_path: Path) -> None:
    bare = beam_entry("a", markers={"file": "m.csv", "sd_mm": 0.1})
    del bare["markers"]
    bare["captures"] = [{"time_s": 10.0, "photo": "a.png"}]
    (tmp_path / "experiment").mkdir()
    (tmp_path / "experiment" / "a.png").write_bytes(b"")
    folder = write_experiment(tmp_path / "experiment", [bare])
    refused(diagnose(folder, "--out", tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_an_effect_that_is_none(beam: Path, tmp_path: Path) -> None:
    refused(
        diagnose(beam, "--without", "creep, nonsense", "--out", tmp_path / "out"), "--without", "nonsense"
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("kind", ["nonsense", "coupons"])
def test_a_kind_that_is_none_or_not_there(beam: Path, tmp_path: Path, kind: str) -> None:
    refused(diagnose(beam, "--kind", kind, "--out", tmp_path / "out"), "--kind", kind)
    assert not (tmp_path / "out").exists()


def test_two_kinds_and_none_said(tmp_path: Path) -> None:
    stretch = np.linspace(1.0, 1.5, 20)
    x = np.linspace(1.0, 49.0, 40)
    edges = [np.column_stack([x, side - 1e-3 * x**2]) for side in (10.0, -10.0)]
    both = write_experiment(
        tmp_path / "both",
        [
            beam_entry("a", free_length_mm=50.0, captures=[capture_entry(10.0, "a.csv")]),
            coupon_entry("c", "c.csv"),
        ],
        tables={
            "a.csv": outline_columns(*edges),
            "c.csv": {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)},
        },
    )
    refused(diagnose(both, "--out", tmp_path / "out"), "--kind", "outlines", "homogeneous")
    assert not (tmp_path / "out").exists()


def test_a_diagnosis_that_is_there_is_kept(beam: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "diagnosis.json").write_text("{}")
    before = tree(tmp_path)
    refused(diagnose(beam, "--out", tmp_path / "out"), "--overwrite", "out")
    assert tree(tmp_path) == before


def test_a_file_is_no_folder(beam: Path, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    before = tree(tmp_path)
    refused(diagnose(beam, "--out", tmp_path / "out"), "--out", "expected a folder")
    assert tree(tmp_path) == before


def test_a_baseline_that_cannot_be_calibrated(
    beam: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def nowhere(*_: object, **__: object) -> None:
        raise ValueError("no shear modulus gives an equilibrium")

    monkeypatch.setattr("calibration.diagnosis.laws.searched", nowhere)
    refused(diagnose(beam, "--out", tmp_path / "out"), "no shear modulus")
    assert not (tmp_path / "out").exists()


def test_help_shows_how_it_is_used() -> None:
    done = diagnose("--help")
    assert done.exit_code == 0
    for option in ("--without", "--kind", "--overwrite"):
        assert option in done.output
