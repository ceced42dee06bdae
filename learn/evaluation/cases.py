"""A model's answers to the frames of one part, beside the truth."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import Batch, MemoryDataset, Store
from learn.metrics import Cases, join_cases
from learn.models import Pokes, Prediction, Scene, pokes_of


class Answers(Protocol):
    """Whatever answers pokes: `learn.models.Model` and `learn.baselines.Baseline`."""

    def prepare(self, scene: Scene) -> Any: ...

    def encode(self, scene: Scene, prepared: Any = None) -> Any: ...

    def decode(self, encoded: Any, pokes: Pokes) -> Prediction: ...


def cases_of(model: Answers, scene: Scene, data: MemoryDataset, *, batch: int = 64) -> Cases:
    """All frames of a part, answered; scene: of the store's grid."""
    return collect(model, scene, data.store, data.batches(batch))


@torch.no_grad()
def collect(model: Answers, scene: Scene, store: Store, batches: Iterable[Batch]) -> Cases:
    """The cases of these batches."""
    parts: list[Cases] = []
    encoded: Any = None
    points = scene.points.numpy()
    for batch in batches:
        if encoded is None:
            encoded = model.encode(scene, model.prepare(scene))
        found = model.decode(encoded, pokes_of(batch))
        away = np.linalg.norm(points[None] - batch.start.numpy()[:, None], axis=2)
        poke = store.frame_poke[batch.frame.numpy()]
        parts.append(
            Cases(
                truth=batch.displacement.numpy(),
                predicted=found.displacement.float().numpy(),
                force=batch.force.double().numpy(),
                force_predicted=found.force.double().numpy(),
                away=away,
                depth=batch.depth.numpy(),
                poke=poke,
                softness=np.array(store.softness_names)[store.softness[poke]],
                spread=_or_zero(found.spread, away.shape),
                force_spread=_or_zero(found.force_spread, poke.shape),
            )
        )
    return join_cases(parts)


def _or_zero(spread: torch.Tensor | None, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """The spread, zero of a single model."""
    return np.zeros(shape) if spread is None else spread.double().numpy()
