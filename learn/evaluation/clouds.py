"""The same pokes on other point clouds: denser, sparser, without a grid; truth from the surface meshes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import KDTree

from learn.data import Batch, Store, make_batch
from learn.errors import InputError
from learn.evaluation.cases import Answers, collect
from learn.metrics import Cases
from learn.models import Scene, make_scene

Floats = NDArray[np.float64]
_TOP = 1e-9  # m from the top plane


def scattered(store: Store, count: int, *, seed: int = 0) -> Floats:
    """Points without a grid on the store's top face, (count, 3) [m]: evenly scattered, each 0.6 spacings or
    more from the next, within the outermost grid points."""
    low, high = store.points[:, :2].min(axis=0), store.points[:, :2].max(axis=0)
    random = np.random.default_rng(seed)
    chosen = random.uniform(low, high, (count, 2))
    spacing = np.sqrt(np.prod(high - low) / count)
    for _ in range(60):  # push too close points apart
        pairs = KDTree(chosen).query_pairs(0.8 * spacing, output_type="ndarray")
        gap = chosen[pairs[:, 0]] - chosen[pairs[:, 1]]
        size = np.linalg.norm(gap, axis=1, keepdims=True)
        push = 0.25 * (0.8 * spacing - size) * gap / np.maximum(size, 1e-12)
        np.add.at(chosen, pairs[:, 0], push)
        np.add.at(chosen, pairs[:, 1], -push)
        chosen = np.clip(chosen, low, high)
    return np.column_stack([chosen, np.full(count, store.points[0, 2])])


def scene_on(store: Store, points: Floats) -> Scene:
    """The store's interiors under other points of its top face: profiles of the nearest grid columns."""
    side = round(len(store.points) ** 0.5)
    low = store.points.min(axis=0)[:2]
    step = (store.points.max(axis=0)[:2] - low) / (side - 1)
    column, row = np.rint(((points[:, :2] - low) / step).T).astype(int)
    index = row * side + column
    return make_scene(
        points=points,
        normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        profile=store.profile[:, index],
        level_depth=store.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.rod_edge,
    )


def cases_on(model: Answers, store: Store, rows: NDArray[np.int64], points: Floats) -> Cases:
    """Answers at other points of the top, against linear interpolation of each poke's own surface mesh."""
    return collect(model, scene_on(store, points), store, _batches(store, rows, points))


def grid_floor_mm(store: Store, rows: NDArray[np.int64]) -> float:
    """Mean distance [mm] of that interpolation from the stored field at the grid's own points."""
    wrong = [
        float((batch.displacement - torch.from_numpy(store.displacement(slice(first, first + len(batch)))))
              .norm(dim=2).mean())
        for batch in _batches(store, rows, store.points)
        for first in [int(batch.frame[0])]
    ]  # fmt: skip
    return float(np.mean(wrong)) * 1e3


def _batches(store: Store, rows: NDArray[np.int64], points: Floats) -> Iterator[Batch]:
    """A batch a poke."""
    for poke in np.unique(store.frame_poke[rows]):
        mine = rows[store.frame_poke[rows] == poke]
        rest, _, moved = store.surface(int(poke))
        top = np.abs(rest[:, 2] - points[0, 2]) < _TOP
        if top.sum() < 4:
            raise InputError(f"{store.location}: the surface of poke {poke} has no nodes on the top face")
        frames = mine - store.frame_start[poke]
        values = moved[frames][:, top].transpose(1, 0, 2)
        field = LinearNDInterpolator(rest[top, :2], values.reshape(len(values), -1))(points[:, :2])
        displacement = field.reshape(len(points), len(mine), 3).transpose(1, 0, 2).astype(np.float32)
        yield make_batch(store, mine, np.ascontiguousarray(displacement))
