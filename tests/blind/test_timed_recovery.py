"""Synthetic experiments of time-dependent materials, and the driver that scores fits to them."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from benchmarks.blind.timed import recover
from benchmarks.blind.timed.cases import draw_beams, draw_coupons, draw_indentation, write
from benchmarks.blind.timed.coupons import respond
from benchmarks.blind.timed.indentation import LAYERS, load
from benchmarks.blind.timed.make import main as make
from benchmarks.blind.under_test import NotFittedError, estimates_of, fit_command, fit_in_process

PARAMETERS = [
    "shear_modulus",
    "alpha",
    "prony.fraction.1",
    "prony.time.1",
    "prony.fraction.2",
    "prony.time.2",
]


def read(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Content of experiment.yaml and truth.yaml."""
    both = [
        yaml.safe_load((folder / f"{name}.yaml").read_text(encoding="utf-8"))
        for name in ("experiment", "truth")
    ]
    return both[0], both[1]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made")
    assert make(["coupons", "--parts", "prony", "mullins", "--seeds", "3", "--out", str(out)]) == 0
    return out / "coupons-3"


def test_the_command_writes_an_experiment_and_its_truth(made: Path) -> None:
    experiment, truth = read(made)
    solid = draw_coupons(3).solid
    assert truth["materials"]["M"] == solid.truth()
    assert solid.softening is not None
    assert solid.fibres is None
    assert [t["id"] for t in experiment["trials"]] == ["relaxation", "cycles", "shear", "biaxial"]
    for trial in experiment["trials"]:
        table = np.genfromtxt(made / trial["record"], delimiter=",", names=True)
        assert table.dtype.names == ("time_s", "stretch", "nominal_stress_kPa")
        assert (np.diff(table["time_s"]) > 0.0).all()
        assert table["stretch"][0] == 1.0


def test_the_record_is_the_materials_answer_with_the_stated_noise(made: Path) -> None:
    case = draw_coupons(3)
    experiment, _ = read(made)
    z = []
    for test, trial in zip(case.coupons, experiment["trials"], strict=True):
        table = np.genfromtxt(made / trial["record"], delimiter=",", names=True)
        clean = respond(case.solid, test.mode, test.course, tolerance=1e-7).stress
        z.append((table["nominal_stress_kPa"] - 1e-3 * clean) / trial["stress_sd_kPa"])
    whole = np.concatenate(z)
    assert abs(whole.mean()) < 0.2
    assert whole.std() == pytest.approx(1.0, abs=0.1)


def test_a_seed_makes_the_same_files_again_and_another_seed_others(made: Path, tmp_path: Path) -> None:
    for seed in (3, 4):
        assert make(["coupons", "--seeds", str(seed), "--out", str(tmp_path)]) == 0
    texts = [
        (folder / "coupons/cycles.csv").read_text()
        for folder in (made, tmp_path / "coupons-3", tmp_path / "coupons-4")
    ]
    assert texts[0] == texts[1] != texts[2]


def test_beams_are_photographed_at_several_times_and_sink(tmp_path: Path) -> None:
    case = draw_beams(1)
    short = [b for b in case.beams if b.stated_length == 0.06]
    write(type(case)(seed=1, kind="beams", solid=case.solid, beams=tuple(short)), tmp_path / "e")
    experiment, truth = read(tmp_path / "e")
    (trial,) = experiment["trials"]
    assert [c["time_s"] for c in trial["captures"]] == [0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0]
    lowest = []
    for c in trial["captures"]:
        rows = (tmp_path / "e" / c["outline"]).read_text().splitlines()[1:]
        lowest.append(min(float(row.split(",")[2]) for row in rows))
    assert lowest[0] > lowest[-1] + 0.3
    assert truth["beams"]["cantilever-60"]["length_m"] != 0.06


def test_an_indentation_that_is_not_stored_names_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert make(["indentation", "--seeds", "987654", "--out", str(tmp_path)]) == 2
    assert "solve_indentation" in capsys.readouterr().err


def test_a_stored_indentation_is_written_with_its_force_per_modulus(tmp_path: Path) -> None:
    assert make(["indentation", "--seeds", "1", "--noise", "0", "--out", str(tmp_path)]) == 0
    folder = tmp_path / "indentation-1"
    experiment, truth = read(folder)
    for trial in experiment["trials"]:
        table = np.genfromtxt(folder / trial["record"], delimiter=",", names=True)
        entry = load()[f"seed 1, {trial['id']}"]
        at = np.searchsorted(table["time_s"], entry["time"][14] * (1 - 1e-6))  # the end of the ramp
        force = truth["materials"]["M"]["shear_modulus_Pa"] * entry["force"][14]
        assert table["force_N"][at] == pytest.approx(force, rel=1e-5)
        assert table["force_N"].argmax() == at
        assert (np.diff(table["time_s"]) > 0.0).all()


def test_indentations_hold_and_retract() -> None:
    for poke in draw_indentation(5).pokes:
        _, depth = poke.course.corners()
        assert poke.base in LAYERS
        assert depth[1] == depth[2] > depth[3] > 0.0


def test_two_terms_are_more_than_a_decade_apart() -> None:
    for seed in range(20):
        times = draw_indentation(seed).solid.prony.times
        assert times[1] > 10.0 * times[0]


def fake(out: Path, truth: dict[str, float], off: dict[str, float]) -> None:
    """Write a fit whose estimates are the truth times `off`, with intervals of +-10 %."""
    estimates = [
        {
            "name": recover.NAMES[p][0],
            "value": t * off.get(p, 1.0),
            "low": t * off.get(p, 1.0) * 0.9,
            "high": t * off.get(p, 1.0) * 1.1,
        }
        for p, t in truth.items()
    ]
    (out / "fits").mkdir(parents=True)
    (out / "fits" / "M-ogden+prony.json").write_text(json.dumps({"calibration": {"estimates": estimates}}))


def test_the_driver_counts_the_intervals_that_hold_the_truth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []

    def fitted(folder: Path, out: Path, law: str, options: list[str]) -> None:
        asked.append((law, *options))
        assert not (folder / "truth.yaml").exists()
        truth = yaml.safe_load((tmp_path / f"{folder.name}.truth.yaml").read_text())["materials"]["M"]
        parameters = recover.parameters_of(truth)
        assert list(parameters) == PARAMETERS
        off = {"prony.time.2": 1.3} if folder.name == "coupons-2" else {}
        fake(out, parameters, off)

    monkeypatch.setattr(recover, "fit_command", fitted)
    arguments = ["coupons", "--parts", "prony", "--seeds", "2", "--out", str(tmp_path)]
    assert recover.main([*arguments, "--goal", "0.9"]) == 0
    assert asked == [("ogden", "--time", "prony", "--no-held-out")] * 2
    printed = capsys.readouterr().out
    assert "prony.time.2         1 of   2" in printed
    assert "11 of  12: 92%" in printed
    assert recover.main([*arguments, "--goal", "0.95", "--score"]) == 1
    stored = json.loads((tmp_path / "coupons.json").read_text())
    assert [i["parameter"] for i in stored if not i["holds"]] == ["prony.time.2"]


def test_a_fit_that_fails_is_a_miss_with_its_message(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stop = "import sys; sys.stderr.write('no such thing'); sys.exit(2)"
    with pytest.raises(NotFittedError, match=r"exit code 2.*no such thing"):
        fit_command(tmp_path, tmp_path / "f", "ogden", command=(sys.executable, "-c", stop))
    with pytest.raises(NotFittedError, match=r"exit code 2: error: \S+: expected a folder that holds"):
        fit_in_process(tmp_path / "none", tmp_path / "f", "ogden")
    with pytest.raises(NotFittedError, match="expected a fit"):
        estimates_of(tmp_path, "M", "ogden")
    arguments = ["coupons", "--parts", "mullins", "--seeds", "1", "--score", "--out", str(tmp_path)]
    assert recover.main(arguments) == 1
    printed = capsys.readouterr().out
    assert "expected a fit" in printed
    assert "0 of   4: 0%" in printed


def test_an_estimate_without_the_name_is_a_miss() -> None:
    material = draw_coupons(1, ["prony"]).solid.truth()
    found = recover.scored(1, material, {"shear_modulus": {"value": 1.0, "low": 0.0, "high": 1e9}})
    assert [i.holds for i in found] == [True] + [False] * 5
    assert "no estimate named" in found[2].problem
