"""Which pokes a run is tested on: those of shapes or contact points that it has not seen, in any dataset."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import zarr

from learn.data import Store, contact_points, open_store, split_of
from learn.errors import InputError
from learn.evaluation import evaluate, parts_of
from learn.evaluation.report import cautions
from learn.training import load_run
from tests.learn.small_store import write_store


def test_a_run_whose_dataset_is_now_divided_otherwise_is_refused(store: Path, run: Path) -> None:
    """A store that was a part of what it is now: shapes that the run has seen would count as unseen."""
    loaded, data = load_run(run), open_store(store)
    parts = parts_of(data, loaded)
    assert parts.groups == loaded.groups
    moved = {**loaded.groups, "train": loaded.groups["test"], "test": loaded.groups["train"]}
    with pytest.raises(InputError, match=r"was trained on other shapes of .*: train it again"):
        parts_of(data, replace(loaded, groups=moved))


def _renamed(folder: Path) -> Store:
    """The dataset with other names of its shapes, as another recipe may give them."""
    zarr.open_group(folder, mode="r+").attrs.update(uuid="renamed", shapes=["round-1", "round-2", "round-3"])
    return open_store(folder)


@pytest.mark.usefixtures("few_motions")
def test_shapes_of_another_dataset_are_told_by_what_they_are(run: Path, store: Path, tmp_path: Path) -> None:
    """Drawn shapes of one name differ, and one shape has different names; by name where the rest is gone."""
    loaded, own = load_run(run), open_store(store)
    trained = {*loaded.groups["train"], *loaded.groups["validation"]}
    renamed = _renamed(write_store(tmp_path / "twin.zarr", sites=2, frames=3))
    parts = parts_of(renamed, loaded)
    assert parts.groups["test"] == [renamed.shapes[own.shapes.index(n)] for n in loaded.groups["test"]]
    drawn = open_store(write_store(tmp_path / "drawn.zarr", seed=7))
    assert set(parts_of(drawn, loaded).groups["test"]) == set(drawn.shapes) > trained
    away = replace(loaded, location=str(tmp_path / "gone.zarr"))
    assert set(parts_of(drawn, away).groups["test"]) == set(loaded.groups["test"])
    found = evaluate([away], drawn, baselines=False, clouds=False)
    assert found.by_name == [str(run)]
    assert any("identified by their names" in sentence for sentence in cautions(found))
    assert not evaluate([loaded], drawn, baselines=False, clouds=False).by_name


def test_a_run_split_by_site_is_tested_elsewhere_on_contact_points_that_it_has_not_seen(
    run: Path, tmp_path: Path
) -> None:
    """Two laws of one recipe have the same contact points."""
    store = open_store(write_store(tmp_path / "a.zarr", sites=2))
    recipe = load_run(run).recipe.model_copy(update={"split": "site"})
    split = split_of(store, recipe)
    trained = np.unique(store.frame_poke[np.concatenate([split.train, split.validation])])
    by_site = replace(
        load_run(run),
        recipe=recipe,
        groups=split.groups,
        seen=frozenset(contact_points(store, trained).tolist()),
    )
    # told by interior and place where its own dataset is there, else by the keys that it was saved with
    there = replace(by_site, uuid=store.uuid, location=store.address)
    other = _renamed(write_store(tmp_path / "b.zarr", sites=2))
    found = np.unique(other.frame_poke[parts_of(other, there).test])
    np.testing.assert_array_equal(found, np.unique(store.frame_poke[split.test]))
    by_site = replace(by_site, uuid="of another law")
    tested = np.unique(store.frame_poke[parts_of(store, by_site).test])
    np.testing.assert_array_equal(tested, np.unique(store.frame_poke[split.test]))
    everything = contact_points(store, np.arange(store.pokes)).tolist()
    with pytest.raises(InputError, match="trained on all its sites"):
        parts_of(store, replace(by_site, seen=frozenset(everything)))
    with pytest.raises(InputError, match="does not say which contact points it was trained on"):
        parts_of(store, replace(by_site, seen=frozenset()))
    # of its own dataset, when that has changed under the same groups
    with pytest.raises(InputError, match="train it again"):
        parts_of(store, replace(by_site, uuid=store.uuid, seen=frozenset(everything)))
