"""What every baseline offers, and what they share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import MemoryDataset
from learn.models import Pokes, Prediction, Scene

Floats = NDArray[np.float64]


class Baseline(ABC):
    """Fitted to a training part, then asked like a model (on the scene it was fitted on)."""

    @abstractmethod
    def fit(self, data: MemoryDataset, scene: Scene) -> None:
        """Learns what it can from the training part."""

    @abstractmethod
    def answer(self, scene: Scene, pokes: Pokes) -> Prediction:
        """Displacement and force of b pokes."""

    def prepare(self, scene: Scene) -> Any:  # noqa: ARG002
        return None

    def encode(self, scene: Scene, prepared: Any = None) -> Scene:  # noqa: ARG002
        return scene

    def decode(self, encoded: Scene, pokes: Pokes) -> Prediction:
        return self.answer(encoded, pokes)


def describe(scene: Scene, pokes: Pokes) -> Floats:
    """A poke in numbers of about unit size: first touch, direction, soft tissue below it, coarse map of the
    interior (4 x 4 shares of rigid columns); (b, 3 + 3 + 1 + 16). For grids of rows and columns."""
    start = pokes.start.numpy()
    clear = torch.cumprod(1 - scene.rigid, dim=2).mean(dim=2)  # (k, n)
    inclusion = scene.rigid_index[pokes.geometry]
    near = torch.cdist(pokes.start, scene.points).argmin(dim=1)
    side = round(len(scene.points) ** 0.5)
    maps = (1 - clear).reshape(-1, 1, side, side)
    coarse = torch.nn.functional.adaptive_avg_pool2d(maps, 4).reshape(len(maps), 16)
    return np.column_stack(
        [
            (start - scene.points.mean(dim=0).numpy()) / 0.02,
            pokes.direction.numpy() / 0.5,
            clear[inclusion, near].numpy() / 0.3,
            coarse[inclusion].numpy() / 0.3,
        ]
    )


def force_unit(scene: Scene, pokes: Pokes) -> Floats:
    """Shear modulus x rod radius x depth [N]: what forces are measured in."""
    return np.asarray(pokes.modulus.numpy() * scene.rod_radius * pokes.depth.numpy())


def prediction(displacement: NDArray[np.floating[Any]], force: NDArray[np.floating[Any]]) -> Prediction:
    """From numpy."""
    return Prediction(
        displacement=torch.from_numpy(np.ascontiguousarray(displacement, dtype=np.float32)),
        force=torch.from_numpy(np.ascontiguousarray(force, dtype=np.float32)),
    )
