"""Points between those of the grid: their displacements, and training on them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from learn.data import MemoryDataset, Store, open_store
from learn.data._format import RIGID
from learn.data.clouds import SurfaceField, areas, jittered, nearest_columns, scattered
from learn.training import RECIPES, Recipe, Trainer
from tests.learn.small_store import field, write_store


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    torch.set_num_threads(1)
    return open_store(write_store(tmp_path_factory.mktemp("clouds") / "s.zarr", sites=2, frames=2))


def test_points_move_within_their_cells_and_the_grid(store: Store) -> None:
    random = np.random.default_rng(0)
    cell = 0.1 / 32
    nearest = []
    for _ in range(40):
        points = jittered(store.setup, random)
        moved = points - store.setup.points
        assert np.abs(moved[:, :2]).max() <= cell / 2 + 1e-12
        assert (moved[:, 2] == 0).all()
        assert np.abs(points[:, :2]).max() <= np.abs(store.setup.points[:, :2]).max() + 1e-12
        np.testing.assert_array_equal(nearest_columns(store.setup, points), np.arange(len(points)))
        nearest.append(np.linalg.norm(points - store.path_start[0], axis=1).min())
    grid = np.linalg.norm(store.setup.points - store.path_start[0], axis=1).min()
    # some draws are nearer to the centre of contact than any grid point
    assert min(nearest) < 0.5e-3 < grid


def test_nearest_columns_are_the_nearest(store: Store) -> None:
    points = scattered(store.setup, 200, seed=3)
    distance = np.linalg.norm(points[:, None] - store.setup.points[None], axis=2)
    np.testing.assert_array_equal(nearest_columns(store.setup, points), distance.argmin(axis=1))


def test_the_surface_mesh_gives_the_field_between_its_nodes(store: Store) -> None:
    """Displacements are exact at the nodes, and accurate to linear interpolation between them."""
    rows = np.array([1, 6, 7])
    surfaces = SurfaceField(store, np.unique(store.frame_poke[rows]).tolist())
    exact = MemoryDataset(store, rows).__getitems__(np.arange(3)).displacement.numpy()
    np.testing.assert_allclose(surfaces.displacement(rows, store.setup.points), exact, atol=1e-9)
    points = jittered(store.setup, np.random.default_rng(0))
    found = surfaces.displacement(rows, points)
    for k, row in enumerate(rows):
        poke = store.frame_poke[row]
        soft = ~(store.profile[store.geometry[poke]] == 255).any(axis=1)
        far = soft & (np.linalg.norm(points - store.path_start[poke], axis=1) > 15e-3)
        where = (store.path_start[poke], store.direction[poke], store.depth[row], np.ones(len(points)))
        truth = field(points, *where)
        inner = far & (found[k] != 0).any(axis=1)
        share = np.abs(found[k][inner] - truth[inner]).mean() / np.abs(truth[inner]).mean()
        assert share < 0.2


def test_a_jittered_batch_has_the_displacement_of_its_own_points(store: Store, tmp_path: Path) -> None:
    recipe = Recipe(name="tiny", batch=4, point_jitter=1.0, point_dropout=0.0)
    trainer = Trainer(store, recipe, tmp_path / "run")
    batch = next(iter(trainer._batches()))
    augmentation = trainer.augmentation
    [(scene, _, moved)] = augmentation(batch, 0)
    points = scene.points.numpy()
    assert np.abs(points - store.setup.points)[:, :2].max() > 1e-3
    assert augmentation.surfaces is not None
    expected = augmentation.surfaces.displacement(batch.frame.numpy(), points)
    np.testing.assert_array_equal(moved.displacement.numpy(), expected)
    columns = nearest_columns(store.setup, points)
    np.testing.assert_array_equal(
        scene.rigid.numpy()[scene.rigid_index[moved.geometry]],
        store.profile[store.geometry[store.frame_poke[batch.frame.numpy()]]][:, columns] == RIGID,
    )
    np.testing.assert_allclose(scene.area.numpy(), areas(points))
    [(again, _, _)] = augmentation(batch, 0)
    np.testing.assert_array_equal(again.points.numpy(), points)  # depends on seed and step only
    plain = Trainer(store, recipe.model_copy(update={"point_jitter": 0.0}), tmp_path / "plain")
    [(same, _, _)] = plain.augmentation(batch, 0)
    np.testing.assert_array_equal(same.points.numpy(), store.setup.points)


def test_the_recipe_for_few_pokes_trains_between_the_grid_points() -> None:
    assert RECIPES["quick"].point_jitter > 0
