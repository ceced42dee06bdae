"""One trained run and its store, shared by all tests of the evaluation."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.learn.commands import train_small
from tests.learn.small_store import write_store


@pytest.fixture(scope="package")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_store(tmp_path_factory.mktemp("evaluation") / "s.zarr", sites=2, frames=3)


@pytest.fixture(scope="package")
def run(store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The recipe weighs absolute errors (depth_power: 0), as the mean of the tables does."""
    return train_small(store, tmp_path_factory.mktemp("run") / "run")
