"""A tiny recipe, builds with a stand-in simulator, and digests of the written files."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from factory.building import build as building
from factory.building.build import BuildProgress, build_dataset
from factory.plan import Plan, make_plan
from factory.plan.poke import PlannedPoke
from factory.recipe import Recipe, load_recipe
from factory.simulation.execution import SIMULATOR, run_poke
from factory.simulation.record import Outcome
from factory.store.files import LEDGER
from factory.store.staging import building_folder
from tests.unrendered import unrendered

__all__ = ["unrendered"]

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
STANDIN = "tests.factory.standin:simulate"

# run in its own process, as a user would, but with the stand-in for tisim
COMMAND = """
import functools, sys
import factory.build
from factory.building import build
if __name__ == "__main__":
    standin = "tests.factory.standin:simulate"
    build.build_dataset = functools.partial(build.build_dataset, simulator=standin)
    factory.build.app()
"""

TINY = """
name: tiny
description: for the tests
seed: 3
block_mm: [100, 100, 32]
rod: {radius_mm: 2.5, length_mm: 40, tip: flat, edge_radius_mm: 1}
friction: 0.6
protocol: {shared_sites: 0, own_sites: 2, margin_mm: 20, max_angle_deg: 45, depth_mm: 30, frame_spacing_mm: 1}
softness: [S0, S1]
border_mm: 10
cover_mm: 8
shapes:
  - {kind: cube, id: cube-18, side_mm: 18}
"""


@pytest.fixture(autouse=True)
def _plain_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in list(os.environ):
        if name.startswith("STANDIN_"):
            monkeypatch.delenv(name)
    # a slow disk would slow these tests down; the effect of a power cut cannot be tested here
    monkeypatch.setattr(os, "fsync", lambda _handle: None)


@pytest.fixture
def tiny_file(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.yaml"
    path.write_text(TINY)
    return path


@pytest.fixture
def tiny(tiny_file: Path) -> Recipe:
    return load_recipe(str(tiny_file))


@pytest.fixture
def plan(tiny: Recipe) -> Plan:
    """Four pokes."""
    return make_plan(tiny, "ogden")


@pytest.fixture
def quick() -> Plan:
    """Twelve pokes."""
    return make_plan(load_recipe("quick"), "ogden")


def _run_here(pokes: Sequence[PlannedPoke], *, workers: int, simulator: str) -> Generator[Outcome]:
    """Simulate the pokes one after the other in this process: no process has to start."""
    del workers
    for poke in pokes:
        yield run_poke(poke, simulator)


@pytest.fixture
def serial(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(building, "run_local", _run_here)


Builder = Callable[..., building.Built]


@pytest.fixture
def standin_build(serial: None) -> Builder:
    """Build in this process with the stand-in."""
    del serial

    def run(plan: Plan, target: Path, **options: object) -> building.Built:
        return build_dataset(plan, target, **{"simulator": STANDIN, **options})  # type: ignore[arg-type]

    return run


def _four_pokes(folder: Path) -> Plan:
    (folder / "tiny.yaml").write_text(TINY)
    return make_plan(load_recipe(str(folder / "tiny.yaml")), "ogden")


def build_here(plan: Plan, target: Path, *, simulator: str = STANDIN, **options: Any) -> None:
    """Build in this process, with the stand-in by default, for fixtures of a wider scope than a test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(building, "run_local", _run_here)
        build_dataset(plan, target, simulator=simulator, **options)


def simulate_here(recipe: str, folder: Path) -> Path:
    """Store of the Ogden law of a recipe's text, in this folder, simulated by tisim in this process."""
    (folder / "recipe.yaml").write_text(recipe)
    plan = make_plan(load_recipe(folder / "recipe.yaml"), "ogden")
    build_here(plan, folder / "store.zarr", simulator=SIMULATOR, workers=1)
    return folder / "store.zarr"


@pytest.fixture(scope="session")
def finished_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of `plan`, built once; tests that change it use a copy."""
    folder = tmp_path_factory.mktemp("finished")
    build_here(_four_pokes(folder), folder / "store.zarr")
    return folder / "store.zarr"


@pytest.fixture(scope="session")
def quick_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of `quick`, built once; no test changes it."""
    folder = tmp_path_factory.mktemp("quick")
    build_here(make_plan(load_recipe("quick"), "ogden"), folder / "store.zarr")
    return folder / "store.zarr"


@pytest.fixture
def store(finished_store: Path, tmp_path: Path) -> Path:
    """A copy of the finished store."""
    return Path(shutil.copytree(finished_store, tmp_path / "reference.zarr"))


@pytest.fixture(scope="session")
def _stopped_build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The building folder of `plan`, stopped after three of its four pokes."""

    def stop(state: BuildProgress) -> None:
        if state.done == 3:
            raise KeyboardInterrupt

    folder = tmp_path_factory.mktemp("stopped")
    with pytest.raises(KeyboardInterrupt):
        build_here(_four_pokes(folder), folder / "stopped.zarr", on_progress=stop)
    return building_folder(folder / "stopped.zarr")


@pytest.fixture
def stopped(_stopped_build: Path, tmp_path: Path) -> Path:
    """Target of a build that was stopped after three of its four pokes."""
    target = tmp_path / "stopped.zarr"
    shutil.copytree(_stopped_build, building_folder(target))
    return target


def run_app(app: Any, *arguments: object) -> Result:
    """Run a command in this process and reraise any exception other than SystemExit."""
    result = CliRunner().invoke(app, [str(a) for a in arguments], env={"COLUMNS": "300"})
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def digest(store: Path) -> dict[str, str]:
    """sha256 of each file except the ledger."""
    assert store.is_dir(), store
    return {
        path.relative_to(store).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(store.rglob("*"))
        if path.is_file() and path.relative_to(store).as_posix() != LEDGER
    }


def environment(**more: str) -> dict[str, str]:
    """Environment of a process that must find the repository and the stand-in."""
    return {**os.environ, "PYTHONPATH": str(ROOT), **more}


@pytest.fixture
def command(tmp_path: Path) -> Callable[..., subprocess.Popen[str]]:
    """Start `python -m factory.build` with the stand-in, in its own process group."""
    script = tmp_path / "command.py"
    script.write_text(COMMAND)

    def start(*arguments: str, **variables: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, str(script), *arguments],
            env=environment(**variables),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    return start
