"""`calibration.fit --rig`: a calibration with known faults of the rig.

tisim makes the beam: the tests check that the faults enter scenes, images and error bars, not the simulator.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from card_cases import faulty_beam, rig_effect, rig_file
from typer.testing import CliRunner

import tisim
from calibration.diagnosis.rig import read_rig
from calibration.experiment import read
from calibration.fit import app
from calibration.inference import CmaOptions
from calibration.measurements.outlines.simulators import TISIM
from calibration.parameters import parametrisation
from calibration.study import FitOptions, calibrate, measurements
from calibration.study.measurements import OnSetup
from factory.materials import load_card

SHEAR = 12e3
TRUTH = tisim.material_from_moduli(
    "neo-hookean", shear_modulus=SHEAR, bulk_modulus=300 * SHEAR, density=1000.0
)
LAW = parametrisation("neo-hookean")
BARE = replace(TISIM, reference=None)
TILT = rig_effect("clamp-tilt", "angle_deg", -2.0, 0.1)
DEPTH = rig_effect("grip-length", "depth_mm", 1.5, 0.1)


def fit(experiment: Path, out: Path, *more: str) -> tuple[int, str]:
    quick = ["--generations", "2", "--no-held-out", "--workers", "1"]
    arguments = [str(experiment), "--model", "neo-hookean", "--out", str(out), *quick, *more]
    ended = CliRunner().invoke(app, arguments, env={"COLUMNS": "300"})
    return ended.exit_code, " ".join((ended.stdout + ended.stderr).split())


def found(out: Path) -> dict[str, float]:
    text = (out / "fits" / "S1-neo-hookean.json").read_text()
    calibration: dict[str, float] = json.loads(text)["calibration"]
    assert calibration["status"] == "converged"
    return calibration


@pytest.fixture(scope="module")
def experiment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A beam whose clamp is tilted and holds it from 1.5 mm behind the clamp's face."""
    return faulty_beam(tmp_path_factory.mktemp("faulty"), TRUTH, tilt_deg=-2.0, depth_mm=1.5)


@pytest.fixture(scope="module")
def corrected(experiment: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("corrected")
    rig = rig_file(out / "rig.yaml", TILT, DEPTH)
    code, text = fit(experiment, out, "--rig", str(rig))
    assert code == 0, text
    assert "corrected for what the rig is known to do: clamp-tilt, angle_deg -2 ± 0.1; grip-length" in text
    return out


def test_the_modulus_is_found_on_a_known_rig_and_missed_without(experiment: Path, corrected: Path) -> None:
    on = found(corrected)
    assert abs(on["shear_modulus"] - SHEAR) < on["shear_modulus_sd"]
    assert on["shear_modulus_sd"] < 0.04 * SHEAR
    assert on["rms"] < 0.03e-3
    data = measurements(read(experiment), "S1", LAW, workers=1, simulator=BARE)
    options = FitOptions(cma=CmaOptions(max_generations=2), leave_one_out=False)
    off = calibrate(data, options=options)
    assert abs(off.shear_modulus - SHEAR) > 3.0 * off.shear_modulus_sd


def test_what_is_not_known_of_the_rig_is_a_nuisance(experiment: Path, tmp_path: Path) -> None:
    """One sd of the tilt, 0.1 degrees, lifts the far end by this angle times its distance from the clamp."""
    data = read(experiment)
    rig = read_rig(rig_file(tmp_path / "rig.yaml", TILT, DEPTH))
    outlines = measurements(OnSetup.of(data, rig), "S1", LAW, workers=1, simulator=BARE).outlines
    assert outlines is not None
    assert outlines.linearise(np.log([SHEAR, 300.0]))
    noise = outlines.model.noise
    assert {"clamp-tilt (rig)", "grip-length (rig)"} <= set(noise.names)
    assert set(noise.names) - {""} == set(outlines.nuisances(np.log([SHEAR, 300.0])))
    (photograph,) = outlines.model.records
    lifted = photograph.basis @ noise.columns[:, noise.names.index("clamp-tilt (rig)")]
    x = np.concatenate([photograph.outline.upper, photograph.outline.lower])[:, 0]
    assert np.abs(lifted).max() == pytest.approx(np.radians(0.1) * x.max(), rel=0.3)
    # further photographs of the same specimens are on the same rig
    further = outlines.model.measuring(data, lambda beam, _: beam)
    assert further.scenes.setup is rig


def test_it_says_so_on_the_page_and_on_the_card(corrected: Path) -> None:
    said = "corrected for what the rig is known to do: clamp-tilt"
    assert said in (corrected / "report.html").read_text(encoding="utf-8")
    assert said in load_card("S1", corrected / "cards").provenance


def test_a_fit_on_one_rig_does_not_go_on_another(experiment: Path, corrected: Path, tmp_path: Path) -> None:
    before = found(corrected)
    rig = rig_file(tmp_path / "rig.yaml", TILT)
    code, text = fit(experiment, corrected, "--rig", str(rig))
    assert code == 2
    assert "made with another rig; expected the same to go on" in text
    assert found(corrected) == before


@pytest.mark.parametrize(
    ("content", "more", "words"),
    [
        (None, (), "the rig file cannot be read"),
        ("effects: []", (), "key format"),
        ("{", (), "expected valid YAML"),
        ("", ("--objective", "dice"), "expected --objective likelihood"),
    ],
)
def test_a_bad_rig_ends_in_one_sentence(
    content: str | None, more: tuple[str, ...], words: str, experiment: Path, tmp_path: Path
) -> None:
    rig = tmp_path / "rig.yaml"
    if content is not None:
        rig.write_text(content)
    code, text = fit(experiment, tmp_path / "out", "--rig", str(rig), *more)
    assert code == 2
    assert words in text
    assert str(rig) in text
    assert not (tmp_path / "out").exists()
