"""A run predicts without its dataset, by the tables in its folder."""

from __future__ import annotations

import dataclasses
import io
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

import learn
from learn.cli import app
from learn.data import Store, load_tables, open_store, split_of_run
from learn.data.tables import TABLES, tables_bytes
from learn.errors import InputError
from learn.training import load_run
from tests.learn.commands import call, refused, train_small
from tests.learn.small_store import write_store
from tests.learn.test_timed import write_timed_store

POKE = {"site_mm": [5, -10], "depth_mm": 2, "angle_deg": 20, "shape": "shape-1", "softness": "S1"}


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_store(tmp_path_factory.mktemp("tables") / "s.zarr", shapes=3, sites=3, frames=3)


@pytest.fixture(scope="module")
def run(store: Path) -> Path:
    return train_small(store, store.parent / "run", "--epochs", 1)


@pytest.fixture
def alone(run: Path, tmp_path: Path) -> Path:
    """The run's folder, whose dataset is not at hand."""
    folder = tmp_path / "run"
    shutil.copytree(run, folder)
    content = torch.load(folder / "best.pt", weights_only=True)
    torch.save({**content, "location": str(tmp_path / "gone.zarr")}, folder / "best.pt")
    return folder


def _same(one: Any, other: Any) -> bool:
    return bool(np.array_equal(one, other)) and one.dtype == other.dtype


WRITE: dict[str, Callable[[Path], Path]] = {
    "two blocks": lambda path: write_store(path, shapes=2, blocks=((0.1, 0.1, 0.032), (0.08, 0.09, 0.03))),
    "time": write_timed_store,
}


@pytest.mark.parametrize("kind", WRITE)
def test_the_tables_are_the_dataset_s(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = open_store(WRITE[kind](tmp_path / "s.zarr"))
    (tmp_path / TABLES).write_bytes(tables_bytes(store))
    tables = load_tables(tmp_path / TABLES)
    for field in dataclasses.fields(Store):
        one, other = getattr(store, field.name), getattr(tables, field.name)
        if isinstance(one, np.ndarray):
            assert _same(one, other), field.name
    assert tables.attributes == store.attributes
    assert len(tables.setups) == len(store.setups)
    for one, other in zip(store.setups, tables.setups, strict=True):
        assert all(_same(getattr(one, k), getattr(other, k)) for k in ("points", "normals", "level_depth"))
        assert (one.rod_radius, one.rod_edge) == (other.rod_radius, other.rod_edge)
    assert (store.clock is None) == (tables.clock is None)
    if store.clock is not None and tables.clock is not None:
        assert all(_same(v, getattr(tables.clock, k)) for k, v in vars(store.clock).items())
    assert (store.has_fields, tables.has_fields) == (True, False)
    assert tables.address == store.address  # wherever one stands
    monkeypatch.chdir(tmp_path)
    assert replace(tables, location="s.zarr").address == "s.zarr"


def test_fields_are_asked_of_the_dataset(store: Path, tmp_path: Path) -> None:
    (tmp_path / TABLES).write_bytes(tables_bytes(open_store(store)))
    tables = load_tables(tmp_path / TABLES)
    for ask in (lambda: tables.displacement(slice(0, 1)), lambda: tables.surface(0), lambda: tables.shard):
        with pytest.raises(InputError, match=r"only the tables are here.*--dataset"):
            ask()


def test_a_run_predicts_without_its_dataset(run: Path, alone: Path) -> None:
    before, after = learn.load(run), learn.load(alone)
    assert before.store.has_fields
    assert not after.store.has_fields
    assert "tables alone" in repr(after)
    one, other = before.predict(POKE), after.predict(POKE)
    assert np.array_equal(one.displacement, other.displacement)
    assert one.force == other.force
    assert one.inside == other.inside
    split, same = (split_of_run(p.store, p.run) for p in (before, after))
    assert np.array_equal(split.test, same.test)
    # but it is not evaluated, nor does it name a dataset that is stated and not there
    refused(call(app, "evaluate", alone), "gone.zarr: no dataset there", "if it has moved, --dataset states")
    with pytest.raises(InputError, match=r"other.zarr: no dataset there"):
        learn.load(alone, dataset="other.zarr")


def test_another_dataset_in_its_place_is_not_taken(alone: Path) -> None:
    other = write_store(alone.parent / "gone.zarr", shapes=2, sites=2, frames=2, seed=9)
    predictor = learn.load(alone)
    assert predictor.store.uuid == predictor.run.uuid != open_store(other).uuid
    assert not predictor.store.has_fields


def test_a_run_of_before_has_none(alone: Path) -> None:
    (alone / TABLES).unlink()
    with pytest.raises(InputError, match=r"gone.zarr: no dataset there.*if it has moved, --dataset states"):
        learn.load(alone)
    assert load_run(alone).folder == alone


def _without(name: str) -> Callable[[Path], None]:
    def change(path: Path) -> None:
        with np.load(path) as file:
            kept = {key: file[key] for key in file.files if key != name}
        buffer = io.BytesIO()
        np.savez(buffer, **kept)
        path.write_bytes(buffer.getvalue())

    return change


def _changed(name: str, change: Callable[[Any], Any]) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        with np.load(path) as file:
            arrays = {key: file[key] for key in file.files}
        buffer = io.BytesIO()
        np.savez(buffer, **{**arrays, name: change(arrays[name])})
        path.write_bytes(buffer.getvalue())

    return write


DAMAGED: dict[str, Callable[[Path], None]] = {
    "cut short": lambda path: path.write_bytes(path.read_bytes()[:5000]),
    "empty": lambda path: path.write_bytes(b""),
    "another file": lambda path: path.write_text("tables"),
    "an array missing": _without("profile"),
    "no description": _without("about"),
    "fewer interiors": _changed("profile", lambda a: a[:1]),
    "fewer levels": _changed("profile", lambda a: a[..., :9]),
    "fewer pokes": _changed("softness", lambda a: a[:1]),
    "text for numbers": _changed("depth", lambda a: a.astype("U8")),
    "a frame of no poke": _changed("frame_poke", lambda a: a + 1000),
    "a block that is not there": _changed("setup_index", lambda a: a + 7),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_damaged_tables_are_refused(alone: Path, damage: str) -> None:
    DAMAGED[damage](alone / TABLES)
    refused(call(app, "predict", alone, "poke.yaml"), f"{TABLES}: not readable as the tables of a dataset")
