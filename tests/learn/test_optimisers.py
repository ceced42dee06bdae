"""Muon takes orthogonalised steps of hidden matrices, and Adam steps all other parameters."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from learn.data import MemoryDataset, Statistics, open_store, statistics
from learn.models import Model, make_model
from learn.training import Recipe
from learn.training.optimisers import make_optimiser
from tests.learn.small_store import write_store

RATE = 1e-2


@pytest.fixture(scope="module")
def sizes(tmp_path_factory: pytest.TempPathFactory) -> Statistics:
    store = open_store(write_store(tmp_path_factory.mktemp("optimisers") / "s.zarr", sites=1, frames=2))
    return statistics(MemoryDataset(store, np.arange(store.frames)).batches(64), store)


def _one_step(sizes: Statistics, optimiser: str) -> tuple[Model, dict[str, torch.Tensor]]:
    """A model and the change of its parameters in one step.

    The singular values of each matrix's gradient span a factor of twenty.
    """
    torch.manual_seed(3)
    model = make_model("invariant-gnn-small", sizes)
    before = {name: p.detach().clone() for name, p in model.named_parameters()}
    for p in model.parameters():
        p.grad = torch.randn_like(p)
        if p.ndim == 2:
            u, s, v = torch.linalg.svd(p.grad, full_matrices=False)
            p.grad = u * torch.logspace(-1.3, 0.0, len(s)) @ v
    recipe = Recipe.model_validate({"optimiser": optimiser, "learning_rate": RATE})
    make_optimiser(model, recipe).step()
    return model, {name: p.detach() - before[name] for name, p in model.named_parameters()}


@pytest.mark.parametrize("name", ["enter.weight", "from_point.weight"])
def test_muon_moves_a_hidden_matrix_as_far_in_all_directions(sizes: Statistics, name: str) -> None:
    _, moved = _one_step(sizes, "muon")
    step = moved[name]
    size = RATE * 0.2 * max(step.shape) ** 0.5  # Liu et al. 2025, eq. 4
    found = torch.linalg.svdvals(step) / size
    assert found.min() > 0.5  # accuracy of five Newton-Schulz iterations
    assert found.max() < 1.3


def test_adam_moves_what_is_no_hidden_matrix(sizes: Statistics) -> None:
    model, moved = _one_step(sizes, "muon")
    _, plain = _one_step(sizes, "adam")
    rest = {name for name, p in model.named_parameters() if p.ndim != 2} | model.outputs
    assert model.outputs < set(moved)
    for name, step in moved.items():
        assert step.abs().max() > 0.0
        assert torch.equal(step, plain[name]) == (name in rest), name
