"""Recipes and checkpoints with old names are still read; weights of an earlier network are refused.

data/old-run was written by the code of commit 2968e7c: model "ours-small" of version 2.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from learn.data import MemoryDataset, open_store, statistics
from learn.errors import InputError
from learn.models import make_model
from learn.training import Recipe, Trainer, load_recipe, load_run
from learn.training.recipe import OLD_KEYS
from learn.training.run_folder import load_checkpoint, save_checkpoint
from tests.learn.small_store import write_store

OLD_RUN = Path(__file__).parent / "data" / "old-run"


def test_an_old_run_is_to_be_trained_again() -> None:
    with pytest.raises(InputError, match="weights of version 2 of model invariant-gnn-small"):
        load_run(OLD_RUN)


def test_old_recipe_keys_and_names(tmp_path: Path) -> None:
    file = tmp_path / "r.yaml"
    file.write_text("model: ours\nrate: 1e-3\naverage: 0.5\npool: 2\nthin: 0.25\n")
    recipe = load_recipe(str(file))
    assert recipe.model == "invariant-gnn"
    values = (recipe.learning_rate, recipe.ema_decay, recipe.shuffle_buffer, recipe.point_dropout)
    assert values == (1e-3, 0.5, 2, 0.25)
    assert not set(OLD_KEYS) & set(recipe.model_dump())


def test_old_model_names_make_the_models(tmp_path: Path) -> None:
    opened = open_store(write_store(tmp_path / "s.zarr", sites=2, frames=2))
    sizes_of = statistics(MemoryDataset(opened, np.arange(opened.frames)).batches(8), opened)
    sizes = [
        sum(p.numel() for p in make_model(name, sizes_of).parameters()) for name in ("ours", "invariant-gnn")
    ]
    assert sizes[0] == sizes[1]
    with pytest.raises(InputError, match="expected one of"):
        make_model("theirs", sizes_of)


def test_an_old_run_is_resumed(tmp_path: Path) -> None:
    """Training from a last.pt with the old keys leads to the same weights."""
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
