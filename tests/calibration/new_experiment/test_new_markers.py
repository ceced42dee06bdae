"""`calibration.new`: markers, scans of surfaces, and all further keys of experiment.yaml from answers."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _folders import beam_entry, marker_columns, outline_columns
from typer.testing import CliRunner

from calibration.experiment import BeamTrial, PokeTrial, read
from calibration.experiment._beam import BeamEntry, CaptureEntry
from calibration.experiment._coupon import CouponEntry
from calibration.experiment._fields import Strict
from calibration.experiment._poke import PokeEntry, SurfaceEntry
from calibration.experiment.model import Registration
from calibration.new import app
from calibration.new._answers import BeamAnswers, CaptureAnswers, CouponAnswers, PokeAnswers, SurfaceAnswers

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "datasets" / "lab-files"
BAR = beam_entry("bar", material="gel")
MARKED = {
    "markers": "tracked.csv",
    "marker_positions_mm": {"tip": [100.0, 0.0, 0.0], "mid.1": [50.0, 0.0, 10.0]},
    "marker_sd_mm": 0.05,
}
CAPTURE = {
    "time_s": 60.0,
    "outline": "outline.csv",
    "outline_sd_mm": 0.1,
    "outline_correlation_mm": 5.0,
    "registration_sd": {"shift_mm": 0.1, "roll_deg": 0.15, "scale": 0.003},
}
SHARED = {"shift_mm": 0.3, "roll_deg": 0.0, "scale": 0.004}


def table(path: Path, columns: dict[str, Any]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values(), strict=True))


@pytest.fixture
def files(tmp_path: Path) -> Path:
    """Tables of a beam and of a scan, and the record of a machine."""
    time = np.arange(0.0, 1.0, 0.1)
    drop = np.outer(time, [0.0, 0.0, -4.0])
    table(tmp_path / "tracked.csv", marker_columns(time, {"tip": drop, "mid.1": 0.3 * drop}))
    x = np.linspace(0.5, 100.0, 40)
    sides = (np.column_stack([x, np.full_like(x, s)]) for s in (10.0, -10.0))
    table(tmp_path / "outline.csv", outline_columns(*sides))
    table(tmp_path / "push.csv", {"x_mm": [0.0, 9.0, 0.0], "y_mm": [0.0, 0.0, 9.0], "z_mm": [20.0, 20.1, 20]})
    (tmp_path / "mach-1.txt").write_bytes((SAMPLES / "mach-1.txt").read_bytes())
    return tmp_path


def answers(folder: Path, *trials: dict[str, Any]) -> Path:
    content = {
        "name": "lab",
        "materials": {"gel": {"density_kg_m3": 1000.0, "density_sd_kg_m3": 5.0}},
        "trials": list(trials),
    }
    path = folder / "answers.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def made(path: Path, out: Path) -> Any:
    return CliRunner().invoke(app, ["--yes", str(path), "--out", str(out)])


def poke() -> dict[str, Any]:
    own = yaml.safe_load((SAMPLES / "answers.yaml").read_text(encoding="utf-8"))["trials"]
    (found,) = (t for t in own if t["id"] == "push")
    found["surfaces"] = [{"time_s": 0.0, "points": "push.csv", "point_sd_mm": 0.1}]
    return dict(found)


@pytest.mark.parametrize(
    ("entry", "answered"),
    [
        (BeamEntry, BeamAnswers),
        (CaptureEntry, CaptureAnswers),
        (CouponEntry, CouponAnswers),
        (PokeEntry, PokeAnswers),
        (SurfaceEntry, SurfaceAnswers),
    ],
)
def test_answers_have_all_keys_of_an_experiment(entry: type[Strict], answered: type[Strict]) -> None:
    """But `record`, which is made of the machine's file."""
    assert set(entry.model_fields) - {"record"} <= set(answered.model_fields)


def test_what_answers_say_of_a_beam_is_in_the_experiment(files: Path) -> None:
    both = {**BAR, **MARKED, "captures": [{**CAPTURE, "registration_shared_sd": SHARED}]}
    pulled = {**BAR, **MARKED, "id": "pulled", "tip_force_N": [0.0, 0.0, -0.02], "tip_force_height_mm": -10.0}
    out = files / "lab"
    done = made(answers(files, both, pulled), out)
    assert done.exit_code == 0, done.output
    seen, hung = read(out).trials
    assert isinstance(seen, BeamTrial)
    assert isinstance(hung, BeamTrial)
    assert seen.marker_sd == hung.marker_sd == pytest.approx(5e-5)
    assert {m.name: m.position for m in seen.markers} == {"tip": (0.1, 0, 0), "mid.1": (0.05, 0, 0.01)}
    (tip,) = (m for m in seen.markers if m.name == "tip")
    assert tip.displacement[-1] == pytest.approx([0.0, 0.0, -3.6e-3])
    assert seen.tip_force_height == 0.0
    assert hung.tip_force_height == pytest.approx(-0.01)
    assert hung.captures == ()
    outline = seen.captures[0].outline
    assert outline is not None
    assert outline.shared == Registration(shift=3e-4, roll=0.0, scale=0.004)
    assert (out / "beams" / "tracked.csv").read_bytes() == (files / "tracked.csv").read_bytes()
    # the folder makes itself again
    assert made(out / "answers.yaml", files / "again").exit_code == 0
    for path in filter(Path.is_file, out.rglob("*")):
        assert path.read_bytes() == (files / "again" / path.relative_to(out)).read_bytes(), path.name


def test_a_scan_of_a_block_is_in_the_experiment(files: Path) -> None:
    """Its table may have the name of the trial, whose own table is made."""
    out = files / "lab"
    done = made(answers(files, poke()), out)
    assert done.exit_code == 0, done.output
    (trial,) = read(out).trials
    assert isinstance(trial, PokeTrial)
    (scan,) = trial.surfaces
    assert (scan.time, scan.sd) == (0.0, pytest.approx(1e-4))
    assert scan.points[1] == pytest.approx([9e-3, 0.0, 20.1e-3])
    assert made(out / "answers.yaml", files / "again").exit_code == 0


def test_markers_are_asked_for_at_the_terminal(files: Path) -> None:
    """A table of markers and an outline of one beam; what is typed makes the folder again."""
    typed = ["lab", "bar", "gel", "bar", "circle", "10", "", "100", "", "20", "clamped-free", ""]
    typed += ["60", "", "", "", "", ""]  # of the outline
    typed += ["tip 100", "tip: 100, 0, 0; mid.1: 50 0 10", "0", "0.05", "1000", "5"]
    out = files / "out"
    done = CliRunner().invoke(
        app,
        [str(files / "tracked.csv"), str(files / "outline.csv"), "--out", str(out)],
        input="\n".join(typed) + "\n",
    )
    assert done.exit_code == 0, done.output
    assert "outline.csv: id of the trial (of the same beam: bar)" in done.output
    assert "expected NAME: x, y, z, got 'tip 100'" in done.output
    (trial,) = read(out).trials
    assert isinstance(trial, BeamTrial)
    assert {m.name for m in trial.markers} == {"tip", "mid.1"}
    assert len(trial.captures) == 1
    assert made(out / "answers.yaml", files / "again").exit_code == 0


def without(own: dict[str, Any], *keys: str) -> dict[str, Any]:
    return {key: value for key, value in own.items() if key not in keys}


@pytest.mark.parametrize(
    ("trial", "said"),
    [
        (BAR, "answers.yaml: missing key bar.captures: expected captures or markers"),
        (
            {**BAR, "captures": [CAPTURE], "marker_sd_mm": 0.1},
            "answers.yaml: missing keys bar.markers (expected the file with the displacements of the markers,"
            " beside marker_sd_mm), bar.marker_positions_mm (expected position",
        ),
        (
            without({**BAR, **MARKED}, "marker_positions_mm"),
            "answers.yaml: missing key bar.marker_positions_mm: expected position of each marker",
        ),
        (
            without({**BAR, **MARKED}, "marker_sd_mm"),
            "answers.yaml: missing key bar.marker_sd_mm: expected standard deviation of each component",
        ),
        ({**BAR, **MARKED, "markers": "none.csv"}, "none.csv: key bar.markers: expected a file"),
        (
            {**BAR, **MARKED, "marker_positions_mm": {"end": [100.0, 0.0, 0.0]}},
            "/tracked.csv: line 2: column marker: expected one of marker_positions_mm (end), got 'tip'",
        ),
        (
            {**BAR, "captures": [{"time_s": 1.0, "photo": "p.jpg", "registration_shared_sd": SHARED}]},
            "key trials[bar].captures[#1].registration_shared_sd: expected an outline beside it",
        ),
        (
            {**BAR, "captures": [{"time_s": 1.0}]},
            "answers.yaml: missing key bar.captures[#1].outline: expected an outline or a photo",
        ),
        (
            {**BAR, **MARKED, "captures": [CAPTURE], "tip_force_N": [0, 0, -1.0], "tip_force_height_mm": 1.0},
            "answers.yaml: key trials[bar].tip_force_height_mm: expected with markers only",
        ),
    ],
)
def test_beams_that_cannot_be_are_refused(trial: dict[str, Any], said: str, files: Path) -> None:
    done = made(answers(files, trial), files / "lab")
    assert done.exit_code == 2
    (sentence,) = done.stderr.strip().splitlines()
    assert said in sentence, sentence
    assert not (files / "lab").exists()
    assert str(files / "lab") not in sentence  # where nobody can look


@pytest.mark.parametrize(
    ("scan", "said"),
    [
        ({"points": "none.csv"}, "missing key push.surfaces[#1].time_s: expected time of the scan"),
        ({"points": "none.csv", "time_s": 1.0}, "none.csv: key push.surfaces[#1].points: expected a file"),
        (
            {"points": "push.csv", "time_s": 1.0},
            "missing key push.surfaces[#1].point_sd_mm: expected",
        ),
        (
            {"time_s": 1.0},
            "missing keys push.surfaces[#1].points (expected the file with the scan), push.surfaces",
        ),
    ],
)
def test_scans_that_say_too_little_are_refused(scan: dict[str, Any], said: str, files: Path) -> None:
    done = made(answers(files, {**poke(), "surfaces": [scan]}), files / "lab")
    assert done.exit_code == 2
    (sentence,) = done.stderr.strip().splitlines()
    assert said in sentence, sentence
    assert not (files / "lab").exists()
