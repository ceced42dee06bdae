"""The networks that come with the package are read by this version, are complete, and can be adapted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import learn
import learn.adaptation
from learn.cli import app
from learn.data import MemoryDataset, load_tables, open_store
from learn.data.tables import TABLES
from learn.errors import InputError
from learn.evaluation import load_intervals, predict_part, summarise
from learn.models import Scenes
from learn.pretrained import folder_of, names, results_of
from learn.training import load_run, open_dataset
from tests.learn.commands import call, refused
from tests.learn.real_store import write_real_store
from tests.learn.small_store import write_store

SCENE = Path(__file__).parents[2] / "datasets" / "scenes" / "lump.yaml"


def test_the_readme_s_network_is_there() -> None:
    assert "covers" in names()


@pytest.mark.parametrize("name", names())
def test_each_is_complete(name: str) -> None:
    folder = folder_of(name)
    run = load_run(folder)  # of the present version, with weights that fit
    assert run.domain is not None
    assert load_intervals(run) is not None  # of these weights
    assert (
        f"{sum(p.numel() for p in run.model.parameters()):,} parameters" in (folder / "card.md").read_text()
    )
    predictor = learn.load(name)
    assert predictor.intervals is not None
    number = f"{predictor.intervals.pokes} indentations"
    assert f"intervals: 90 %, calibrated on {number}\n" in repr(predictor)
    card = " ".join((folder / "card.md").read_text().split())
    assert f"calibrated on {number} of the other folds" in card
    assert f"({number} of the other folds)" in " ".join(str(learn.load.__doc__).split())
    tables = load_tables(folder / TABLES)
    assert tables.uuid == run.uuid
    assert tables.location == run.location
    assert "/" not in run.location  # of the machine that trained it
    with pytest.raises(InputError, match="no dataset there"):
        open_dataset(run)


def test_it_knows_simulated_pokes_of_shapes_that_it_was_not_trained_on(tmp_path: Path) -> None:
    store = open_store(write_real_store(tmp_path / "s.zarr"))
    rows = np.arange(store.frames)
    model = load_run(folder_of("covers")).model
    row = summarise(predict_part(model, Scenes.of(store), MemoryDataset(store, rows)))
    assert row["mean"].mean < 0.03  # mm, depths to 10 mm
    assert row["rel force"].mean < 0.05


@pytest.mark.usefixtures("unrendered")
def test_one_answers_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing but the package is needed; the force rises steeply as the indenter nears the sphere."""
    monkeypatch.chdir(tmp_path)
    done = call(app, "predict", "covers", SCENE, "--out", "poke")
    assert done.exit_code == 0, done.output
    assert "Inside the trained ranges" in done.output
    body = {"inclusion": {"kind": "sphere", "radius_mm": 8, "centre_mm": [0, 0, 18]}, "shear_modulus_kPa": 30}
    touch = learn.load("covers").real_time(body)
    low, high = (touch(site=(0, 0), direction=(0, 0, -1), depth=d) for d in (2e-3, 4e-3))
    beside = touch(site=(0.03, 0.03), direction=(0, 0, -1), depth=4e-3)
    assert low.inside is True
    assert low.force_interval is not None
    assert high.force > 2.5 * low.force > 2.5 * 2 / 4 * beside.force


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_results_of_one_are_not_written_into_the_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = folder_of("covers")
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    body = write_real_store(tmp_path / "s.zarr")
    done = call(app, "evaluate", "covers", "--dataset", body, "--transfer", "--no-clouds", "--no-baselines")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "covers-evaluation" / "report.html").is_file()
    assert {path.name: path.stat().st_mtime_ns for path in folder.iterdir()} == before
    refused(call(app, "evaluate", "covers"), "covers.zarr: no dataset there")


@pytest.mark.parametrize("command", ["predict", "evaluate", "export"])
def test_a_file_is_no_folder_to_write_nor_one_of_a_run(command: str, tmp_path: Path) -> None:
    file = tmp_path / "notes.txt"
    file.write_text("notes")
    scene = (SCENE,) if command == "predict" else ()
    for run, out, words in (
        ("covers", file, f"--out {file}: expected the name of a folder, this is a file"),
        (file, tmp_path / "out", f"{file}: expected the folder of a run, or one of covers; this is a file"),
    ):
        refused(call(app, command, run, *scene, "--out", out), words)
    assert file.read_text() == "notes"
    assert list(tmp_path.iterdir()) == [file]


def test_one_is_adapted_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(learn.adaptation, "PARTS", 2)  # each part takes a training
    body = write_store(tmp_path / "b.zarr", shapes=1, softness=("S1",), sites=3, frames=2)
    done = call(app, "adapt", "covers", body, "--epochs", 1, "--threads", 1)
    assert done.exit_code == 0, done.output
    adapted = load_run(tmp_path / "runs" / "adapted")
    assert adapted.pretrained is not None
    assert load_tables(adapted.folder / TABLES).uuid == adapted.uuid
    refused(
        call(app, "adapt", "cover", body, "--out", "other"),
        "cover: no such folder, expected that of a run, or one of covers",
    )


@pytest.mark.usefixtures("unrendered")
def test_a_folder_of_results_does_not_hide_the_network_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    shipped = folder_of("covers")
    for _ in range(2):  # the second finds the results of the first
        done = call(app, "predict", "covers", SCENE, "--out", "covers")
        assert done.exit_code == 0, done.output
    assert folder_of("covers") == shipped
    assert not caplog.records


@pytest.mark.parametrize("checkpoint", ["best.pt", "last.pt"])
def test_a_run_in_a_folder_of_the_name_is_used_with_a_warning(
    checkpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "covers").mkdir()
    (tmp_path / "covers" / checkpoint).touch()
    assert results_of(Path("covers"), "onnx") == Path("covers/onnx")
    assert not caplog.records
    assert folder_of("covers") == Path("covers")
    assert caplog.messages == [
        "covers: the run in this folder is used, not the network of this name that comes with tisim"
    ]
