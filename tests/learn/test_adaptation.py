"""learn.adapt: a run learns another law from a few pokes, and is measured on contact points left out."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
import zarr
from numpy.typing import NDArray

import learn
from learn.adaptation import PARTS, Adaptation, adapt, adapt_recipe, stages_to
from learn.cli import app
from learn.data import MemoryDataset, contact_points, open_store, split_of_run
from learn.data.folds import frames_once
from learn.errors import InputError
from learn.evaluation import fit_intervals, load_intervals, parts_of, predict_part, save_intervals
from learn.models import Scenes
from learn.page.content import content_of
from learn.progress import Progress
from learn.training import Run, load_run
from learn.training.fine_tuning import FineTuning, Tuned
from learn.training.run_folder import load_checkpoint, save_checkpoint
from learn.validity import domain_of
from tests.learn.commands import call, refused, train_small
from tests.learn.small_store import leave_out, write_manifest, write_store

FEW = {"epochs": 1}
STIFFER = 1.5  # of the body's force at equal modulus and displacement: another law


@pytest.fixture(scope="module")
def trained_on(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_store(tmp_path_factory.mktemp("adaptation") / "s.zarr", shapes=3, sites=3, frames=3)


@pytest.fixture(scope="module")
def run(trained_on: Path, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return load_run(
        train_small(
            trained_on,
            tmp_path_factory.mktemp("run") / "run",
            "--epochs",
            2,
            "--model",
            "invariant-gnn-small",
        )
    )


@pytest.fixture(scope="module")
def body(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A body of another law: six contact points, one softness level."""
    folder = tmp_path_factory.mktemp("body") / "b.zarr"
    write_store(folder, shapes=1, softness=("S1",), sites=6, frames=3, seed=5)
    group = zarr.open_group(folder, mode="r+")
    force = group["rod_force"]
    force[...] = STIFFER * np.asarray(force[...])  # type: ignore[index]
    write_manifest(folder)
    return folder


@pytest.fixture(scope="module")
def found(run: Run, body: Path) -> Adaptation:
    states: list[Progress] = []
    found = adapt(run, open_store(body), recipe=adapt_recipe(run, {"epochs": 2}), on_progress=states.append)
    assert [state.done for state in states] == list(range(1, int(states[-1].total) + 1))
    return found


@pytest.fixture(scope="module")
def adapted(found: Adaptation, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("adapted") / "run"
    found.save(folder)
    return folder


def _refused(*arguments: object) -> str:
    return refused(call(app, *arguments))


def test_another_law_is_learned_from_six_pokes(found: Adaptation) -> None:
    was, now = found.rows_of_table.values()
    assert was["rel force"].mean > 0.25  # 1 - 1 / STIFFER = 0.33
    assert now["rel force"].mean < 0.5 * was["rel force"].mean
    assert found.epochs is not None


def test_the_largest_number_of_epochs_is_said_to_be_that(found: Adaptation) -> None:
    hint = "--epochs 4 may gain more"
    assert found.recipe.epochs == 2
    assert hint in replace(found, epochs=2).verdict
    assert not any(hint in replace(found, epochs=fewer).verdict for fewer in (None, 0, 1))


def test_each_contact_point_is_predicted_by_a_network_that_was_not_given_it(
    run: Run, body: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = open_store(body)
    given: list[NDArray[np.int64]] = []

    def remember(
        _self: FineTuning, rows: NDArray[np.int64], epochs: Sequence[int], **_: object
    ) -> Iterator[Tuned]:
        given.append(rows)
        return (Tuned(run.model, run.statistics) for _ in epochs)

    monkeypatch.setattr(FineTuning, "stages", remember)
    found = adapt(run, store, recipe=adapt_recipe(run, FEW))
    assert len(given) == PARTS
    left_out = [np.setdiff1d(found.rows, rows) for rows in given]
    np.testing.assert_array_equal(np.sort(np.concatenate(left_out)), found.rows)
    for rows, out in zip(given, left_out, strict=True):
        keys = (contact_points(store, store.frame_poke[part]) for part in (rows, out))
        assert not np.isin(*keys).any()
    # the order of the predictions is that of the parts
    poke = np.concatenate([store.frame_poke[out] for out in left_out])
    np.testing.assert_array_equal(found.after.poke, poke)


def test_without_a_gain_the_run_s_own_network_is_kept(
    run: Run, body: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    plain = FineTuning.stages

    def worse(
        self: FineTuning, rows: NDArray[np.int64], epochs: Sequence[int], **_: object
    ) -> Iterator[Tuned]:
        for tuned in plain(self, rows, epochs):
            with torch.no_grad():
                for value in tuned.model.parameters():
                    value += 0.3
            yield tuned

    monkeypatch.setattr(FineTuning, "stages", worse)
    monkeypatch.setattr(learn.adaptation, "PARTS", 2)  # each part takes a training
    found = adapt(run, open_store(body), recipe=adapt_recipe(run, FEW))
    assert found.epochs is None
    assert "the run's own network is kept" in found.verdict
    found.save(tmp_path / "run")
    for name, value in load_run(tmp_path / "run").model.state_dict().items():
        assert torch.equal(value, run.model.state_dict()[name])


def test_the_adapted_run_predicts_its_body_with_intervals(
    adapted: Path, body: Path, found: Adaptation
) -> None:
    predictor = learn.load(adapted)
    assert predictor.run.uuid == open_store(body).uuid
    poke = {"site_mm": [5, -10], "depth_mm": 2, "angle_deg": 10, "shape": "shape-0", "softness": "S1"}
    answer = predictor.predict(poke)
    assert answer.radius is not None
    assert answer.force_interval is not None
    intervals = load_intervals(predictor.run)
    assert intervals is not None
    assert intervals.pokes == found.points == 6
    assert intervals.promised == pytest.approx(6 / 7)
    assert "86% can be promised" in found.interval_text


def test_intervals_keep_the_error_scale_of_the_run(
    trained_on: Path, run: Run, body: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(learn.adaptation, "PARTS", 2)  # each part takes a training
    store = open_store(trained_on)
    scenes, rows = Scenes.of(store), split_of_run(store, run).validation
    own = fit_intervals(predict_part(run.model, scenes, MemoryDataset(store, rows)))
    copy = replace(run, folder=tmp_path)
    save_intervals(copy, own)
    found = adapt(copy, open_store(body), recipe=adapt_recipe(run, FEW))
    assert found.intervals is not None
    assert (found.intervals.scale, found.intervals.force_scale) == (own.scale, own.force_scale)
    assert found.intervals.factors != own.factors


def test_the_range_of_validity_is_that_of_the_body_and_of_both_in_the_contact(
    adapted: Path, run: Run, body: Path
) -> None:
    found, before = load_run(adapted).domain, run.domain
    assert found is not None
    assert before is not None
    store = open_store(body)
    own = domain_of(store, frames_once(store))
    for key in ("inclusion_width_mm", "depth_mm", "rod_radius_mm"):
        assert found.ranges[key] == own.ranges[key]
    assert found.ranges["inclusion_width_mm"] != before.ranges["inclusion_width_mm"]
    for key in ("angle_deg", "cover_mm", "site_to_side_mm"):
        both = before.ranges[key], own.ranges[key]
        assert found.ranges[key] == (min(low for low, _ in both), max(high for _, high in both))


def test_pretraining_is_no_test_part_either(adapted: Path, trained_on: Path, run: Run) -> None:
    store = open_store(trained_on)
    tested = parts_of(store, load_run(adapted))
    assert tested.groups["test"] == run.groups["test"]


def test_nothing_is_left_to_test_on_the_body(adapted: Path) -> None:
    assert "nothing is left to test" in _refused("evaluate", adapted)


def test_the_page_and_the_export_find_no_test_part(adapted: Path, body: Path) -> None:
    predictor = learn.load(adapted)
    split = split_of_run(open_store(body), predictor.run)
    assert len(split.train) == 18
    assert not len(split.test)
    shown = content_of(predictor)
    assert shown.about["simulated"] == []
    assert "seen in training" in shown.about["interiors"][0]["label"]


def test_the_command_writes_a_run_and_its_pictures(
    run: Run, body: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(learn.adaptation, "PARTS", 2)  # each part takes a training
    out = tmp_path / "run"
    done = call(app, "adapt", run.folder, body, "--out", out, "--epochs", 1, "--threads", 1)
    assert done.exit_code == 0, done.output
    assert "6 contact points, 18 frames" in done.output
    content = json.loads((out / "adaptation.json").read_text())
    assert content["contact_points"] == 6
    assert set(content["metrics"]) == {"as trained", "adapted"}
    assert (out / "adaptation.png").stat().st_size > 10_000
    assert load_checkpoint(out / "best.pt")["pretrained"]["uuid"] == run.uuid
    assert "a run is there already" in _refused("adapt", run.folder, body, "--out", out)


def test_stages_are_what_fewer_epochs_give(run: Run, body: Path) -> None:
    store = open_store(body)
    tuning = FineTuning(run, store, adapt_recipe(run, {"epochs": 2}))
    rows = frames_once(store)
    zero, one, two = tuning.stages(rows, [0, 1, 2])
    for name, value in run.model.state_dict().items():
        assert torch.equal(zero.model.state_dict()[name], value)
    assert zero.statistics.log_force_mean > run.statistics.log_force_mean + 0.2  # ln(STIFFER) = 0.41
    for tuned, epochs in ((one, 1), (two, 2)):
        [again] = tuning.stages(rows, [epochs])
        for name, value in tuned.model.state_dict().items():
            assert torch.equal(value, again.model.state_dict()[name])
    assert any(
        not torch.equal(value, two.model.state_dict()[name]) for name, value in one.model.state_dict().items()
    )


def test_numbers_of_epochs_to_choose_among() -> None:
    assert stages_to(1) == [0, 1]
    assert stages_to(6) == [0, 1, 2, 4, 6]
    assert stages_to(16) == [0, 1, 2, 4, 8, 16]


def test_what_cannot_be_adapted_to_is_refused_by_name(
    run: Run, trained_on: Path, adapted: Path, body: Path, tmp_path: Path
) -> None:
    assert "this dataset itself" in _refused("adapt", run.folder, trained_on, "--out", tmp_path / "a")
    few = write_store(tmp_path / "few.zarr", shapes=1, softness=("S1",), sites=3, frames=2, seed=6)
    leave_out(few, [2])
    assert "2 contact points, expected 3 or more" in _refused(
        "adapt", run.folder, few, "--out", tmp_path / "b"
    )
    assert "adapted already" in _refused("adapt", adapted, trained_on, "--out", tmp_path / "c")
    assert "key epochs" in _refused("adapt", run.folder, body, "--epochs", 0, "--out", tmp_path / "d")
    assert not any((tmp_path / name).exists() for name in "abcd")


def test_a_damaged_origin_is_refused(adapted: Path, tmp_path: Path) -> None:
    content = load_checkpoint(adapted / "best.pt")
    del content["pretrained"]["seen"]
    save_checkpoint(tmp_path / "best.pt", content)
    with pytest.raises(InputError, match=r"not a readable checkpoint \(key pretrained.seen"):
        load_run(tmp_path)
