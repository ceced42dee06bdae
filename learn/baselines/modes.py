"""Principal modes of the displacement over depth, their coefficients from a small network."""

from __future__ import annotations

import numpy as np
import torch
from torch import nn

from learn.baselines._baseline import Baseline, Floats, describe, force_unit, prediction
from learn.data import MemoryDataset
from learn.models import Pokes, Prediction, Scene, pokes_of

MODES = 64
_STEPS, _RATE, _BATCH = 3000, 2e-3, 128


class Modes(Baseline):
    """PCA and MLP."""

    def fit(self, data: MemoryDataset, scene: Scene) -> None:
        batch = data.__getitems__(np.arange(len(data)))
        pokes = pokes_of(batch)
        fields = batch.displacement.numpy().reshape(len(data), -1) / pokes.depth.numpy()[:, None].astype("f4")
        self.mean = fields.mean(axis=0)
        _, _, modes = np.linalg.svd(fields - self.mean, full_matrices=False)
        self.modes = modes[: min(MODES, len(modes))]
        wanted = (fields - self.mean) @ self.modes.T
        self.unit = wanted.std(axis=0).max() + 1e-12
        log_force = np.log(batch.force.numpy() / force_unit(scene, pokes))
        self.log_force = float(log_force.mean())
        x = torch.from_numpy(self._inputs(scene, pokes)).float()
        y = np.column_stack([wanted / self.unit, (log_force - self.log_force) * 0.3])
        self._train(x, torch.from_numpy(y).float())

    def _train(self, x: torch.Tensor, y: torch.Tensor) -> None:
        with torch.random.fork_rng():
            torch.manual_seed(0)
            self.net = nn.Sequential(
                nn.Linear(x.shape[1], 128),
                nn.SiLU(),
                nn.Linear(128, 128),
                nn.SiLU(),
                nn.Linear(128, y.shape[1]),
            )
            optimiser = torch.optim.AdamW(self.net.parameters(), lr=_RATE, weight_decay=0.05)
            schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, _STEPS)
            for _ in range(_STEPS):
                pick = torch.randint(len(x), (min(_BATCH, len(x)),))
                loss = (self.net(x[pick]) - y[pick]).square().sum(dim=1).mean()
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
                schedule.step()

    def answer(self, scene: Scene, pokes: Pokes) -> Prediction:
        with torch.no_grad():
            out = self.net(torch.from_numpy(self._inputs(scene, pokes)).float()).numpy()
        field = (out[:, :-1] * self.unit) @ self.modes + self.mean
        force = np.exp(out[:, -1] / 0.3 + self.log_force) * force_unit(scene, pokes)
        return prediction(field.reshape(len(out), -1, 3) * pokes.depth.numpy()[:, None, None], force)

    def _inputs(self, scene: Scene, pokes: Pokes) -> Floats:
        return np.column_stack(
            [describe(scene, pokes), pokes.depth.numpy() / 5e-3, np.log(pokes.modulus.numpy()) - 9.7]
        )
