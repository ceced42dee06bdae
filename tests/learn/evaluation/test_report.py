"""The command learn.evaluate: a report of one run or several, on their own dataset and on another."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

import learn.baselines
import learn.evaluate
import learn.predict
from learn.data import MemoryDataset, open_store, split_of, split_pokes
from learn.errors import InputError
from learn.evaluation import parts_of
from learn.metrics import METRICS
from learn.models import pokes_of, scene_on
from learn.training import load_run
from tests.learn.commands import call, train_small
from tests.learn.drawn import assert_drawn
from tests.learn.evaluation.cases import BLUE, MODEL, ORANGE, POKE
from tests.learn.small_store import write_store
from tests.unrendered import unrender


def _assert_pictures(folder: Path, *, learning: tuple[str, ...]) -> None:
    """The pictures of a report are drawn: the learning curve, ranked pokes (simulated, predicted), forces."""
    assert_drawn(folder / "learning.png", *learning)
    assert_drawn(folder / "force.png", BLUE)
    ranked = [folder / f"{name}.png" for name in ("best", "median", "worst")]
    shown = [path for path in ranked if path.exists()]
    assert len(shown) >= 2
    for path in shown:
        assert_drawn(path, "#000000", ORANGE)


def _means_by_hand(folder: Path) -> list[float]:
    """Mean distance over the test part [mm], of the run's model and of no displacement at all."""
    run = load_run(folder)
    store = open_store(run.location)
    found: list[list[float]] = []
    for row in split_of(store, run.recipe).test:
        batch = MemoryDataset(store, np.array([row])).__getitems__([0])
        scene = scene_on(store.setup, store.profile)
        with torch.no_grad():
            u = run.model(scene, pokes_of(batch)).displacement[0]
        true = batch.displacement[0]
        found.append([1e3 * float(torch.linalg.norm(d, dim=1).mean()) for d in (u - true, true)])
    return np.mean(found, axis=0).tolist()


@pytest.fixture(scope="module")
def evaluated(run: Path) -> Path:
    """The run, with its evaluation and its intervals."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learn.baselines, "_STEPS", 50)
        unrender(patch)  # the pictures of other tests here are looked at
        done = call(learn.evaluate.app, run, "--threads", 1, "--no-clouds")
    assert done.exit_code == 0, done.output
    return run


def test_report_and_tables(evaluated: Path) -> None:
    run = evaluated
    html = (run / "evaluation" / "report.html").read_text()
    assert html.count("data:image/png;base64") == 5
    for name in ("learning", "best", "median", "worst", "force"):
        assert (run / "evaluation" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    for words in ("analytic kernel", "zero displacement", "Symmetry", "Intervals", "Deeper"):
        assert words in html
    tables = json.loads((run / "evaluation" / "tables.json").read_text())
    ours, zero = (tables["tables"][name]["all"] for name in (MODEL, "zero displacement"))
    assert set(ours) == set(METRICS)
    assert [ours["mean"]["mean"], zero["mean"]["mean"]] == pytest.approx(_means_by_hand(run), rel=1e-4)
    assert ours["mean"]["mean"] < zero["mean"]["mean"]
    assert tables["symmetry"][f"{MODEL}, fold 0"]["displacement_mm"] < 1e-5
    assert set(tables["tables"][MODEL]) == {"S0", "S1", "all"}
    assert (run / "intervals.json").is_file()


@pytest.fixture(scope="module")
def second(store: Path, run: Path) -> Path:
    """A run that differs from the first only by its seed."""
    return train_small(store, run.parent / "second", "--seed", 1)


def test_runs_together(run: Path, second: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """Two runs as an ensemble: its own row of the tables, intervals, symmetry and mean predictions."""
    flags = ("--ensemble", "--no-baselines", "--no-clouds", "--threads", 1, "--out", tmp_path / "both")
    namesake = shutil.copytree(second, tmp_path / run.name)  # the folders' names are the same
    (tmp_path / "both").mkdir()
    (tmp_path / "both" / "only.png").touch()  # of an earlier report, on one poke
    done = call(learn.evaluate.app, run, namesake, *flags)
    assert done.exit_code == 0, done.output
    assert not (tmp_path / "both" / "only.png").exists()
    _assert_pictures(tmp_path / "both", learning=(BLUE, ORANGE))  # a curve of each run
    request.getfixturevalue("unrendered")
    tables = json.loads((tmp_path / "both" / "tables.json").read_text())
    assert tables["runs"] == [str(run), str(namesake)]
    assert list(tables["tables"]) == [f"{MODEL}, 2 together", MODEL]
    assert tables["symmetry"][f"{MODEL}, 2 together, fold 0"]["displacement_mm"] < 1e-5
    assert list(tables["intervals"]) == [
        f"{MODEL}, 2 together, fold 0",
        f"{MODEL}, fold 0",
        f"{MODEL}, fold 0, seed 1",
    ]
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    answers = []
    for number, runs in enumerate(([run], [namesake], [run, namesake])):
        done = call(learn.predict.app, *runs, scene, "--out", tmp_path / str(number))
        assert done.exit_code == 0, done.output
        answers.append(json.loads((tmp_path / str(number) / "prediction.json").read_text()))
    one, other, both = answers
    assert both["force_N"] == pytest.approx((one["force_N"] * other["force_N"]) ** 0.5, rel=1e-5)
    assert both["radius_max_mm"] > 0
    alone = call(learn.evaluate.app, run, "--ensemble", "--out", tmp_path / "alone")
    assert alone.exit_code == 2
    assert "two or more runs" in alone.stderr
    assert not (tmp_path / "alone").exists()
    twice = call(learn.predict.app, run, run, scene, "--out", tmp_path / "twice")
    assert twice.exit_code == 2
    assert "expected runs that differ in seed alone" in twice.stderr


@pytest.mark.slow
def test_folds_together(store: Path, tmp_path: Path) -> None:
    """Each run's intervals come from the other folds' test parts, in the tables and in its folder."""
    runs = [tmp_path / f"fold{k}" for k in range(3)]
    for fold, folder in enumerate(runs):
        train_small(store, folder, "--fold", fold)
    flags = ("--no-baselines", "--no-clouds", "--threads", 1, "--out", tmp_path / "all")
    done = call(learn.evaluate.app, *runs, *flags)
    assert done.exit_code == 0, done.output
    tables = json.loads((tmp_path / "all" / "tables.json").read_text())
    names = [f"{MODEL}, fold {k}" for k in range(3)]
    assert list(tables["intervals"]) == [*names, *(f"{name}, by the other folds" for name in names)]
    assert "mean of those by the other folds" in (tmp_path / "all" / "report.html").read_text()
    tested = [split_pokes(open_store(store), fold=k, train_depth=2.5e-3).test for k in range(3)]
    poke = open_store(store).frame_poke
    for fold, folder in enumerate(runs):
        others = [len(np.unique(poke[rows])) for k, rows in enumerate(tested) if k != fold]
        kept = json.loads((folder / "intervals.json").read_text())
        assert kept["pokes"] == sum(others)


def test_a_run_of_another_dataset_is_refused(run: Path, tmp_path: Path) -> None:
    other = write_store(tmp_path / "o.zarr", seed=4, sites=3, frames=2)
    refused = call(learn.evaluate.app, run, "--dataset", other, "--out", tmp_path / "out")
    assert refused.exit_code == 2
    assert "trained on dataset" in refused.stderr
    assert not (tmp_path / "out").exists()


def test_a_damaged_run_is_refused(run: Path, tmp_path: Path) -> None:
    (tmp_path / "best.pt").write_bytes((run / "best.pt").read_bytes()[:500])
    refused = call(learn.evaluate.app, tmp_path)
    assert refused.exit_code == 2
    assert refused.stderr.count("\n") == 1
    assert "not a readable checkpoint" in refused.stderr
    assert not (tmp_path / "evaluation").exists()


@pytest.mark.usefixtures("few_motions")
def test_another_dataset_where_it_is_asked_for(evaluated: Path, tmp_path: Path) -> None:
    """Transfer tests all pokes of shapes unseen by the run, no others, and keeps the run's intervals."""
    run = evaluated
    other = write_store(tmp_path / "o.zarr", shapes=5, sites=2, frames=2)
    flags = ("--transfer", "--no-clouds", "--threads", 1)
    kept = (run / "intervals.json").read_bytes()
    for extra, words in (
        (["--transfer"], "expected another --dataset"),
        (["--out", run / "best.pt"], "--out"),
    ):
        wrong = call(learn.evaluate.app, run, *extra)  # type: ignore[arg-type]
        assert (wrong.exit_code, words in wrong.stderr) == (2, True), wrong.output
    refused = call(learn.evaluate.app, run, "--dataset", other, "--out", tmp_path / "out")
    assert refused.exit_code == 2
    assert not (tmp_path / "out").exists()
    allowed = call(learn.evaluate.app, run, "--dataset", other, "--out", tmp_path / "out", *flags)
    assert allowed.exit_code == 0, allowed.output
    _assert_pictures(tmp_path / "out", learning=(BLUE,))
    tables = json.loads((tmp_path / "out" / "tables.json").read_text())
    assert list(tables["tables"]) == [MODEL]
    assert list(tables["intervals"]) == [f"{MODEL}, fold 0"]
    # the training part has one interior, and not the smaller nor the larger ones
    assert all(name.startswith(f"{MODEL}, fold 0, ") for name in tables["outside"])
    assert f"{MODEL}, fold 0, beyond 1" in tables["outside"]
    frames = sum(one["frames"] for one in tables["outside"].values())
    assert frames == tables["test_frames"]
    assert "Outside what was trained" in (tmp_path / "out" / "report.html").read_text()
    assert (run / "intervals.json").read_bytes() == kept
    store, loaded = open_store(other), load_run(run)
    tested = np.unique(store.shape[store.frame_poke[parts_of(store, loaded).test]])
    assert {store.shapes[k] for k in tested} == {*loaded.groups["test"], "shape-3", "shape-4"}
    few = write_store(tmp_path / "few.zarr", seed=5, shapes=3)
    everything = replace(loaded, groups={**loaded.groups, "train": ["shape-0", "shape-1", "shape-2"]})
    with pytest.raises(InputError, match="trained on all its shapes"):
        parts_of(open_store(few), replace(everything, location=str(tmp_path / "gone.zarr")))


@pytest.mark.slow
def test_report_of_other_clouds(run: Path, tmp_path: Path) -> None:
    done = call(learn.evaluate.app, run, "--threads", 1, "--no-baselines", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    tables = json.loads((tmp_path / "tables.json").read_text())
    assert list(tables["clouds"]) == [
        "1024, the grid",
        "512, scattered",
        "1024, scattered",
        "4096, scattered",
    ]
    assert tables["cloud_interpolation_mm"] < 1e-6
