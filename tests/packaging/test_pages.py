"""Every command block of README and tutorial runs, in order, in a copy of what a clone holds.

Installation blocks are run by `.ci/run`, which then passes on the dataset of the README's first command, by
TISIM_QUICK_STORE. `python -m pytest -m slow tests/packaging` runs whole pages with the slow blocks (an hour).
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.packaging.blocks import ROOT, Block, blocks

PAGES = ("README.md", "docs/tutorial.md")
STORE = Path("datasets", "quick-ogden.zarr")
QUICK = [b for page in PAGES for b in blocks(page) if not b.installs and not b.slow]


def clone(folder: Path) -> None:
    """The folders that commands name, without what was built in them."""
    for name in ("datasets", "docs", "studies"):
        shutil.copytree(
            ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.zarr", "*.building", "*.png")
        )
    built = os.environ.get("TISIM_QUICK_STORE")
    if built:
        shutil.copytree(built, folder / STORE)
    else:  # as the README's first command builds it
        run([sys.executable, "-m", "factory.build", "--model", "ogden", "--recipe", "quick"], folder)


def run(command: list[str], folder: Path) -> None:
    """Runs it with `python` as the one of these tests; fails with what it printed."""
    environment = dict(os.environ)
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment["PYTHONPATH"] = str(ROOT)  # a checkout needs no installation
    ended = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, f"{' '.join(command)}\n{ended.stdout[-3000:]}\n{ended.stderr[-3000:]}"


@pytest.fixture(scope="module")
def scratch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("clone")
    clone(folder)
    return folder


@pytest.mark.parametrize("block", QUICK, ids=[b.name for b in QUICK])
def test_block_runs(block: Block, scratch: Path) -> None:
    """In the order of the page; a block may use what the ones before it wrote."""
    run(block.command(sys.executable), scratch)


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_whole_page_runs(page: str, tmp_path: Path) -> None:
    clone(tmp_path)
    for block in blocks(page):
        if not block.installs:
            run(block.command(sys.executable), tmp_path)


def test_pages_have_blocks_of_each_sort() -> None:
    """The parser finds what it looks for: a page that is written otherwise would run nothing."""
    readme, tutorial = (blocks(page) for page in PAGES)
    assert sum(b.installs for b in readme) == 4
    assert sum(b.slow for b in readme) == 3
    assert sum(b.language == "python" for b in readme) == 1
    assert len([b for b in readme if not (b.installs or b.slow)]) == 5
    assert len(tutorial) == 10
    assert not any(b.slow or b.installs for b in tutorial)


def test_no_command_is_hidden_from_the_tests() -> None:
    """Commands of README and tutorial stand in marked blocks; `text` and bare fences are for output."""
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        fences = [line for line in text.splitlines() if line.startswith("```")]
        assert set(fences[::2]) <= {"```sh", "```python"}, page
