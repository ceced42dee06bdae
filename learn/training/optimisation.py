"""One step of training after another: gradients, the learning rate's schedule, the average of the weights."""

from __future__ import annotations

import contextlib
import copy
import math

import torch
from torch import nn

from learn.data import Statistics
from learn.models import Model, pokes_of
from learn.training.augmentation import Parts
from learn.training.optimisers import make_optimiser
from learn.training.process_group import ProcessGroup
from learn.training.recipe import Loss, Recipe, loss_of

_FLOOR = 0.01  # fraction of the learning rate at the end of a cosine


class Optimisation:
    """A model under training.

    Parameters
    ----------
    model : the network, on the group's device.
    recipe : optimiser, learning rate and losses.
    statistics : of the training part, for the loss.
    group : this process among those of torchrun.

    Attributes
    ----------
    ema : moving average of the weights, the network that is kept.
    optimiser : the recipe's optimiser of the network's parameters.
    step : steps done.
    """

    def __init__(self, model: Model, recipe: Recipe, statistics: Statistics, group: ProcessGroup) -> None:
        self.model, self._recipe, self._statistics, self._group = model, recipe, statistics, group
        self.ema = copy.deepcopy(model).requires_grad_(False)
        self.optimiser = make_optimiser(model, recipe)
        self.step = 0

    def update(self, parts: Parts, done: float) -> Loss:
        """One step on a batch, in parts of one scene each; `done` is the fraction of the training so far."""
        for group in self.optimiser.param_groups:
            group["lr"] = learning_rate(self._recipe, done)
        mixed = self._recipe.mixed_precision and self._group.device.type == "cuda"
        found = []
        for scene, prepared, part in parts:
            with torch.autocast("cuda", torch.bfloat16) if mixed else contextlib.nullcontext():
                prediction = self.model.decode(self.model.encode(scene, prepared), pokes_of(part))
            found.append((prediction, part, scene))
        loss = loss_of(found, self._recipe, self._statistics)
        self.optimiser.zero_grad(set_to_none=True)
        loss.total.backward()
        self._group.average_gradients(self.model)
        if self._recipe.clip:
            nn.utils.clip_grad_norm_(self.model.parameters(), self._recipe.clip)
        self.optimiser.step()
        self.step += 1
        self._average()
        return loss

    @torch.no_grad()
    def _average(self) -> None:
        most = self._recipe.ema_decay
        decay = min(most, (1 + self.step) / (10 + self.step)) if most else 0.0
        # all parameters in one call: on a GPU one launch for some sixty
        torch._foreach_lerp_(list(self.ema.parameters()), list(self.model.parameters()), 1 - decay)


def learning_rate(recipe: Recipe, done: float) -> float:
    """Rate at the fraction `done` of the training: warm-up, then constant or a cosine."""
    if done < recipe.warmup:
        return recipe.learning_rate * max(done / recipe.warmup, _FLOOR)
    if recipe.schedule == "constant":
        return recipe.learning_rate
    turn = (done - recipe.warmup) / (1 - recipe.warmup)
    return recipe.learning_rate * (_FLOOR + (1 - _FLOOR) * 0.5 * (1 + math.cos(math.pi * turn)))
