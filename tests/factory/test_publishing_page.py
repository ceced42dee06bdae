"""The commands of docs/how-to/publish.md run, in order, on a dataset of the README's first command."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.packaging.blocks import Block, blocks
from tests.packaging.test_pages import run_here

PAGE = "docs/how-to/publish.md"
BLOCKS = [block for block in blocks(PAGE) if not block.slow]


@pytest.fixture(scope="module")
def folder(quick_store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Working folder of the commands, with the dataset."""
    found = tmp_path_factory.mktemp("publishing")
    shutil.copytree(quick_store, found / "datasets" / "quick-ogden.zarr")
    return found


@pytest.mark.parametrize("block", BLOCKS, ids=[b.name for b in BLOCKS])
def test_block_runs(block: Block, folder: Path) -> None:
    run_here(block, folder)


def test_only_the_upload_is_left_out() -> None:
    left = [block.text for block in blocks(PAGE) if block.slow]
    assert len(BLOCKS) == 5
    assert len(left) == 1
    assert "hf upload" in left[0]
