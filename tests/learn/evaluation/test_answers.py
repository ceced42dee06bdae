"""What a user asks of a run: one poke from a scene file, an inclusion of one's own, the same from ONNX."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

import learn.export
import learn.predict
from learn.data import open_store
from learn.scene_file import load_poke, scene_and_poke
from tests.learn.commands import call, train_small
from tests.learn.drawn import assert_drawn
from tests.learn.evaluation.cases import BLUE, INDENTER, POKE, RIGID_GREY


def test_prediction_of_one_poke(run: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    done = call(learn.predict.app, run, scene, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert_drawn(tmp_path / "out" / "prediction.png", BLUE, INDENTER, RIGID_GREY)
    request.getfixturevalue("unrendered")
    answer = json.loads((tmp_path / "out" / "prediction.json").read_text())
    assert answer["force_N"] > 0
    table = np.loadtxt(tmp_path / "out" / "displacement.csv", delimiter=",", skiprows=1)
    assert len(table) == 1024
    deepest = table[np.linalg.norm(table[:, 3:6], axis=1).argmax()]
    assert np.linalg.norm(deepest[:2] - [5, -10]) < 5  # mm from the contact point
    scene.write_text(POKE.replace("softness: S1", "shear_modulus_kPa: 18"))
    double = call(learn.predict.app, run, scene, "--out", tmp_path / "double")
    assert double.exit_code == 0, double.output
    stiffer = json.loads((tmp_path / "double" / "prediction.json").read_text())
    assert stiffer["force_N"] > 1.3 * answer["force_N"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("depth_mm: 2", "depth_mm: -2", "key depth_mm"),
        ("depth_mm: 2", "depth: 2", "key depth"),
        ("site_mm: [5, -10]", "site_mm: [500, 0]", "key site_mm: expected x within"),
        ("shape: shape-1", "shape: cat", "key shape: expected one of shape-0"),
        ("softness: S1", "softness: S9", "key softness: expected one of S0, S1, got 'S9'"),
        ("softness: S1\n", "", "either softness or shear_modulus_kPa"),
    ],
)
def test_bad_scene_files_are_refused(run: Path, tmp_path: Path, old: str, new: str, words: str) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE.replace(old, new))
    done = call(learn.predict.app, run, scene, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_inclusions_of_ones_own(store: Path, tmp_path: Path) -> None:
    scene = tmp_path / "poke.yaml"
    body = "inclusion: {kind: sphere, radius_mm: 8, centre_mm: [0, 0, 8]}"
    scene.write_text(POKE.replace("shape: shape-1", body))
    _, _, about, pokes = scene_and_poke(load_poke(scene), open_store(store))
    column = about.rigid[0, 16 * 32 + 16].numpy()  # nearest to the centre
    height = 32 - (np.arange(128) + 0.5) / 4  # mm above the base
    assert np.abs(height[column > 0].max() - 16) < 0.5
    assert column[height < 0.3].all() == (np.hypot(1.5625, 1.5625) < np.sqrt(64 - 7.8**2))
    assert float(pokes.direction.norm()) == pytest.approx(1)


@pytest.mark.slow
@pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("onnx", "onnxscript", "onnxruntime")),
    reason="the onnx packages are not installed",
)
def test_onnx_gives_what_torch_gives(run: Path, tmp_path: Path) -> None:
    done = call(learn.export.app, run, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    about = json.loads((tmp_path / "model.json").read_text())
    assert about["difference_from_torch"] < 1e-5
    assert (tmp_path / "poke.onnx").is_file()


@pytest.mark.slow
@pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("onnx", "onnxscript", "onnxruntime")),
    reason="the onnx packages are not installed",
)
def test_onnx_of_the_papers_model(store: Path, tmp_path: Path) -> None:
    run = train_small(store, tmp_path / "run", "--model", "cegnn", "--epochs", 1)
    done = call(learn.export.app, run)
    assert done.exit_code == 0, done.output
    about = json.loads((run / "onnx" / "model.json").read_text())
    assert about["difference_from_torch"] < 1e-5
