"""The networks that come with the package are read by this version, are complete, and can be adapted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from learn.cli import app
from learn.data import MemoryDataset, open_store
from learn.errors import InputError
from learn.evaluation import load_intervals, predict_part, summarise
from learn.models import Scenes
from learn.pretrained import folder_of, names
from learn.training import load_run, open_dataset
from tests.learn.commands import call, refused
from tests.learn.real_store import write_real_store
from tests.learn.small_store import write_store


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


def test_one_is_adapted_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    body = write_store(tmp_path / "b.zarr", shapes=1, softness=("S1",), sites=3, frames=2)
    done = call(app, "adapt", "covers", body, "--epochs", 1, "--threads", 1)
    assert done.exit_code == 0, done.output
    assert load_run(tmp_path / "runs" / "adapted").pretrained is not None
    refused(
        call(app, "adapt", "cover", body, "--out", "other"),
        "cover: no such folder, expected that of a run, or one of covers",
    )


def test_a_folder_of_the_name_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "covers").mkdir()
    assert folder_of("covers") == Path("covers")
