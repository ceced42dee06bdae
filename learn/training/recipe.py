"""Training recipes, by name or as a YAML file of the same keys, and the loss that they define."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import torch
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator
from torch import Tensor

from learn._yaml import Finite, first_fault, read_yaml
from learn.data.loaders import Batch
from learn.data.statistics import Statistics
from learn.errors import InputError
from learn.models.base import MODELS, OLD_NAMES
from learn.models.scene import Response, Scene

Positive = Annotated[float, Field(strict=True, gt=0, lt=1e6)]
Fraction = Annotated[float, Field(strict=True, ge=0, lt=1)]
Count = Annotated[int, Field(strict=True, ge=1, le=65536)]

OLD_KEYS = {
    "rate": "learning_rate",
    "average": "ema_decay",
    "pool": "shuffle_buffer",
    "thin": "point_dropout",
}
_SMOOTH = 1e-3  # [mm]: smaller distances count quadratically
_LEAST_RATIO = 0.05  # of a predicted to the true force: below, the logarithm goes on along its tangent


class Recipe(BaseModel):
    """Everything that the weights depend on, except the dataset and the numbers of threads and processes.

    Attributes
    ----------
    name : name of the recipe; part of the default name of a run's folder.
    model : a name of `learn.models.MODELS`.
    split, fold, train_softness, train_depth_mm : see `learn.data.split_pokes`.
    seed : seed of weights, order of frames, point dropout and jitter.
    epochs, batch : passes over the training part; frames per step.
    optimiser : "adam", or "muon" for the matrices of hidden layers with Adam for the other parameters
        (`learn.training.optimisers`).
    learning_rate, schedule, warmup : the optimiser's rate; "cosine" falls to 1 % of it over the epochs;
        warmup is the fraction of all steps over which it rises.
    clip : largest norm of the gradient (0: none).
    ema_decay : decay of the exponential moving average of the weights, which is validated and kept (0: the
        weights themselves).
    near_weight, near_width_mm : a point at distance r from first contact has the weight
        1 + near_weight exp(-r^2 / (2 near_width^2)) in the displacement's loss, a weighted mean distance
        [mm].
    depth_power : a frame has the weight depth^-depth_power in that loss: 0 weights absolute errors, 1 errors
        relative to the depth.
    force_loss, force_weight : "log" is ``|ln(predicted / true)|``, below a ratio of 0.05 along its tangent;
        "square" the squared error over the training part's mean square. The weight is relative to the
        displacement's loss.
    point_dropout : fraction of the batches that have a random 40 to 100 % of the points, for other clouds.
    point_jitter : fraction of the batches in which each point is moved at random within its cell of the grid,
        with the displacement interpolated from the surface meshes. This trains positions that are far from
        the grid points of the few training sites, such as the middle of the contact. Needs data "memory".
    data, shuffle_buffer : frames in memory, or streamed through a buffer of this many shards (files).
    mixed_precision : bfloat16 on a GPU.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: Annotated[str, Field(min_length=1, max_length=60, pattern=r"^[^/\\\x00-\x1f]+$")] = "fast"
    model: str = "invariant-gnn"
    split: Literal["shape", "site"] = "shape"
    fold: Annotated[int, Field(strict=True, ge=0, le=4)] = 0
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**32)] = 0
    train_softness: list[str] | None = None
    train_depth_mm: Positive | None = None
    epochs: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 30
    batch: Count = 16
    optimiser: Literal["adam", "muon"] = "adam"
    learning_rate: Positive = 2e-3
    schedule: Literal["cosine", "constant"] = "cosine"
    warmup: Fraction = 0.03
    clip: Annotated[Finite, Field(ge=0)] = 1.0
    ema_decay: Fraction = 0.998
    near_weight: Annotated[Finite, Field(ge=0, lt=1e4)] = 60.0
    near_width_mm: Positive = 4.0
    depth_power: Annotated[Finite, Field(ge=0, le=2)] = 0.5
    force_loss: Literal["log", "square"] = "log"
    force_weight: Annotated[Finite, Field(ge=0, lt=1e4)] = 0.3
    point_dropout: Fraction = 0.3
    point_jitter: Annotated[Finite, Field(ge=0, le=1)] = 0.0
    data: Literal["memory", "stream"] = "memory"
    shuffle_buffer: Annotated[int, Field(strict=True, ge=1, le=1024)] = 4
    mixed_precision: Annotated[bool, Field(strict=True)] = True

    @model_validator(mode="before")
    @classmethod
    def _old_keys(cls, values: Any) -> Any:
        """Rename the old keys of earlier recipes and checkpoints."""
        if not isinstance(values, dict):
            return values
        for old, new in OLD_KEYS.items():
            if old in values and new in values:
                raise ValueError(f"{old} is the old name of {new}: expected one of the two")
        return {OLD_KEYS.get(key, key) if isinstance(key, str) else key: v for key, v in values.items()}

    @field_validator("model")
    @classmethod
    def _known(cls, name: str) -> str:
        name = OLD_NAMES.get(name, name)
        if name not in MODELS:
            raise ValueError(f"expected one of {', '.join(MODELS)} (--plugin FILE registers others)")
        return name

    @model_validator(mode="after")
    def _jitter_in_memory(self) -> Self:
        if self.point_jitter and self.data != "memory":
            raise ValueError("point_jitter needs data: memory")
        return self


RECIPES: dict[str, Recipe] = {
    # the key's default is the optimiser of recipes and checkpoints from before the key
    "fast": Recipe(optimiser="muon"),
    "quick": Recipe(
        name="quick",
        split="site",
        epochs=50,  # of some six steps: copies of a solve count once
        batch=10,
        ema_decay=0.98,
        near_weight=20.0,
        near_width_mm=6.0,
        depth_power=0.0,
        point_jitter=0.5,
    ),
    # the paper's model trained like the surrogate: at the published learning rate, 200 epochs take a day on
    # one core
    "cegnn": Recipe(name="cegnn", model="cegnn", epochs=20, point_dropout=0.0),
    # Adam 1e-4, batches of 64, 200 epochs, as published; the weights of the loss are not public
    "paper": Recipe(
        name="paper",
        model="cegnn",
        epochs=200,
        batch=64,
        learning_rate=1e-4,
        schedule="constant",
        warmup=0.0,
        clip=0.0,
        ema_decay=0.0,
        near_weight=4.0,
        near_width_mm=10.0,
        depth_power=0.0,
        force_loss="square",
        force_weight=0.1,
        point_dropout=0.0,
    ),
}


def load_recipe(name: str) -> Recipe:
    """Load a recipe by name or from a YAML file; InputError names a wrong key."""
    if name in RECIPES:
        return RECIPES[name]
    path = Path(name)
    if not path.is_file():
        raise InputError(f"recipe {name}: expected {', '.join(RECIPES)} or a YAML file")
    return check_recipe(read_yaml(path), str(path))


def check_recipe(values: object, where: str) -> Recipe:
    """Validate the values of a recipe; `where` begins the text of an InputError."""
    try:
        return Recipe.model_validate(values)
    except ValidationError as error:
        raise InputError(f"{where}: {first_fault(error)}") from None


@dataclass(frozen=True)
class Loss:
    """total = displacement [mm, weighted mean distance] + force_weight x force; means over the batch."""

    total: Tensor
    displacement: Tensor
    force: Tensor


def _log_error(ratio: Tensor) -> Tensor:
    """``|ln(ratio)|``; with a slope, towards the truth, also for forces of 0 or less."""
    far = math.log(_LEAST_RATIO) + (ratio - _LEAST_RATIO) / _LEAST_RATIO
    return torch.where(ratio > _LEAST_RATIO, torch.log(ratio.clamp_min(_LEAST_RATIO)), far).abs()


def loss_of(parts: Iterable[tuple[Response, Batch, Scene]], recipe: Recipe, statistics: Statistics) -> Loss:
    """The recipe's loss for a batch, in parts of one scene each."""
    distances, weights, forces = [], [], []
    for response, batch, scene in parts:
        wrong = (response.displacement.float() - batch.displacement) * 1e3
        distance = torch.sqrt(wrong.square().sum(dim=2) + _SMOOTH**2) - _SMOOTH
        away = (scene.points[None] - batch.start[:, None]).square().sum(dim=2).float()
        weight = 1 + recipe.near_weight * torch.exp(-0.5e6 * away / recipe.near_width_mm**2)
        weight = weight * batch.depth[:, None].float() ** -recipe.depth_power
        distances.append((weight * distance).sum())
        weights.append(weight.sum())
        force = response.force.float()
        if recipe.force_loss == "log":
            forces.append(_log_error(force / batch.force))
        else:
            forces.append(((force - batch.force) / statistics.force_rms).square())
    displacement = torch.stack(distances).sum() / torch.stack(weights).sum()
    wrong_force = torch.cat(forces).mean()
    return Loss(displacement + recipe.force_weight * wrong_force, displacement, wrong_force)
