"""What every model here offers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from torch import nn

from learn.data.batch import Batch
from learn.models.scene import Pokes, Prediction, Scene


class Model(nn.Module):
    """A network that answers pokes in three steps, each of which is kept as long as what it saw stays."""

    def warm_start(self, batches: Iterable[Batch], scene: Scene) -> None:
        """Fits, before training, what is not trained; batches: some of the training part."""

    def prepare(self, scene: Scene) -> Any:  # noqa: ARG002 - not every model has something to prepare
        """What depends on the points alone, neither on weights nor on interiors."""
        return None

    def encode(self, scene: Scene, prepared: Any = None) -> Any:
        """What does not depend on the poke."""
        raise NotImplementedError

    def decode(self, encoded: Any, pokes: Pokes) -> Prediction:
        """Displacement and force of b pokes."""
        raise NotImplementedError

    def forward(self, scene: Scene, pokes: Pokes) -> Prediction:
        """All three."""
        return self.decode(self.encode(scene, self.prepare(scene)), pokes)
