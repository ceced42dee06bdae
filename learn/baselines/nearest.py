"""The most similar training poke at the most similar depth, scaled by depth and modulus."""

from __future__ import annotations

import numpy as np

from learn.baselines._baseline import Baseline, describe, force_unit, prediction
from learn.data import MemoryDataset
from learn.models import Pokes, Prediction, Scene, pokes_of

_DEPTH = 2e-3  # m of depth count as much as a unit of `describe`


class Nearest(Baseline):
    def fit(self, data: MemoryDataset, scene: Scene) -> None:
        batch = data.__getitems__(np.arange(len(data)))
        pokes = pokes_of(batch)
        self.features = np.column_stack([describe(scene, pokes)[:, :7], pokes.depth.numpy() / _DEPTH])
        self.field = batch.displacement.numpy() / pokes.depth.numpy()[:, None, None].astype(np.float32)
        self.force = batch.force.numpy() / force_unit(scene, pokes)

    def answer(self, scene: Scene, pokes: Pokes) -> Prediction:
        mine = np.column_stack([describe(scene, pokes)[:, :7], pokes.depth.numpy() / _DEPTH])
        best = ((mine[:, None] - self.features[None]) ** 2).sum(axis=2).argmin(axis=1)
        field = self.field[best] * pokes.depth.numpy()[:, None, None]
        return prediction(field, self.force[best] * force_unit(scene, pokes))
