"""Recipes and checkpoints from before the names changed are still read, to the same numbers.

data/old-run was written by the code of commit 2968e7c: model "ours-small" trained for two epochs on the
twelve pokes of data/pokes.npz (recipe keys rate, average, pool, thin), and what that code predicted with it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
import torch

import learn
import learn.export
import learn.predict
from learn.data import MemoryDataset, open_store
from learn.errors import InputError
from learn.models import make_model, pokes_of, scene_of
from learn.training import Recipe, Trainer, load_recipe, load_run
from learn.training.recipe import OLD_KEYS
from learn.training.run_folder import load_checkpoint, save_checkpoint
from tests.learn.real_store import write_real_store
from tests.learn.small_store import write_store

OLD_RUN = Path(__file__).parent / "data" / "old-run"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_real_store(tmp_path_factory.mktemp("old") / "s.zarr")


def test_an_old_checkpoint_predicts_what_it_did(store: Path) -> None:
    run, opened = load_run(OLD_RUN), open_store(store)
    assert run.recipe.model == "invariant-gnn-small"
    assert (run.recipe.learning_rate, run.recipe.ema_decay) == (2e-3, 0.9)
    assert (run.recipe.shuffle_buffer, run.recipe.point_dropout, run.recipe.point_jitter) == (4, 0.5, 0.0)
    with np.load(OLD_RUN / "expected.npz") as file:
        rows, displacement, force = file["rows"], file["displacement"], file["force"]
    batch = MemoryDataset(opened, rows).__getitems__(np.arange(len(rows)))
    with torch.no_grad():
        found = run.model(scene_of(opened), pokes_of(batch))
    np.testing.assert_allclose(found.displacement[:, ::32].numpy(), displacement, atol=1e-8)
    np.testing.assert_allclose(found.force.numpy(), force, rtol=1e-5)


def test_an_old_run_says_what_it_was_trained_on(store: Path) -> None:
    """Its checkpoint has no domain of validity: it is derived from the dataset."""
    predictor = learn.load(OLD_RUN, dataset=store)
    assert predictor.run.domain is None
    assert predictor.domain is not None
    softness = predictor.store.softness_names[0]
    deep = {"site_mm": [0, 0], "depth_mm": 14, "shape": predictor.store.shapes[0], "softness": softness}
    assert "depth_mm" in {check.key for check in predictor.predict(deep).outside}


def test_old_recipe_keys_and_names(tmp_path: Path) -> None:
    file = tmp_path / "r.yaml"
    file.write_text("model: ours\nrate: 1e-3\naverage: 0.5\npool: 2\nthin: 0.25\n")
    recipe = load_recipe(str(file))
    assert recipe.model == "invariant-gnn"
    values = (recipe.learning_rate, recipe.ema_decay, recipe.shuffle_buffer, recipe.point_dropout)
    assert values == (1e-3, 0.5, 2, 0.25)
    assert not set(OLD_KEYS) & set(recipe.model_dump())


def test_old_model_names_make_the_models() -> None:
    statistics = load_run(OLD_RUN).statistics
    sizes = [
        sum(p.numel() for p in make_model(name, statistics).parameters())
        for name in ("ours", "invariant-gnn")
    ]
    assert sizes == [82774, 82774]
    with pytest.raises(InputError, match="expected one of"):
        make_model("theirs", statistics)


def test_an_old_run_is_resumed(tmp_path: Path) -> None:
    """last.pt with the old keys: training goes on to the same weights."""
    opened = open_store(write_store(tmp_path / "s.zarr", sites=2, frames=2))
    recipe = Recipe(name="tiny", model="invariant-gnn-small", epochs=2, batch=8, ema_decay=0.9)
    Trainer(opened, recipe, tmp_path / "whole").train()
    stopped = Trainer(opened, recipe, tmp_path / "parts", on_progress=_stop_after_one)
    with pytest.raises(KeyboardInterrupt):
        stopped.train()
    path = tmp_path / "parts" / "last.pt"
    content = load_checkpoint(path)
    new_keys = {new: old for old, new in OLD_KEYS.items()}
    old = {new_keys.get(key, key): value for key, value in content["recipe"].items() if key != "point_jitter"}
    del content["domain"]
    save_checkpoint(path, {**content, "recipe": {**old, "model": "ours-small"}})
    Trainer(opened, recipe, tmp_path / "parts", resume=True).train()
    one, other = (load_checkpoint(tmp_path / name / "last.pt")["model"] for name in ("whole", "parts"))
    assert all(torch.equal(one[key], other[key]) for key in one)


def _stop_after_one(progress: object) -> None:
    if getattr(progress, "values", None) is not None:
        raise KeyboardInterrupt


def test_a_copy_of_an_old_run_without_its_dataset(tmp_path: Path) -> None:
    run = Path(shutil.copytree(OLD_RUN, tmp_path / "run"))
    with pytest.raises(InputError, match="no dataset there"):
        learn.load(run)
