"""One trained run, shared by all tests of the page."""

from __future__ import annotations

import pytest
import torch

import learn
from learn.evaluation import Intervals, save_intervals
from learn.predictor import Predictor
from tests.learn.commands import train_small
from tests.learn.small_store import write_store

# as `learn.evaluate` fits them, with factors per ring of distance [mm]
WIDTHS = Intervals(
    level=0.9, promised=0.9, pokes=20, scale=[-3.0, -0.5, 0.0, 0.0, 0.3, 0.0, 0.0, 0.1, 0.0],
    factors=[1.5, 1.4, 1.3, 1.2, 1.1], force_scale=0.02, force=1.7,
    growth=(0.05, -0.03, 0.02), force_growth=(-0.04, 0.02, 0.01),
)  # fmt: skip


@pytest.fixture(scope="package")
def predictor(tmp_path_factory: pytest.TempPathFactory) -> Predictor:
    """Predictor of invariant-gnn-small with intervals, trained for one epoch on a synthetic store."""
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("page")
    store = write_store(folder / "s.zarr", shapes=3, sites=3, frames=3)
    flags = ("--epochs", 1, "--model", "invariant-gnn-small")
    found = learn.load(train_small(store, folder / "run", *flags))
    save_intervals(found.run, WIDTHS)
    return found
