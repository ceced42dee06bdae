"""A dataset whose shapes stand in blocks of different sizes: read, trained on, evaluated, predicted."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
import torch
import zarr

import learn
import learn.baselines
import learn.evaluate
import learn.export
import learn.page
import learn.predict
import learn.train
from learn.data import MemoryDataset, Store, open_store, split_of, statistics
from learn.errors import InputError
from learn.evaluation import evaluation, predict_part, summarise
from learn.models import InvariantGnn, Pokes, Scenes, make_model, pokes_of, scene_on
from learn.models._contact import Contact, of_cover
from learn.models._encoder import _to_height
from learn.page.content import content_of
from learn.training import Recipe, Trainer
from learn.validity import domain_of
from tests.learn.commands import call
from tests.learn.small_store import grid, write_manifest, write_store

SIZES = ((0.08, 0.1, 0.025), (0.1, 0.09, 0.032), (0.12, 0.08, 0.038), (0.09, 0.12, 0.028))
MODEL = "invariant-gnn-small"
RECIPE = Recipe(name="tiny", model=MODEL, epochs=1, batch=6, point_dropout=0.5, point_jitter=0.5)
SPHERE = {"kind": "sphere", "radius_mm": 8, "centre_mm": [0, 0, 6]}
POKE = {"site_mm": [5, -10], "depth_mm": 2, "inclusion": SPHERE, "softness": "S1"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_store(
        tmp_path_factory.mktemp("blocks") / "s.zarr", shapes=4, sites=1, frames=3, blocks=SIZES
    )


@pytest.fixture(scope="module")
def store(folder: Path) -> Store:
    return open_store(folder)


@pytest.fixture(scope="module")
def run(store: Store, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("run") / "run"
    Trainer(store, RECIPE, out).train()
    return out


def test_each_shape_has_the_grid_of_its_block(store: Store) -> None:
    assert len(store.setups) == 4
    for poke in range(store.pokes):
        setup, size = store.setup_of(poke), SIZES[store.shape[poke]]
        np.testing.assert_allclose(setup.block_size, size, rtol=1e-12)
        np.testing.assert_allclose(setup.points, grid(size).reshape(-1, 3), atol=1e-15)
        assert setup.top == size[2]
    with pytest.raises(InputError, match=r"4 blocks of 80 to 120 x 80 to 120 x 25 to 38 mm"):
        _ = store.setup


def test_a_setup_on_another_block_is_that_of_a_store_of_it(store: Store) -> None:
    for k, size in enumerate(SIZES):
        made, stored = store.setups[0].with_block(size), store.setups[k]
        np.testing.assert_allclose(made.points, stored.points, atol=1e-15)
        np.testing.assert_allclose(made.level_depth, stored.level_depth, atol=1e-15)
        np.testing.assert_allclose(made.normals, stored.normals, atol=1e-12)


def test_grids_that_do_not_fit_the_geometries_are_refused(tmp_path: Path) -> None:
    copy = write_store(tmp_path / "s.zarr", shapes=4, frames=3, blocks=SIZES)
    group = zarr.open_group(copy, mode="r+")
    levels = np.asarray(group["level_depth"][:3])  # type: ignore[index]
    del group["level_depth"]
    group.create_array("level_depth", data=levels).attrs["units"] = "m"
    write_manifest(copy)
    with pytest.raises(InputError, match="level_depth has 3 rows"):
        open_store(copy)


@pytest.mark.parametrize("name", ["invariant-gnn", "cegnn"])
def test_a_batch_over_several_blocks_is_each_poke_alone(store: Store, name: str) -> None:
    data = MemoryDataset(store, np.arange(store.frames))
    torch.manual_seed(1)
    model = make_model(name, statistics(data.batches(64), store)).eval()
    rows = np.array([20, 3, 13, 8, 1])
    mixed = MemoryDataset(store, rows)
    with torch.no_grad():
        found = predict_part(model, Scenes.of(store), mixed)
        for k, row in enumerate(rows):
            poke = store.frame_poke[row]
            geometry = int(store.geometry[poke])
            scene = scene_on(store.setup_of(poke), store.profile[geometry : geometry + 1])
            pokes = pokes_of(mixed.__getitems__([k]))
            alone = model(scene, dataclasses.replace(pokes, geometry=torch.zeros(1, dtype=torch.int64)))
            mine = np.flatnonzero((found.poke == poke) & (found.depth == store.depth[row]))
            assert len(mine) == 1
            np.testing.assert_allclose(found.predicted[mine[0]], alone.displacement[0], atol=1e-9)
            np.testing.assert_allclose(found.force_predicted[mine[0]], alone.force[0], rtol=1e-5)
            away = np.linalg.norm(store.setup_of(poke).points - store.path_start[poke], axis=1)
            np.testing.assert_allclose(found.away[mine[0]], away)


def test_rows_of_parts_come_in_the_order_of_the_batch(store: Store) -> None:
    batch = MemoryDataset(store, np.array([20, 3, 13, 8, 1])).__getitems__(np.arange(5))
    scenes = Scenes.of(store)
    depths = scenes.rows(lambda _, part: part.depth.numpy(), batch)
    np.testing.assert_array_equal(depths, batch.depth)
    heights = scenes.rows(lambda scene, part: np.full(len(part), scene.height), batch)
    shapes = store.shape[store.frame_poke[batch.frame]]
    np.testing.assert_allclose(heights, [SIZES[k][2] for k in shapes])


def test_the_network_tells_heights_apart(store: Store) -> None:
    """Profiles that are alike level by level mean other depths in a block of another height."""
    sizes = statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)
    own = dataclasses.replace(sizes, block_height=None)
    profile = store.profile[:1]
    low, high = (scene_on(store.setups[1].with_block((0.1, 0.09, h)), profile) for h in (0.028, 0.04))
    for known, alike in ((sizes, False), (own, True)):
        torch.manual_seed(0)
        model = make_model("invariant-gnn", known)
        with torch.no_grad():
            a, b = model.encode(low).code, model.encode(high).code
        assert torch.allclose(a, b) == alike


def test_depths_are_in_units_of_the_mean_height(store: Store) -> None:
    """A level keeps its depth in millimetres; below the base, on which the tissue is fixed, all is rigid."""
    rows = np.arange(store.frames)
    sizes = statistics(MemoryDataset(store, rows).batches(64), store)
    assert sizes.block_height == pytest.approx(np.mean([SIZES[k][2] for k in store.shape[store.frame_poke]]))
    levels = torch.arange(128)
    one = ((levels >= 40) & (levels < 80)).float().reshape(1, 1, 128)
    np.testing.assert_array_equal(_to_height(one, 2.0)[0, 0], (levels >= 80).float())
    shallow = (levels >= 20) & (levels < 40) | (levels >= 64)
    np.testing.assert_array_equal(_to_height(one, 0.5)[0, 0], shallow.float())


def test_the_network_sees_the_thickness_of_the_tissue_below_the_contact(store: Store) -> None:
    """In rod radii, whatever the mean height of the blocks; of two layers side by side the harmonic mean."""
    setup = store.setups[1].with_block((0.1, 0.09, 0.032))
    levels = np.arange(128) * (32 / 128)
    layer = np.where(levels >= 5, 255, 0)
    right = setup.points[:, :1] > 0
    halves = np.where(right & (levels >= 5) | (levels >= 20), 255, 0)
    profile = np.stack([np.broadcast_to(layer, halves.shape), halves]).astype(np.uint8)
    scene = scene_on(setup, profile)
    start = torch.tensor([[0.0, 0.0, setup.top]], dtype=torch.float64).expand(2, 3)
    down = torch.tensor([[0.0, 0.0, -1.0]], dtype=torch.float64).expand(2, 3)
    depth, modulus = torch.full((2, 2), 1e-3, dtype=torch.float64)
    pokes = Pokes(geometry=torch.arange(2), start=start, direction=down, depth=depth, modulus=modulus)
    sizes = statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)
    for height in (None, 0.02, 0.05):
        model = make_model("invariant-gnn", dataclasses.replace(sizes, block_height=height))
        assert isinstance(model, InvariantGnn)
        contact = Contact(scene, pokes)
        with torch.no_grad():
            cover = 1e3 * setup.rod_radius * model._cover(model.encode(scene), contact, scene.rigid_index)
        assert cover.tolist() == pytest.approx([5.0, 2 / (1 / 5 + 1 / 20)], rel=0.02)
    of_layer = of_cover(cover / 2.5, contact.depth, contact.poke[:, 2])
    assert [float(value[0]) for value in of_layer] == pytest.approx([np.log(0.5), 0.5, 1 / 5], rel=0.02)


def test_a_dataset_of_one_height_is_encoded_as_by_its_own(tmp_path: Path) -> None:
    store = open_store(write_store(tmp_path / "s.zarr", frames=2))
    sizes = statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)
    codes = []
    for known in (sizes, dataclasses.replace(sizes, block_height=None)):
        torch.manual_seed(0)
        model = make_model("invariant-gnn", known)
        with torch.no_grad():
            codes.append(model.encode(scene_on(store.setup, store.profile)).code)
    assert torch.equal(*codes)


def test_the_domain_is_that_of_the_trained_blocks(store: Store, run: Path) -> None:
    trained = split_of(store, RECIPE).train
    ranges = domain_of(store, trained).ranges
    sizes = 1e3 * np.array([SIZES[k] for k in np.unique(store.shape[store.frame_poke[trained]])])
    for axis, (low, high) in zip("xyz", zip(sizes.min(axis=0), sizes.max(axis=0), strict=True), strict=True):
        assert ranges[f"block_{axis}_mm"] == pytest.approx((low, high))
    predictor = learn.load(run)
    assert predictor.domain is not None
    for key, ends in predictor.domain.ranges.items():
        assert ends == pytest.approx(ranges[key])


def test_training_streamed_is_training_in_memory_but_for_the_order(store: Store, tmp_path: Path) -> None:
    """One batch holds the whole part, so that order is nothing: the losses are equal."""
    losses = []
    for data in ("memory", "stream"):
        recipe = Recipe(name="tiny", model=MODEL, epochs=1, batch=64, point_dropout=0.0, data=data)
        Trainer(store, recipe, tmp_path / data).train()
        line = json.loads((tmp_path / data / "log.jsonl").read_text().splitlines()[-1])
        losses.append([line["train_loss"], line["validation_mean_mm"]])
    np.testing.assert_allclose(losses[0], losses[1], rtol=1e-4)


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_evaluation_with_clouds(run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evaluation, "CLOUD_SIZES", (200,))
    monkeypatch.setattr(evaluation, "CLOUD_SEEDS", 1)
    done = call(learn.evaluate.app, run, "--out", tmp_path / "out", "--no-baselines")
    assert done.exit_code == 0, done.stderr
    tables = json.loads((tmp_path / "out" / "tables.json").read_text())
    assert "200, scattered" in json.dumps(tables)


def test_baselines_know_their_own_pokes(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """On the part that it was fitted to, the nearest poke is the poke itself, in whatever block."""
    monkeypatch.setattr(learn.baselines, "_STEPS", 20)
    scenes, data = Scenes.of(store), MemoryDataset(store, np.arange(store.frames))
    for name, kind in learn.baselines.BASELINES.items():
        baseline = kind()
        baseline.fit(data, scenes)
        found = summarise(predict_part(baseline, scenes, data))
        assert np.isfinite(found["mean"].mean)
        if name == "nearest training poke":
            assert found["max"].mean < 1e-4
            assert found["rel force"].mean < 1e-5


def test_the_block_of_ones_own_inclusion_is_stated(run: Path) -> None:
    predictor = learn.load(run)
    predictor.intervals = None  # of an evaluation, if another test has made one
    with pytest.raises(InputError, match="expected key block_mm, the block's sides, since the dataset has 4"):
        predictor.predict(POKE)
    answer = predictor.predict({**POKE, "block_mm": [100, 80, 30]})
    np.testing.assert_allclose(answer.points, grid((0.1, 0.08, 0.03)).reshape(-1, 3), atol=1e-15)
    checks = {check.key: check for check in answer.checks}
    assert checks["block_y_mm"].value == pytest.approx(80)
    far = predictor.predict({**POKE, "block_mm": [100, 80, 60]})
    assert "block's height" in far.verdict
    assert "interval" not in far.verdict
    with pytest.raises(InputError, match="expected no key block_mm beside shape"):
        predictor.predict({**POKE, "inclusion": None, "shape": "shape-1", "block_mm": [100, 80, 30]})
    with pytest.raises(InputError, match=r"site_mm: expected x within -47.5 to 47.5 mm and y within -27.5"):
        predictor.predict({**POKE, "site_mm": [0, 30], "block_mm": [100, 60, 30]})
    named = predictor.predict({**POKE, "inclusion": None, "shape": "shape-2"})
    np.testing.assert_allclose(named.points, grid(SIZES[2]).reshape(-1, 3), atol=1e-15)


def test_in_real_time_as_poke_by_poke(run: Path) -> None:
    predictor = learn.load(run)
    touch = predictor.real_time({"inclusion": SPHERE, "block_mm": [100, 80, 30], "softness": "S1"})
    found = touch(site=(5e-3, -10e-3), direction=(0.0, 0.0, -1.0), depth=2e-3)
    asked = predictor.predict({**POKE, "block_mm": [100, 80, 30]})
    assert found.force == pytest.approx(asked.force, rel=1e-4)
    np.testing.assert_allclose(found.displacement, asked.displacement, atol=1e-8)


def test_another_block_than_the_only_one_is_outside(tmp_path: Path) -> None:
    store = open_store(write_store(tmp_path / "s.zarr", sites=1, frames=1))
    Trainer(
        store,
        Recipe(name="tiny", model=MODEL, epochs=1, batch=64, point_dropout=0.0),
        tmp_path / "run",
    ).train()
    predictor = learn.load(tmp_path / "run")
    here, there = (predictor.predict({**POKE, **more}) for more in ({}, {"block_mm": [100, 100, 24]}))
    assert "block_z_mm" in {check.key for check in there.outside} - {check.key for check in here.outside}


def test_a_page_is_of_one_block(run: Path) -> None:
    predictor = learn.load(run)
    with pytest.raises(InputError, match=r"4 blocks of .* expected --shape"):
        content_of(predictor)
    with pytest.raises(InputError, match="expected --shape"):
        content_of(predictor, shapes=["shape-1", "shape-2"])
    content = content_of(predictor, shapes=["shape-2"])
    assert content.about["block"]["size"] == pytest.approx([1e3 * v for v in SIZES[2]])


@pytest.mark.slow  # a dozen seconds
def test_an_export_is_of_one_block(run: Path, tmp_path: Path) -> None:
    pytest.importorskip("onnxruntime")
    refused = call(learn.export.app, run, "--out", tmp_path / "onnx")
    assert refused.exit_code == 2
    assert "expected --shape" in refused.stderr
    done = call(learn.export.app, run, "--out", tmp_path / "onnx", "--shape", "shape-2")
    assert done.exit_code == 0, done.stderr
    assert "off torch over" in done.stdout
