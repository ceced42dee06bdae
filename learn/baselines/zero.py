"""Nothing moves; the force is the training part's mean."""

from __future__ import annotations

import numpy as np

from learn.baselines._baseline import Baseline, prediction
from learn.data import MemoryDataset
from learn.models import Pokes, Prediction, Scene


class Zero(Baseline):
    def fit(self, data: MemoryDataset, scene: Scene) -> None:  # noqa: ARG002
        self.force = float(np.mean([float(b.force.mean()) for b in data.batches(1)]))

    def answer(self, scene: Scene, pokes: Pokes) -> Prediction:
        b = len(pokes.depth)
        return prediction(np.zeros((b, len(scene.points), 3)), np.full(b, self.force))
