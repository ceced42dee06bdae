"""Wheel and sdist contain recipes and cards, and the factory finds them from another folder."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.factory.conftest import ROOT, TINY, environment

SHIPPED = sorted(
    path.relative_to(ROOT / "datasets").as_posix()
    for folder in ("recipes", "materials")
    for path in (ROOT / "datasets" / folder).glob("*.yaml")
)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Wheel and sdist of a copy of the sources (setuptools writes into the source folder)."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("built")
    skip = shutil.ignore_patterns("__pycache__", "*.zarr", "*.building", "measured", "build", "*.egg-info")
    for path in ROOT.iterdir():
        if path.name in ("tisim", "factory", "calibration", "learn", "datasets"):
            shutil.copytree(path, source / path.name, ignore=skip)
        elif path.is_file() and path.name != ".git":
            shutil.copy(path, source / path.name)
    code = f"import setuptools.build_meta as b; b.build_wheel({str(out)!r}); b.build_sdist({str(out)!r})"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=source, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return out


def test_wheel_and_sdist_hold_recipes_and_cards(built: Path) -> None:
    assert len(SHIPPED) >= 8
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        inside = [name for name in wheel.namelist() if name.startswith("factory/_shipped/")]
        assert sorted(name.removeprefix("factory/_shipped/") for name in inside) == SHIPPED
        assert {name.split("/")[0].split("-")[0] for name in wheel.namelist()} == {
            "tisim",
            "factory",
            "calibration",
            "learn",
        }
    with tarfile.open(next(built.glob("*.tar.gz"))) as sdist:
        names = {name.partition("/")[2] for name in sdist.getnames()}
        assert {f"datasets/{name}" for name in SHIPPED} <= names


def test_an_installed_wheel_works_from_another_folder(built: Path, tmp_path: Path) -> None:
    site, elsewhere = tmp_path / "site", tmp_path / "elsewhere"
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        wheel.extractall(site)
    elsewhere.mkdir()
    (elsewhere / "tiny.yaml").write_text(TINY)
    shutil.copy(ROOT / "tests" / "factory" / "standin.py", elsewhere / "standin.py")
    code = """
import sys, factory
from pathlib import Path
assert Path(factory.__file__).is_relative_to(sys.argv[1]), factory.__file__
plan = factory.make_plan(factory.load_recipe("quick"), "ogden")
tiny = factory.make_plan(factory.load_recipe("tiny.yaml"), "ogden")
if __name__ == "__main__":
    built = factory.build_dataset(tiny, Path("datasets/tiny.zarr"), workers=1, simulator="standin:simulate")
    found = factory.verify_dataset("datasets/tiny.zarr")
    print(len(plan.pokes), factory.recipe_names(), built.simulated, factory.open_dataset(built.store))
"""
    (elsewhere / "use.py").write_text(code)
    variables = environment(PYTHONPATH=str(site))
    done = subprocess.run(
        [sys.executable, "use.py", str(site)],
        cwd=elsewhere,
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    recipes = sorted(path.stem for path in (ROOT / "datasets" / "recipes").glob("*.yaml"))
    assert done.stdout.startswith(f"12 {recipes} 4 Dataset(")
    done = subprocess.run(
        [sys.executable, "-m", "factory.build", "--model", "ogden", "--recipe", "quick", "--dry-run"],
        cwd=elsewhere,
        env={**variables, "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert str(elsewhere / "datasets" / "quick-ogden.zarr") in done.stdout
