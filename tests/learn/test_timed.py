"""Datasets with time: read, split, used for training with time as input, and for prediction."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
import zarr

import learn
import learn.evaluate
from learn.data import MemoryDataset, StreamDataset, open_store, split_pokes, statistics
from learn.errors import InputError
from learn.evaluation import parts_of
from learn.evaluation.predictions import interpolation_error_mm, predict_part
from learn.models import Pokes, Scenes, make_model, pokes_of, scene_on
from learn.models.single_poke import SinglePoke
from learn.onnx_bundle import CLOCK as CLOCK_NAMES
from learn.onnx_bundle import TOLERANCE, OnnxBundle, write_bundle
from learn.training import Recipe, Trainer, load_run
from learn.validity import frame_distances
from tests.learn.commands import call, train_small
from tests.learn.small_store import write_manifest, write_store

PHASES = ("load", "hold", "retract", "reload", "rest")
TINY = Recipe(name="tiny", model="invariant-gnn-small", epochs=1, batch=4, ema_decay=0.9)
POKE = {"site_mm": [5, -10], "depth_mm": 2, "shape": "shape-1", "softness": "S1"}
CLOCK = {"time_s": 1.0, "rod_speed_mm_per_s": 0.0, "approach_speed_mm_per_s": 2.0}


def write_timed_store(folder: Path) -> Path:
    """The small store with its four frames as a load to 1 and 2 mm, a hold, and a retraction to 0 mm."""
    write_store(folder, sites=2, frames=4)
    group = zarr.open_group(folder, mode="r+")
    pokes = len(np.asarray(group["done"][...]))  # type: ignore[index]
    speed = 1e-3 * (1.0 + np.arange(pokes) % 5)

    def put(name: str, value: np.ndarray, dtype: str, units: str | None = None) -> zarr.Array:
        array = group.create_array(name, data=value.astype(dtype))
        if units:
            array.attrs["units"] = units
        return array

    begin = 2e-3 / speed
    put("course_time", np.stack([begin, begin + 10, begin + 11], axis=1), "f8", "s")
    put("course_depth", np.tile([2e-3, 2e-3, 0.0], (pokes, 1)), "f8", "m")
    put("time", np.stack([begin / 2, begin, begin + 10, begin + 11], axis=1).reshape(-1), "f8", "s")
    put("phase", np.tile([0, 0, 1, 2], pokes), "u1").attrs["flag_meanings"] = " ".join(PHASES)
    speeds = np.stack([speed, speed, 0 * speed, 0 * speed - 2e-3], axis=1)
    put("rod_speed", speeds.reshape(-1), "f8", "m s-1")
    put("dissipated_energy", np.tile([1e-6, 2e-6, 3e-6, 4e-6], pokes), "f8", "J")
    group["depth"][...] = np.tile([1e-3, 2e-3, 2e-3, 0.0], pokes)  # type: ignore[index]
    force = np.asarray(group["rod_force"][...])  # type: ignore[index]
    force[3::4] = 0.0
    group["rod_force"][...] = force  # type: ignore[index]
    write_manifest(folder)
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_timed_store(tmp_path_factory.mktemp("timed") / "s.zarr")


@pytest.fixture(scope="module")
def run(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("run") / "run"
    Trainer(open_store(folder), TINY, out).train()
    return out


def test_frames_carry_their_clock(folder: Path) -> None:
    store = open_store(folder)
    assert store.clock is not None
    assert store.clock.phase[:4].tolist() == ["load", "load", "hold", "retract"]
    np.testing.assert_allclose(store.clock.approach_speed[:3], [1e-3, 2e-3, 3e-3])
    np.testing.assert_allclose(store.clock.dissipated_energy[:4], [1e-6, 2e-6, 3e-6, 4e-6])
    rows = np.array([4, 6, 2])
    wanted = [[0.5, 2e-3, 2e-3], [11.0, 0.0, 2e-3], [12.0, 0.0, 1e-3]]
    np.testing.assert_allclose(MemoryDataset(store, rows).__getitems__([0, 1, 2]).clock, wanted)
    (batch,) = StreamDataset(store, rows, batch=4, seed=None)
    np.testing.assert_allclose(batch.clock, [wanted[2], wanted[0], wanted[1]])


def test_frames_without_a_force_are_in_no_part(folder: Path) -> None:
    store = open_store(folder)
    assert store.presses.reshape(-1, 4)[:, :3].all()
    assert not store.presses[3::4].any()
    split = split_pokes(store)
    every = np.sort(np.concatenate([split.train, split.validation, split.test]))
    np.testing.assert_array_equal(every, np.flatnonzero(store.presses))


def test_frames_without_a_force_are_not_tested_on_another_dataset(run: Path, tmp_path: Path) -> None:
    other = write_timed_store(tmp_path / "other.zarr")
    group = zarr.open_group(other, mode="r+")
    group.attrs["uuid"] = "another"
    group["profile"][...] = np.roll(group["profile"][...], 1, axis=1)  # type: ignore[index]
    write_manifest(other)
    store = open_store(other)
    parts = parts_of(store, load_run(run))
    np.testing.assert_array_equal(parts.test, np.flatnonzero(store.presses))
    # the frames of a poke that is tested need not follow each other
    rows = np.flatnonzero(np.arange(store.frames) % 4 != 1)
    whole = interpolation_error_mm(store, np.arange(store.frames))
    assert interpolation_error_mm(store, rows) == pytest.approx(whole, abs=2e-3)


def test_a_dataset_without_time_is_as_before(tmp_path: Path) -> None:
    store = open_store(write_store(tmp_path / "s.zarr"))
    assert store.clock is None
    assert store.presses.all()
    data = MemoryDataset(store, np.arange(store.frames))
    assert data.__getitems__([0, 1]).clock.shape == (2, 0)
    found = statistics(data.batches(16), store)
    assert not {"log_time_mean", "log_speed_mean"} & set(found.as_dict())
    model = make_model("invariant-gnn-small", found)
    assert not model.takes_clock
    timed = make_model("invariant-gnn-small", replace(found, log_time_mean=0.0, log_speed_mean=-6.0))
    wider = {n for n, w in model.state_dict().items() if w.shape != timed.state_dict()[n].shape}
    assert wider == {"from_poke.weight", "force_head.0.weight"}


def _spoil(name: str, row: int, value: float) -> Callable[[zarr.Group], None]:
    def change(group: zarr.Group) -> None:
        group[name][row] = value  # type: ignore[index]

    return change


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (_spoil("time", 5, 0.0), "time does not rise from 0 in each poke"),
        (_spoil("time", 8, -1.0), "time does not rise from 0 in each poke"),
        (_spoil("depth", 3, -1e-4), "depth has a value below 0"),
        (_spoil("phase", 3, 9), "phase has a code without a name"),
        (_spoil("dissipated_energy", 3, np.nan), "dissipated_energy has a value that is not finite"),
        (lambda group: group.__delitem__("rod_speed"), "array rod_speed is missing"),
        (lambda group: group["time"].attrs.__setitem__("units", "ms"), "time: units ms, expected s"),
    ],
)
def test_a_damaged_clock_is_named(
    change: Callable[[zarr.Group], None], sentence: str, tmp_path: Path
) -> None:
    folder = write_timed_store(tmp_path / "s.zarr")
    change(zarr.open_group(folder, mode="r+"))
    write_manifest(folder)
    with pytest.raises(InputError, match=sentence):
        open_store(folder)


def test_the_surrogate_takes_time_and_speed_as_inputs(folder: Path, run: Path) -> None:
    store, trained = open_store(folder), load_run(run)
    assert trained.model.takes_clock
    assert trained.statistics.log_time_mean is not None
    scene = scene_on(store.setup, store.profile)
    pokes = pokes_of(MemoryDataset(store, np.array([1, 6])).__getitems__([0, 1]))
    with torch.no_grad():
        one = trained.model(scene, pokes)
        for column in range(3):
            clock = pokes.clock.clone()
            clock[:, column] = clock[:, column] * 1.5 + 1e-3 * (column == 1)
            two = trained.model(scene, replace(pokes, clock=clock))
            assert not torch.equal(one.force, two.force)
            assert not torch.equal(one.displacement, two.displacement)
        alone = trained.model(scene, Pokes(**{k: v[1:] for k, v in vars(pokes).items()}))
        torch.testing.assert_close(alone.force[0], one.force[1])
        with pytest.raises(InputError, match="trained with time: expected that of each poke"):
            trained.model(scene, replace(pokes, clock=pokes.clock[:, :0]))
        with pytest.raises(InputError, match="not offered one poke at a time"):
            SinglePoke(trained.model, trained.model.encode(scene))  # type: ignore[arg-type]


def test_predicted_from_a_scene_with_time(folder: Path, run: Path) -> None:
    predictor = learn.load(run, dataset=folder)
    found = predictor.predict({**POKE, **CLOCK})
    assert np.isfinite(found.force)
    assert {"time_s", "rod_speed_mm_per_s", "approach_speed_mm_per_s"} <= set(found.as_dict()["domain"])
    assert "time_s" not in {check.key for check in found.outside}
    late = predictor.predict({**POKE, **CLOCK, "time_s": 500.0})
    assert "time_s" in {check.key for check in late.outside}
    assert late.force != found.force
    with pytest.raises(InputError, match=r"expected keys time_s, .* trained with time"):
        predictor.predict(POKE)
    with pytest.raises(
        InputError, match="expected time_s, rod_speed_mm_per_s and approach_speed_mm_per_s, or"
    ):
        predictor.predict({**POKE, "time_s": 1.0})


def test_a_model_that_takes_no_time_is_not_trained_on_it(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="its frames have time, which model cegnn takes no account of"):
        Trainer(open_store(folder), TINY.model_copy(update={"model": "cegnn"}), tmp_path / "run")
    assert not (tmp_path / "run").exists()


@pytest.mark.slow
@pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("onnx", "onnxscript", "onnxruntime")),
    reason="the onnx packages are not installed",
)
def test_onnx_takes_the_clock(folder: Path, run: Path, tmp_path: Path) -> None:
    store, trained = open_store(folder), load_run(run)
    _, wrong, checked = write_bundle(trained, store, tmp_path / "onnx", None)
    assert checked > 1
    assert wrong < TOLERANCE
    assert json.loads((tmp_path / "onnx" / "model.json").read_text())["clock"] == CLOCK_NAMES
    bundle, scene = OnnxBundle(tmp_path / "onnx"), scene_on(store.setup, store.profile)
    pokes = pokes_of(MemoryDataset(store, np.array([1])).__getitems__([0]))
    code = bundle.encode(scene.rigid[0])
    now, _ = bundle.poke(code, pokes, 0)
    later, _ = bundle.poke(code, replace(pokes, clock=pokes.clock * torch.tensor([5.0, 0.0, 1.0])), 0)
    assert np.abs(later - now).max() > 10.0 * TOLERANCE * np.abs(now).max()


def test_time_counts_in_the_distance_of_an_evaluation(run: Path, tmp_path: Path) -> None:
    """As in a prediction: a hold a thousand times longer is outside what was trained."""
    store, loaded = open_store(write_timed_store(tmp_path / "s.zarr")), load_run(run)
    assert loaded.domain is not None
    rows = np.flatnonzero(store.presses)[:6]
    data = MemoryDataset(store, rows)
    found = predict_part(loaded.model, Scenes.of(store), data)
    np.testing.assert_allclose(found.clock, store.clocks(rows), rtol=1e-6)
    own = found.poke, found.depth
    inside = frame_distances(loaded.domain, store, *own, found.clock)
    later = frame_distances(loaded.domain, store, *own, found.clock * [1e3, 1.0, 1.0])
    assert (later > inside + 1.0).all()


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_a_model_without_time_on_a_dataset_with_time_is_said_to_be_one(
    folder: Path, run: Path, tmp_path: Path
) -> None:
    still = train_small(write_store(tmp_path / "still.zarr", seed=4), tmp_path / "still", "--epochs", 1)
    flags = ("--no-clouds", "--no-baselines", "--threads", 1)
    other = call(learn.evaluate.app, still, "--dataset", folder, "--transfer", *flags)
    assert f"Trained without time: {still}" in other.output.replace("\n", "")
    own = call(learn.evaluate.app, run, *flags)
    assert (own.exit_code, other.exit_code) == (0, 0)
    assert "Trained without time" not in own.output
