"""A user's inclusion shape and law from a module: planned, simulated, stored, read back, verified."""

from __future__ import annotations

import linecache
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

import factory
from factory.build import app as build_app
from factory.errors import InputError
from factory.verify import app as verify_app
from tests.factory.conftest import ROOT, environment, run_app
from tisim.parallel.extensions import digest_of_code

RECIPE = """
name: own
description: one indentation of a block with a spheroid
seed: 3
block_mm: [60, 60, 20]
rod: {radius_mm: 2.5, length_mm: 40}
friction: 0.6
protocol:
  {shared_sites: 1, own_sites: 0, margin_mm: 15, max_angle_deg: 0, depth_mm: 0.5, frame_spacing_mm: 0.5}
softness: [S1]
border_mm: 5
cover_mm: 6
refinement: 0.5
shapes:
  - {kind: spheroid, id: flat, radius_mm: 8, half_height_mm: 5, sunk_mm: 1}
"""


def command(name: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", f"factory.{name}", *map(str, arguments)],
        env=environment(COLUMNS="300"),
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built by tisim in a worker process, which must load the shape and the law."""
    folder = tmp_path_factory.mktemp("own")
    (folder / "own.yaml").write_text(RECIPE)
    arguments = ("--model", "my-law", "--recipe", folder / "own.yaml", "--out", folder / "own.zarr")
    done = command("build", *arguments, "--workers", "1", "--plugin", "tests.factory.plugin")
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "own.zarr"


def test_shape_and_law_are_stored_by_their_names(store: Path) -> None:
    data = factory.open_dataset(store)
    assert data.attributes["model"] == "my-law"
    assert data.table["done"].all()
    law, kind = data.array("law"), data.array("inclusion_kind")
    assert str(law.attrs["flag_meanings"]).split()[data.table["law"][0]] == "my-law"
    assert str(kind.attrs["flag_meanings"]).split()[data.table["inclusion_kind"][0]] == "spheroid"
    np.testing.assert_allclose(data.table["inclusion_size"][0], [0.008, 0.005, 0.0])
    card = yaml.safe_load((ROOT / "datasets" / "materials" / "S1.yaml").read_text())
    assert data.attributes["shear_modulus"] == [card["laws"]["neo-hookean"]["mu"]]
    assert data.attributes["parameter_names"] == ["mu", "bulk"]
    (stored,) = data.attributes["inclusions"]
    assert (stored["kind"], stored["radius"], stored["half_height"]) == ("spheroid", 0.008, 0.005)
    assert stored["centre"][2] == pytest.approx(0.004)


def test_the_profile_has_the_shape_in_it(store: Path) -> None:
    data = factory.open_dataset(store)
    rigid = data.read("profile", 0) == 255
    heights = 0.020 - data.table["level_depth"][np.flatnonzero(rigid.any(axis=(0, 1)))]
    assert heights.max() == pytest.approx(0.009, abs=4e-4)  # half height + centre: 5 + 4 mm
    grid = data.table["grid_rest"]
    centre = np.array(data.attributes["inclusions"][0]["centre"])
    away = np.linalg.norm(grid[..., :2] - centre[:2], axis=-1)
    assert away[rigid.any(axis=2)].max() < 0.008
    assert away[~rigid.any(axis=2)].min() > 0.006


def test_it_is_read_back_and_verified_with_the_plugin(store: Path) -> None:
    done = command("verify", store, "--plugin", "tests.factory.plugin")
    assert done.returncode == 0, done.stdout + done.stderr
    done = command("inspect", store, "--poke", "0", "--plugin", "tests.factory.plugin")
    assert "spheroid, 8, 5 mm" in done.stdout


def test_the_code_of_shape_and_law_is_part_of_the_identity(store: Path, tmp_path: Path) -> None:
    """Another body of a function is another dataset, wherever the module's file stands."""
    code = factory.open_dataset(store).attributes["identity"]["extensions"]
    assert sorted(code) == ["inclusion spheroid", "law my-law"]
    digests = []
    for folder, factor in (("a", 0.5), ("b", 0.5), ("b", 0.25)):
        path = tmp_path / folder / "copied_law.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"def energy(i1):\n    return {factor} * half(i1)\n\n\ndef half(x):\n    return x\n")
        linecache.checkcache()
        digests.append(digest_of_code(runpy.run_path(str(path))["energy"]))
    assert digests[0] == digests[1] != digests[2]
    path.write_text(path.read_text().replace("return x", "return 2 * x"))  # a function that it calls
    linecache.checkcache()
    assert digest_of_code(runpy.run_path(str(path))["energy"]) not in digests


def test_without_the_plugin_the_shape_is_named(store: Path) -> None:
    done = run_app(verify_app, store)
    assert done.exit_code == 1
    assert "inclusion of geometry 0: inclusion: expected one of box, sphere, cylinder" in done.stdout
    assert "got 'spheroid'" in done.stdout
    (store.parent / "unknown.yaml").write_text(RECIPE)
    with pytest.raises(
        InputError, match=r"key shapes\.0: expected as kind one of 'cube', .*, got 'spheroid'"
    ):
        factory.load_recipe(store.parent / "unknown.yaml")
    done = run_app(build_app, "--model", "my-law", "--recipe", "quick", "--dry-run")
    assert done.exit_code == 2
    assert done.stderr.startswith("error: --model my-law: expected one of st-venant-kirchhoff")


def test_the_shapes_lengths_are_the_recipes_keys(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(RECIPE.replace("half_height_mm", "half_heigth_mm"))
    plugin = ("--plugin", "tests.factory.plugin", "--dry-run")
    done = command("build", "--model", "my-law", "--recipe", path, *plugin)
    assert done.returncode == 2
    assert "key shapes.0.half_height_mm: this key is missing" in done.stderr
    assert "shapes.0.half_heigth_mm: unknown key (did you mean shapes.0.half_height_mm?)" in done.stderr


def test_a_plugin_that_cannot_be_imported_is_named() -> None:
    done = run_app(build_app, "--model", "ogden", "--plugin", "nowhere_at_all", "--dry-run")
    assert done.exit_code == 2
    assert (
        done.stderr
        == "error: --plugin nowhere_at_all: ModuleNotFoundError: No module named 'nowhere_at_all'\n"
    )
