"""The baselines behave as their names state."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

import learn.baselines
from learn.baselines import BASELINES, Baseline
from learn.data import MemoryDataset, Store, open_store, split_pokes
from learn.evaluation import Value, predict_part, summarise, symmetry_error
from learn.models import Scenes, pokes_of
from tests.learn.small_store import write_store


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    torch.set_num_threads(1)
    folder: Path = tmp_path_factory.mktemp("baselines")
    return open_store(write_store(folder / "s.zarr", shapes=3, sites=8, frames=2))


@pytest.fixture(scope="module")
def scenes(store: Store) -> Scenes:
    return Scenes.of(store)


@pytest.fixture(scope="module")
def fitted(store: Store, scenes: Scenes) -> dict[str, Baseline]:
    found = {}
    monkeypatch = pytest.MonkeyPatch()
    monkeypatch.setattr(learn.baselines, "_STEPS", 600)
    for name, kind in BASELINES.items():
        found[name] = kind()
        found[name].fit(MemoryDataset(store, split_pokes(store).train), scenes)
    monkeypatch.undo()
    return found


def _on(part: str, store: Store, scenes: Scenes, baseline: Baseline) -> dict[str, Value]:
    data = MemoryDataset(store, getattr(split_pokes(store), part))
    return summarise(predict_part(baseline, scenes, data))


def test_zero_has_no_skill(store: Store, scenes: Scenes, fitted: dict[str, Baseline]) -> None:
    found = _on("test", store, scenes, fitted["zero displacement"])
    assert found["skill"].mean == pytest.approx(0)
    assert found["rel L2"].mean == pytest.approx(1)


def test_nearest_knows_its_own_pokes_by_heart(
    store: Store, scenes: Scenes, fitted: dict[str, Baseline]
) -> None:
    found = _on("train", store, scenes, fitted["nearest training poke"])
    assert found["max"].mean < 1e-4
    assert found["rel force"].mean < 1e-5


def test_modes_learn_the_training_part(store: Store, scenes: Scenes, fitted: dict[str, Baseline]) -> None:
    found = _on("train", store, scenes, fitted["PCA and MLP"])
    assert found["rel L2"].mean < 0.3
    assert found["rel force"].mean < 0.1


def test_kernel_carries_over_to_unseen_shapes(
    store: Store, scenes: Scenes, fitted: dict[str, Baseline]
) -> None:
    found = _on("test", store, scenes, fitted["analytic kernel"])
    assert found["skill"].mean > 0.8
    assert found["rel force"].mean < 0.1


def test_kernel_turns_about_the_vertical(store: Store, scenes: Scenes, fitted: dict[str, Baseline]) -> None:
    pokes = pokes_of(MemoryDataset(store, np.array([2, 17])).__getitems__([0, 1]))
    turned = symmetry_error(fitted["analytic kernel"], scenes, pokes, about_normal=True)
    assert turned.displacement_mm < 1e-4
