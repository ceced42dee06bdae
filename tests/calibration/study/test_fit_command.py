"""`python -m calibration.fit` from a user's point of view."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
import yaml
from _folders import coupon_entry, write_experiment
from made_beams import made
from typer.testing import CliRunner, Result

import tisim
from calibration.experiment import read
from calibration.fit import app
from calibration.study.calibration import Calibration
from calibration.study.cards import write_card
from factory.materials import load_card

TRUTH = tisim.material_from_moduli("neo-hookean", shear_modulus=12e3, bulk_modulus=6e6, density=1000.0)


# finer than the search's mesh and coarser than the one that corrects it: error of 4 micrometres at a tip
MESH = {"layer": 0.0025, "rings": 4}


def fit(*arguments: str) -> Result:
    """Run the command in this process."""
    return CliRunner().invoke(app, list(arguments))


@pytest.fixture(scope="module")
def fitted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fit")
    experiment = made(folder / "experiment", TRUTH, lengths_mm=(50.0,), bridges_mm=(100.0,), seed=3, **MESH)
    done = fit(str(experiment), "--model", "neo-hookean", "--out", str(folder / "out"), "--workers", "1")
    assert done.exit_code == 0, done.output
    return folder


def result(folder: Path, name: str = "S0-neo-hookean") -> dict[str, object]:
    data = json.loads((folder / "out" / "fits" / f"{name}.json").read_text())
    return dict(data["calibration"])


def test_the_modulus_is_found_within_its_error_bar(fitted: Path) -> None:
    c = result(fitted)
    assert c["status"] == "converged"
    assert abs(c["shear_modulus"] - 12e3) < 3.0 * c["shear_modulus_sd"]  # type: ignore[operator]
    assert 0.003 < c["shear_modulus_sd"] / 12e3 < 0.03  # type: ignore[operator]
    assert 0.6 < c["reduced_chi2"] < 1.5  # type: ignore[operator]
    seen = {e["name"]: e["seen"] for e in c["estimates"]}  # type: ignore[attr-defined]
    assert seen == {"shear_modulus": "identified", "bulk_ratio": "held"}


def test_each_beam_was_predicted_from_the_other(fitted: Path) -> None:
    held = {h["trial"]: h for h in result(fitted)["held_out"]}  # type: ignore[attr-defined]
    assert set(held) == {"S0-cantilever-50", "S0-bridge-100"}
    for h in held.values():
        assert h["shear_modulus"] == pytest.approx(12e3, rel=0.06)
        assert h["rms"] < h["rms_raw"]
        assert h["rms"] < 0.2e-3


def test_the_factory_takes_the_card(fitted: Path) -> None:
    card = load_card("S0", fitted / "out" / "cards")
    c = result(fitted)
    material = card.for_law("neo-hookean")
    assert material.parameters["mu"] == pytest.approx(c["shear_modulus"], rel=1e-5)
    for law in tisim.laws.names():
        moduli = tisim.laws.get(law).moduli(card.for_law(law).parameters)
        assert moduli.shear_modulus == pytest.approx(c["shear_modulus"], rel=1e-4)
    assert "neo-hookean: converged" in card.provenance
    assert "ogden" in card.provenance.partition("Not fitted")[2]
    (shear,) = (e for e in c["estimates"] if e["name"] == "shear_modulus")  # type: ignore[attr-defined]
    assert card.uncertainty.shear_modulus_high == pytest.approx(shear["high"] / shear["value"] - 1, abs=1e-5)
    assert card.uncertainty.shear_modulus_low == pytest.approx(shear["low"] / shear["value"] - 1, abs=1e-5)


def test_a_card_without_error_bars_says_so_and_is_taken(fitted: Path, tmp_path: Path) -> None:
    found = Calibration.from_json(result(fitted))
    bare = replace(found, estimates=(), shear_modulus_sd=float("nan"))
    write_card(tmp_path, [bare], read(fitted / "experiment"))
    card = load_card("S0", tmp_path)
    assert card.uncertainty.shear_modulus_low is None
    assert card.uncertainty.shear_modulus_high is None
    assert "not known" in card.uncertainty.text
    assert card.for_law("neo-hookean").parameters["mu"] == pytest.approx(found.shear_modulus, rel=1e-5)


def test_a_finished_fit_is_read_not_made_again(fitted: Path) -> None:
    file = fitted / "out" / "fits" / "S0-neo-hookean.json"
    before = file.stat().st_mtime_ns
    done = fit(str(fitted / "experiment"), "--model", "neo-hookean", "--out", str(fitted / "out"))
    assert done.exit_code == 0
    assert file.stat().st_mtime_ns == before


def test_other_data_is_refused_until_overwrite(fitted: Path, tmp_path: Path) -> None:
    other = made(tmp_path / "other", TRUTH, seed=4, **MESH)
    done = fit(str(other), "--model", "neo-hookean", "--out", str(fitted / "out"))
    assert done.exit_code == 2
    assert "made with another data" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert result(fitted)["status"] == "converged"


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_killed_and_stopped_it_goes_on_to_the_same_answer(fitted: Path, tmp_path: Path) -> None:
    experiment = fitted / "experiment"
    out = tmp_path / "out"
    history = out / "fits" / "S0-neo-hookean.jsonl"
    arguments = [str(experiment), "--model", "neo-hookean", "--out", str(out), "--workers", "1"]
    arguments.append("--no-held-out")
    _interrupt(arguments, history, signal.SIGKILL, after=1)
    with history.open("a") as file:
        file.write('{"restart": 0, "index": 2, "cand')  # a line truncated by a kill
    stopped = _interrupt(arguments, history, signal.SIGTERM, after=0)
    assert "best so far" in stopped
    assert (out / "report.html").exists()
    assert not (out / "cards").exists()  # a stopped search is not a fit
    done = fit(*arguments)
    assert done.exit_code == 0, done.stderr
    again = json.loads((out / "fits" / "S0-neo-hookean.json").read_text())["calibration"]
    once = result(fitted)
    # beams that start from other neighbours' solutions differ by the solver's tolerance
    assert again["candidates"] == once["candidates"]
    assert np.allclose(again["u"], once["u"], rtol=1e-5)


def _interrupt(arguments: list[str], history: Path, how: signal.Signals, *, after: int) -> str:
    # beyond those of an earlier run: before it has loaded, the command cannot say that it was stopped
    after += len(history.read_text().splitlines()) if history.exists() else 0
    process = subprocess.Popen(
        [sys.executable, "-m", "calibration.fit", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    deadline = time.monotonic() + 600
    while time.monotonic() < deadline and process.poll() is None:
        if history.exists() and len(history.read_text().splitlines()) > after:
            break
        time.sleep(0.005)
    assert process.poll() is None, process.communicate()[0]
    workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(how)
    _, left = psutil.wait_procs(workers, timeout=120)
    assert not left
    return process.communicate(timeout=600)[0]


@pytest.mark.parametrize("second", ["gel-stable", "Gel-stable"])  # one file on some disks
def test_materials_whose_fits_would_have_one_file_are_refused(second: str, tmp_path: Path) -> None:
    stretch = np.linspace(1.05, 1.5, 8)
    table = {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)}
    trials = [coupon_entry(f"t{k}", "a.csv", material=name) for k, name in enumerate(("gel", second))]
    experiment = write_experiment(
        tmp_path / "data", trials, tables={"a.csv": table}, materials={"gel": {}, second: {}}
    )
    done = fit(str(experiment), "--model", "all", "--out", str(tmp_path / "out"), "--workers", "1")
    assert done.exit_code == 2
    assert "both have one gel-stable-neo-hookean: fit them into two folders" in done.stderr
    assert not list((tmp_path / "out").rglob("*.json*"))


def test_coupons_alone_hold_the_bulk_modulus(tmp_path: Path) -> None:
    stretch = np.linspace(1.05, 2.0, 20)
    stress = 30.0 * (stretch - stretch**-2)  # kPa: the incompressible neo-Hookean strip
    experiment = write_experiment(
        tmp_path / "coupons",
        [coupon_entry("pull", "coupons/pull.csv")],
        tables={"coupons/pull.csv": {"stretch": stretch, "nominal_stress_kPa": stress}},
    )
    done = fit(str(experiment), "--model", "neo-hookean", "--out", str(tmp_path / "out"), "--workers", "1")
    assert done.exit_code == 0, done.output
    c = result(tmp_path)
    assert c["shear_modulus"] == pytest.approx(30e3, rel=0.01)
    assert {e["name"]: e["seen"] for e in c["estimates"]}["bulk_ratio"] == "held"  # type: ignore[attr-defined]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "held at its prior, 300, not measured" in page
    assert "K/G was held at 300: its interval is the hold" in page
    assert "K/G was held at 300, not measured" in " ".join(
        load_card("S0", tmp_path / "out" / "cards").uncertainty.text.split()
    )


def test_a_second_run_into_a_folder_keeps_the_laws_of_the_first(tmp_path: Path) -> None:
    stretch = np.linspace(1.05, 2.0, 20)
    table = {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)}
    data, out = tmp_path / "coupons", tmp_path / "out"
    experiment = write_experiment(data, [coupon_entry("pull", "a.csv")], tables={"a.csv": table})
    both = ["--out", str(out), "--workers", "1"]
    assert fit(str(experiment), "--model", "neo-hookean", *both).exit_code == 0
    done = fit(str(experiment), "--model", "mooney-rivlin", *both)
    assert done.exit_code == 0, done.output
    assert "fitted by an earlier run: S0 neo-hookean" in " ".join(done.output.split())
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "neo-hookean" in page
    assert "mooney-rivlin" in page
    card = load_card("S0", out / "cards")
    assert card.law == "neo-hookean"  # fits as well with a constant less
    filled = " ".join(card.provenance.split()).partition("Not fitted, moduli taken from neo-hookean: ")[2]
    assert "ogden" in filled
    assert "mooney-rivlin" not in filled

    table["nominal_stress_kPa"] = 2.0 * table["nominal_stress_kPa"]
    other = write_experiment(tmp_path / "other", [coupon_entry("pull", "a.csv")], tables={"a.csv": table})
    done = fit(str(other), "--model", "ogden", *both)
    assert done.exit_code == 0, done.output
    assert "earlier run" not in done.output  # of other data
    assert load_card("S0", out / "cards").law == "ogden"


def test_a_card_has_the_law_of_the_fit_whose_viscosity_it_has(tmp_path: Path) -> None:
    """An elastic fit of the same law, by an earlier run, is 20 % stiffer than the long-time modulus."""
    tau, fraction = 20.0, 0.6
    t = np.concatenate([np.linspace(0.1, 2.0, 20), np.linspace(5.0, 100.0, 20)])
    stretch = 1.0 + 0.25 * np.minimum(t, 2.0)
    elastic = 30.0 * (stretch - stretch**-2)
    # the ramp is short beside the relaxation: as if stretched at its middle
    stress = elastic * (1.0 + fraction * np.exp(-np.maximum(t - 1.0, 0.0) / tau))
    noise = 0.3 * np.random.default_rng(1).standard_normal(len(t))
    table = {"time_s": t, "stretch": stretch, "nominal_stress_kPa": stress + noise}
    pull = coupon_entry("pull", "a.csv", stress_sd_kPa=0.3)
    experiment = write_experiment(tmp_path / "coupons", [pull], tables={"a.csv": table})
    out = tmp_path / "out"
    both = ["--model", "neo-hookean", "--out", str(out), "--workers", "1"]
    fit(str(experiment), *both)
    done = fit(str(experiment), *both, "--time", "prony:1")
    assert "fitted by an earlier run: S0 neo-hookean" in " ".join(done.output.split())
    names = ("S0-neo-hookean", "S0-neo-hookean+prony-1")
    alone, timed = (result(tmp_path, name)["parameters"]["mu"] for name in names)  # type: ignore[index]
    assert alone > 1.1 * timed
    card = yaml.safe_load((out / "cards" / "S0.yaml").read_text())
    assert "viscosity" in card
    assert card["laws"]["neo-hookean"]["mu"] == pytest.approx(timed, rel=1e-5)
    said = "Fitted but not taken (beside other parts than those of neo-hookean+prony-1): neo-hookean."
    assert said in " ".join(card["provenance"].split())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--model", "yeoh"], "--model yeoh"),
        (["--model", ","], "at least one law"),
        (["--material", "S7"], "--material S7"),
        (["--material", ""], "--material: expected some of S0, got none"),
    ],
)
def test_bad_wishes_end_in_one_sentence(
    fitted: Path, tmp_path: Path, arguments: list[str], words: str
) -> None:
    done = fit(str(fitted / "experiment"), "--out", str(tmp_path / "out"), *arguments)
    assert done.exit_code == 2
    assert words in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "expected traced photographs of beams of S0, nothing else shows K/G"),
        (
            ["--objective", "dice"],
            "expected --objective likelihood, with dice K/G is held",
        ),
    ],
)
def test_a_free_bulk_ratio_that_nothing_shows_is_refused(
    tmp_path: Path, arguments: list[str], words: str
) -> None:
    """It was held, without a word."""
    stretch = np.linspace(1.05, 1.5, 8)
    table = {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)}
    data = write_experiment(tmp_path / "data", [coupon_entry("pull", "a.csv")], tables={"a.csv": table})
    done = fit(str(data), "--free-bulk-ratio", "--out", str(tmp_path / "out"), *arguments)
    assert done.exit_code == 2
    assert done.stderr.strip() == f"error: --free-bulk-ratio: {words}"
    assert not (tmp_path / "out").exists()


def test_a_malformed_folder_writes_nothing(tmp_path: Path) -> None:
    experiment = made(tmp_path / "experiment", TRUTH, **MESH)
    text = yaml.safe_load((experiment / "experiment.yaml").read_text())
    text["trials"][0]["free_length_mm"] = -50.0
    (experiment / "experiment.yaml").write_text(yaml.safe_dump(text))
    done = fit(str(experiment), "--out", str(tmp_path / "out"))
    assert done.exit_code == 2
    assert "free_length_mm" in done.stderr
    assert "experiment.yaml" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_workers_of_a_killed_fit_write_no_more(fitted: Path, tmp_path: Path) -> None:
    """After the parent of two worker processes is killed, they end and write no further files."""
    out = tmp_path / "out"
    arguments = [str(fitted / "experiment"), "--model", "neo-hookean,mooney-rivlin", "--out", str(out)]
    history = out / "fits" / "S0-mooney-rivlin.jsonl"
    _interrupt([*arguments, "--workers", "2"], history, signal.SIGKILL, after=3)
    # a surviving worker would have finished its fit
    assert history.exists()
    assert not (out / "fits" / "S0-mooney-rivlin.json").exists()
