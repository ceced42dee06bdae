"""Every command block of README and tutorials runs, in order, in a copy of the content of a clone.

Lines of `python -m` run in this process, since the start of another one takes seconds. A block that two pages
contain word for word runs once. Installation blocks are run by `.ci/run`, which then passes the dataset of
the README's first command in TISIM_QUICK_STORE; without it the stand-in simulator makes one. `python -m
pytest -m slow tests/packaging` runs whole pages with the slow blocks (an hour), each command in its own
process.
"""

from __future__ import annotations

import contextlib
import io
import json
import logging
import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
import yaml

from factory import load_recipe, make_plan
from factory.building.build import build_dataset
from tests.packaging.blocks import ROOT, Block, blocks

PAGES = (
    "README.md",
    "docs/tutorials/first-diagnosis.md",
    "docs/tutorials/photographs.md",
    "docs/tutorials/dataset-and-surrogate.md",
    "docs/tutorials/own-body.md",
    "docs/how-to/viewing.md",
)
STORE = Path("datasets", "quick-ogden.zarr")
_BLOCKS = [b for page in PAGES for b in blocks(page) if not (b.installs or b.slow)]
QUICK = [b for i, b in enumerate(_BLOCKS) if b.text not in {before.text for before in _BLOCKS[:i]}]
_MODULE = re.compile(r"python -m ([\w.]+) ([^|&;<>$`]+?)( \|\| echo .*)?")


def clone(folder: Path, *, simulated: bool = False) -> None:
    """Copy the folders that commands name, and add the dataset that the README's first command builds.

    With `simulated`, tisim simulates the dataset if there is none, which takes minutes.
    """
    for name in ("datasets", "docs", "studies"):
        shutil.copytree(
            ROOT / name, folder / name, ignore=shutil.ignore_patterns("*.zarr", "*.building", "*.png")
        )
    built = os.environ.get("TISIM_QUICK_STORE")
    if built:
        shutil.copytree(built, folder / STORE)
    elif simulated:
        run([sys.executable, "-m", "factory.build", "--model", "ogden", "--recipe", "quick"], folder)
    else:
        plan = make_plan(load_recipe("quick"), "ogden")
        build_dataset(plan, folder / STORE, workers=1, simulator="tests.factory.standin:simulate")


def run(command: list[str], folder: Path) -> None:
    """Run a command with the `python` of these tests; on failure show its output."""
    environment = dict(os.environ)
    environment["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{environment['PATH']}"
    environment["PYTHONPATH"] = str(ROOT)  # a checkout needs no installation
    environment.pop("LOKY_MAX_CPU_COUNT", None)  # set by the tests; whole pages use all cores
    ended = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, f"{' '.join(command)}\n{ended.stdout[-3000:]}\n{ended.stderr[-3000:]}"


def run_here(block: Block, folder: Path) -> None:
    """Run a block like `run`, but Python blocks and lines of `python -m` in this process."""
    if block.language == "python":
        code, shown = _in_process(folder, [block.name], partial(exec, block.text, {"__name__": "__main__"}))
        assert code == 0, f"{block.text}\n{shown[-5000:]}"
        return
    for line in block.text.splitlines():
        command = _MODULE.fullmatch(line)
        if command is None:
            run(["sh", "-e", "-c", line], folder)
            continue
        module, words, may_fail = command.groups()
        call = partial(runpy.run_module, module, run_name="__main__", alter_sys=True)
        code, shown = _in_process(folder, [module, *shlex.split(words)], call)
        assert code == 0 or (may_fail and code in (1, 2)), f"{line}\n{shown[-5000:]}"


def _in_process(folder: Path, arguments: list[str], call: Callable[[], object]) -> tuple[int, str]:
    """Return the exit code and the printed output."""
    shown = io.StringIO()
    handlers = logging.getLogger().handlers[:]
    with pytest.MonkeyPatch.context() as patch, warnings.catch_warnings():
        warnings.simplefilter("default")
        # the package's interface has imported the module already, as for `python -m`
        warnings.filterwarnings("ignore", r"'\w+\.\w+' found in sys.modules", RuntimeWarning)
        patch.chdir(folder)
        patch.setattr(sys, "argv", arguments)
        with contextlib.redirect_stdout(shown), contextlib.redirect_stderr(shown):
            try:
                call()
                code = 0
            except SystemExit as end:
                code = end.code if isinstance(end.code, int) else int(end.code is not None)
    logging.getLogger().handlers[:] = handlers
    return code, shown.getvalue()


@pytest.fixture(scope="module")
def scratch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("clone")
    clone(folder)
    return folder


@pytest.mark.parametrize("block", QUICK, ids=[b.name for b in QUICK])
def test_block_runs(block: Block, scratch: Path) -> None:
    """Blocks run in the order of the pages; a block may use files of earlier ones."""
    run_here(block, scratch)


@pytest.mark.parametrize(
    ("example", "diagnosis"),
    [("coupons", "first"), ("compression", "second")],
)
def test_the_tutorial_finds_what_was_put_in(example: str, diagnosis: str, scratch: Path) -> None:
    """After the tutorial's blocks the diagnosis finds the cause of truth.yaml, alone or as an alternative."""
    found = json.loads((scratch / f"{diagnosis}-diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))
    truth = yaml.safe_load((scratch / "datasets" / "measured" / example / "truth.yaml").read_text())
    causes = sorted({effect["effect"] for effect in truth["effects"]})
    named = [sorted({cause["effect"] for cause in found["causes"]}), *map(sorted, found["alternatives"])]
    assert causes in named, (found["verdict"], named)


def test_the_readme_finds_what_the_bench_was_made_with(scratch: Path) -> None:
    """After the README's blocks the diagnosis names the residual curvature of truth.yaml."""
    found = json.loads((scratch / "diagnosed" / "diagnosis.json").read_text(encoding="utf-8"))
    truth = yaml.safe_load((ROOT / "datasets/measured/bench/bent-in-the-mould/truth.yaml").read_text())
    assert list(truth["effects"]) == ["residual_curvature"]
    (cause,) = found["causes"]
    assert (found["verdict"], cause["effect"]) == ("found", "residual-curvature")


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_whole_page_runs(page: str, tmp_path: Path) -> None:
    clone(tmp_path, simulated=True)
    for block in blocks(page):
        if not block.installs:
            run(block.command(sys.executable), tmp_path)


def test_pages_have_blocks_of_each_sort() -> None:
    """The parser finds blocks: a page in another style would otherwise run nothing."""
    readme, tutorial = (blocks(page) for page in PAGES[:2])
    assert sum(b.installs for b in readme) == 4
    assert sum(b.slow for b in readme) == 3
    assert sum(b.language == "python" for b in readme) == 1
    assert len([b for b in readme if not (b.installs or b.slow)]) == 6
    assert len(tutorial) == 10
    assert sum(b.slow for b in tutorial) == 1
    assert all(blocks(page) for page in PAGES)


def test_no_command_is_hidden_from_the_tests() -> None:
    """Commands of README and tutorial are in marked blocks; `text` and bare fences would be for output."""
    for page in PAGES:
        text = (ROOT / page).read_text(encoding="utf-8")
        fences = [line for line in text.splitlines() if line.startswith("```")]
        assert set(fences[::2]) <= {"```sh", "```python"}, page
