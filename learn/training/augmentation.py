"""Augmentation of training batches: dropped and jittered points, so that other clouds than the grid are seen.

What is drawn is a function of the recipe's seed and the step alone, so that a resumed run repeats it.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import Batch, Store
from learn.data.clouds import SurfaceField, jittered
from learn.models import Scene, Scenes
from learn.models.scene import over_same_columns
from learn.training.recipe import Recipe

_DROPOUT, _JITTER = 1, 2  # streams of random numbers
_FEWEST = 0.4  # least fraction of the points under point dropout

Parts = list[tuple[Scene, Any, Batch]]  # of a batch, by scene: scene, its prepared quantities, frames


class Augmentation:
    """Random augmentation by the recipe's `point_dropout` and `point_jitter`.

    Parameters
    ----------
    rows : frames of the training part.
    scenes : the dataset's scenes, on the device of training.
    prepared : prepared quantities of each scene.
    prepare : `Model.prepare`, for other points than a scene's.

    Attributes
    ----------
    surfaces : displacements of the training part between the grid's points; None without jitter.
    """

    def __init__(
        self,
        store: Store,
        recipe: Recipe,
        rows: NDArray[np.int64],
        *,
        scenes: Scenes,
        prepared: Sequence[Any],
        prepare: Callable[[Scene], Any],
    ) -> None:
        self._setups, self._recipe = store.setups, recipe
        self._scenes, self._prepared, self._prepare = scenes, prepared, prepare
        pokes = np.unique(store.frame_poke[rows]).tolist()
        self.surfaces = SurfaceField(store, pokes) if recipe.point_jitter else None

    def each(
        self, batches: Iterable[Batch], first_step: int, *, ahead: int = 0
    ) -> Iterator[tuple[int, Parts]]:
        """Number of frames and augmented parts of each batch, in order.

        `ahead` batches are augmented in advance, by another thread.
        """
        steps = itertools.count(first_step)
        if not ahead:
            for batch in batches:
                yield len(batch), self(batch, next(steps))
            return
        waiting: deque[tuple[int, Future[Parts]]] = deque()
        with ThreadPoolExecutor(1) as worker:
            for batch in batches:
                waiting.append((len(batch), worker.submit(self, batch, next(steps))))
                if len(waiting) > ahead:
                    frames, parts = waiting.popleft()
                    yield frames, parts.result()
            for frames, parts in waiting:
                yield frames, parts.result()

    def __call__(self, batch: Batch, step: int) -> Parts:
        """The parts of a batch by scene, on the scenes' device, augmented."""
        found = self._scenes.parts(batch.to(self._scenes.device))
        return [self._augmented(k, part, step) for k, _, part in found]

    def _augmented(self, k: int, batch: Batch, step: int) -> tuple[Scene, Any, Batch]:
        scene, prepared, recipe = self._scenes.scenes[k], self._prepared[k], self._recipe
        device, moved = batch.displacement.device, False
        if (
            device.type == "cpu"
        ):  # other interiors would be encoded in vain; a GPU would have to be waited for
            scene, index = scene.over(batch.geometry)
            batch = replace(batch, geometry=index)
        jitter = self._random(_JITTER, step)
        if self.surfaces is not None and jitter.uniform() < recipe.point_jitter:
            points = jittered(self._setups[k], jitter)
            scene = over_same_columns(scene, self._setups[k], points)
            there = torch.from_numpy(self.surfaces.displacement(batch.frame.cpu().numpy(), points))
            batch, moved = replace(batch, displacement=there.to(device)), True
        dropout = self._random(_DROPOUT, step)
        if dropout.uniform() < recipe.point_dropout:
            n = len(scene.points)
            some = np.sort(dropout.choice(n, int(n * dropout.uniform(_FEWEST, 1)), replace=False))
            scene = scene.at(some)
            kept = torch.from_numpy(some).to(device)
            batch, moved = replace(batch, displacement=batch.displacement[:, kept]), True
        if moved:
            prepared = self._prepare(scene)
        return scene, prepared, batch

    def _random(self, stream: int, step: int) -> np.random.Generator:
        key = np.random.SeedSequence(entropy=self._recipe.seed, spawn_key=(stream, step))
        return np.random.default_rng(key)
