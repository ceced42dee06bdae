"""Complete diagnoses of synthetic beams: hidden causes are found, unknown effects get no name."""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import yaml
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from matplotlib.image import imread
from release_models import bar_model
from typer.testing import CliRunner

from benchmarks.blind.release import Truth, beam, write_bars
from calibration.diagnosis.card import write_cards
from calibration.diagnosis.drawing import figures_of
from calibration.diagnosis.engine.fitting import fit as fit_causes
from calibration.diagnosis.engine.run import diagnose
from calibration.diagnosis.engine.search import fit_baseline
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.experiment import Experiment, read
from calibration.fit import app as fit
from calibration.measurements.release.model import ReleaseModel

CLEAN = Truth()
YIELDING = Truth(clamp=0.1)
RELAXING = Truth(branches=((0.08, 0.5),))
# branches of 0.015 each, three per decade, from 0.01 s to 20 s
CREEPING = Truth(branches=tuple((0.015, 10.0 ** (k / 3.0)) for k in range(-6, 5)))
HUMMING = Truth(extra=lambda t: 1e-4 * np.exp(-t) * np.sin(130.0 * t))


@cache
def made(truth: Truth) -> Experiment:
    with TemporaryDirectory() as folder:
        return read(write_bars(Path(folder) / "experiment", truth))


@cache
def diagnosed(truth: Truth) -> tuple[ReleaseModel, Diagnosis]:
    model = bar_model(made(truth), workers=1, fem=False)
    return model, diagnose(model, gain=truth is YIELDING)


def named(found: Diagnosis) -> dict[str, dict[str, dict[str, float]]]:
    return {c["effect"]: c["parameters"] for c in found.causes()}


def test_nothing_is_found_where_nothing_is_hidden() -> None:
    _, found = diagnosed(CLEAN)
    assert found.finding.verdict == "none"
    assert found.baseline.reduced_chi2 == pytest.approx(1.0, abs=0.1)
    assert found.baseline.shear_modulus_Pa["S0"] == pytest.approx(CLEAN.shear, rel=0.005)


def test_a_yielding_clamp_is_found() -> None:
    _, found = diagnosed(YIELDING)
    assert found.finding.verdict == "found"
    (parameters,) = [p for name, p in named(found).items() if name == "clamp-compliance"]
    estimate = parameters["rad_per_Nm"]
    assert abs(estimate["value"] - YIELDING.clamp) < 3.0 * estimate["sd"] < YIELDING.clamp
    # the baseline's modulus had absorbed the softness of the clamp
    assert found.baseline.shear_modulus_Pa["S0"] < 0.93 * YIELDING.shear
    assert found.extended is not None
    assert found.extended.shear_modulus_Pa["S0"] == pytest.approx(YIELDING.shear, rel=0.03)


def test_a_second_relaxation_time_is_found() -> None:
    _, found = diagnosed(RELAXING)
    assert found.finding.verdict == "found"
    (cause,) = found.causes()
    assert (cause["effect"], cause["scope"]) == ("relaxation", "all")
    assert cause["kind"] == "relaxation time 0.5 s"
    estimate = cause["parameters"]["fraction_of_modulus"]
    assert abs(estimate["value"] - 0.08 / 1.08) < 3.0 * estimate["sd"]  # of the instantaneous modulus


def test_creep_is_found_and_is_no_single_time() -> None:
    _, found = diagnosed(CREEPING)
    assert found.finding.equivalent == (("creep",),)
    estimate = named(found)["creep"]["per_decade"]
    at_1_s = 1.0 + sum(p * np.exp(-1.0 / t) for p, t in CREEPING.branches)
    assert estimate["value"] == pytest.approx(0.045 / at_1_s, rel=0.08)
    single = [e for e in found.finding.explanations if e.names == ("relaxation",)]
    assert all(e.score > found.finding.explanations[0].score + 100.0 for e in single)


def test_what_is_not_in_the_library_has_no_name() -> None:
    _, found = diagnosed(HUMMING)
    assert found.finding.verdict == "unexplained"
    assert found.causes() == []


@pytest.mark.slow
def test_without_the_cause_its_name_is_not_used() -> None:
    less = bar_model(made(RELAXING), without=["relaxation", "creep"], workers=1, fem=False)
    found = diagnose(less, gain=False)
    assert found.finding.verdict == "unexplained"


def test_the_gain_is_measured_on_what_was_not_seen() -> None:
    _, found = diagnosed(YIELDING)
    told = found.to_json()["gain"]
    assert told["held_out"] in ("leave-one-load-out", "vibration-or-equilibrium-out")
    assert told["rms_mm_after"] < told["rms_mm_before"]


def test_pictures_show_something() -> None:
    model, found = diagnosed(RELAXING)
    pictures = figures_of(model, found)
    assert [p.name for p in pictures] == ["motion", "residuals", "rms"]
    for p in pictures:
        file = io.BytesIO()
        p.figure.savefig(file, format="png")
        file.seek(0)
        assert imread(file).std() > 0.02
        assert p.caption
    labels = [t.get_text() for t in pictures[0].figure.legends[0].get_texts()]
    assert labels == ["measured", "baseline", "extended (relaxation)"]
    assert "2 records" in model.noise_sentence()


def test_cards_of_a_bar(tmp_path: Path) -> None:
    _, found = diagnosed(RELAXING)
    (path,) = write_cards(tmp_path / "cards", found, made(RELAXING))
    text = path.read_text(encoding="utf-8")
    assert "relaxation" in text
    assert "fraction_of_modulus" in text
    _, found = diagnosed(YIELDING)
    names = [p.name for p in write_cards(tmp_path / "more", found, made(YIELDING))]
    assert names == ["S0.yaml", "rig.yaml"]


def test_a_rig_of_bars_is_a_record_and_corrects_no_photograph(tmp_path: Path) -> None:
    """Its clamp-compliance has the name of an outline effect, for which it could be mistaken."""
    model, found = diagnosed(YIELDING)
    _, path = write_cards(tmp_path / "cards", found, made(YIELDING))
    rig = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert "clamp-compliance" in [e["effect"] for e in rig["effects"]]
    assert rig["corrects"] == "nothing"
    assert rig["use"].startswith("A record, which no command reads")
    (said,) = [r for r in model.remarks() if "rig.yaml, which no command reads" in r]
    assert said in found.notes
    x = np.linspace(1.0, 45.0, 30)
    edges = [np.column_stack([x, np.full_like(x, side)]) for side in (10.0, -10.0)]
    beam = write_experiment(
        tmp_path / "beam",
        [beam_entry("a", free_length_mm=50.0, captures=[capture_entry(10.0, "a.csv")])],
        tables={"a.csv": outline_columns(*edges)},
    )
    out = tmp_path / "out"
    arguments = [str(beam), "--rig", str(path), "--out", str(out)]
    ended = CliRunner().invoke(fit, arguments, env={"COLUMNS": "1000"})
    assert ended.exit_code == 2
    text = " ".join((ended.stdout + ended.stderr).split())
    assert f"{path}: key corrects: expected outlines, got nothing: this was not found on photographed" in text
    assert not out.exists()


def fitted(truth: Truth, name: str) -> tuple[float, float, float]:
    """Amplitude, standard deviation and gain in chi-square of a cause in all applicable records."""
    model = bar_model(made(truth), workers=1, fem=False, further=True)
    baseline = fit_baseline(model)
    cause = next(c for c in model.candidates if c.effect == name)
    found = fit_causes(model, baseline.state, (cause,))
    return *found.amplitude(cause), baseline.chi2 - found.chi2


def test_a_mass_that_is_tied_loosely_is_measured() -> None:
    value, sd, gain = fitted(Truth(loose=0.1), "loose-load")
    assert value == pytest.approx(0.1, abs=max(4.0 * sd, 0.01))
    assert gain > 30.0


def test_a_mass_that_rubs_is_measured() -> None:
    """Friction takes four times its static deflection per period from the amplitude, beside damping."""
    truth = Truth(rub=2e-3)
    stiff, _, _ = beam(truth, 0.01)
    load = np.zeros(len(stiff))
    load[-2] = truth.rub
    value, sd, gain = fitted(truth, "rubbing-load")
    assert value == pytest.approx(np.linalg.solve(stiff, load)[-2], rel=0.15, abs=3.0 * sd)
    assert gain > 30.0


def test_the_pose_in_which_a_bar_is_held_is_measured() -> None:
    truth = Truth(held=0.1)
    stiff, _, load = beam(truth, 0.0)
    below = -truth.held * np.linalg.solve(stiff, load)[-2]
    model = bar_model(made(truth), workers=1, fem=False, further=True)
    baseline = fit_baseline(model)
    pose = next(c for c in model.candidates if c.effect == "held-pose" and c.at == "own weight")
    found = fit_causes(model, baseline.state, (pose,))
    value, sd = found.amplitude(pose)
    assert value == pytest.approx(below, rel=0.15, abs=3.0 * sd)
    assert found.chi2 < baseline.chi2 - 30.0
