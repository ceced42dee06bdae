"""A metric and a model from outside the package, added as the documentation describes.

`--plugin tests/learn/plugin.py` imports it.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import nn

from learn.data import Statistics
from learn.metrics import Floats, Predictions, register_metric
from learn.models import Model, Pokes, Response, Scene, register_model


@register_metric("median", units="mm", text="median over all points of |predicted - true|", digits=4)
def median_distance(predictions: Predictions) -> Floats:
    """Median distance of each frame [mm]."""
    return np.median(predictions.distance_mm, axis=1)


@register_model("decay", version=1)
class Decay(Model):
    """Rod displacement times an exponential of the distance from first contact; two trained parameters."""

    def __init__(self, statistics: Statistics) -> None:
        super().__init__()
        self.log_range = nn.Parameter(torch.tensor(-5.0))
        self.log_force = nn.Parameter(torch.tensor(statistics.log_force_mean))

    def encode(self, scene: Scene, prepared: object = None) -> Scene:  # noqa: ARG002
        return scene

    def decode(self, encoded: Scene, pokes: Pokes) -> Response:
        away = (encoded.points[None] - pokes.start[:, None]).norm(dim=2).float()
        fall = torch.exp(-away / torch.exp(self.log_range))
        u = fall[..., None] * (pokes.depth[:, None] * pokes.direction).float()[:, None]
        unit = (pokes.modulus * pokes.depth).float() * encoded.rod_radius
        return Response(displacement=u, force=unit * torch.exp(self.log_force))
