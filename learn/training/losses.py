"""What training minimises."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from learn.data.batch import Batch
from learn.data.statistics import Statistics
from learn.models.scene import Prediction, Scene
from learn.training.recipe import Recipe

_SMOOTH = 1e-3  # mm: a distance below it counts as its square
_LEAST = 1e-6  # N, of a predicted force under the logarithm


@dataclass(frozen=True)
class Loss:
    """total = displacement [mm, weighted mean distance] + force_weight x force; means over the batch."""

    total: Tensor
    displacement: Tensor
    force: Tensor


def loss_of(
    prediction: Prediction, batch: Batch, scene: Scene, recipe: Recipe, statistics: Statistics
) -> Loss:
    """The recipe's loss of a batch."""
    wrong = (prediction.displacement.float() - batch.displacement) * 1e3
    distance = torch.sqrt(wrong.square().sum(dim=2) + _SMOOTH**2) - _SMOOTH
    away = (scene.points[None] - batch.start[:, None]).square().sum(dim=2).float()
    weight = 1 + recipe.near_weight * torch.exp(-0.5e6 * away / recipe.near_width_mm**2)
    weight = weight * batch.depth[:, None].float() ** -recipe.depth_power
    displacement = (weight * distance).sum() / weight.sum()
    force = prediction.force.float()
    if recipe.force_loss == "log":
        wrong_force = torch.log(force.clamp_min(_LEAST) / batch.force).abs().mean()
    else:
        wrong_force = ((force - batch.force) / statistics.force_rms).square().mean()
    return Loss(displacement + recipe.force_weight * wrong_force, displacement, wrong_force)
