"""Optimisers by name: Adam, and Muon for the matrices of hidden layers with Adam for the rest.

Muon steps a matrix along the orthogonal matrix nearest to its momentum, so that directions of small gradients
are learned as fast as the others (Jordan et al. 2024, https://kellerjordan.github.io/posts/muon).
Its steps are scaled to the size of Adam's (Liu et al. 2025, arXiv:2502.16982, section 2.2), so that one
learning rate serves both.
"""

from __future__ import annotations

from typing import Any, Protocol

import torch
from torch import nn

from learn.models.base import Model
from learn.training.recipe import Recipe


class Optimiser(Protocol):
    """Interface of an optimiser, as used by training."""

    @property
    def param_groups(self) -> list[dict[str, Any]]: ...

    def zero_grad(self, set_to_none: bool = True) -> None: ...

    def step(self) -> Any: ...

    def state_dict(self) -> dict[str, Any]: ...

    def load_state_dict(self, state_dict: dict[str, Any]) -> None: ...


class Joined:
    """Several optimisers as one, each with its own parameters."""

    def __init__(self, *members: torch.optim.Optimizer) -> None:
        self._members = members

    @property
    def param_groups(self) -> list[dict[str, Any]]:
        return [group for member in self._members for group in member.param_groups]

    def zero_grad(self, set_to_none: bool = True) -> None:
        for member in self._members:
            member.zero_grad(set_to_none=set_to_none)

    def step(self) -> None:
        for member in self._members:
            member.step()

    def state_dict(self) -> dict[str, Any]:
        return {"members": [member.state_dict() for member in self._members]}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        for member, state in zip(self._members, state_dict["members"], strict=True):
            member.load_state_dict(state)


def make_optimiser(model: Model, recipe: Recipe) -> Optimiser:
    """The recipe's optimiser for a model's parameters."""
    rate = recipe.learning_rate
    if recipe.optimiser == "adam":
        return torch.optim.Adam(model.parameters(), lr=rate)
    hidden = [p for name, p in model.named_parameters() if p.ndim == 2 and name not in model.outputs]
    chosen = {id(p) for p in hidden}
    rest: list[nn.Parameter] = [p for p in model.parameters() if id(p) not in chosen]
    # without Muon's usual weight decay: Adam here has none either
    muon = torch.optim.Muon(hidden, lr=rate, weight_decay=0.0, adjust_lr_fn="match_rms_adamw")
    return Joined(muon, torch.optim.Adam(rest, lr=rate))
