"""Stores whose shapes have blocks of their own: built by tisim, read, verified, described and published."""

from __future__ import annotations

import io
import json
import re
import shutil
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
import zarr
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import factory.card
from factory import open_dataset, verify_dataset
from factory.checks import equilibrium
from factory.inspect import app as inspect_app
from factory.inspection import figures
from factory.inspection.figures import draw_preview
from factory.plan import make_plan
from factory.recipe import load_recipe
from factory.release import app as release_app
from factory.sampling import grid_points, level_depths, profiles
from factory.simulation.record import Trace
from factory.store.files import write_manifest
from factory.store.schema import SPECS
from factory.verify import app as verify_app
from learn.data import open_store
from learn.evaluation.predictions import interpolation_error_mm
from tests.factory.conftest import Builder, digest, run_app, simulate_here

# simulated in seconds by tisim itself: a drawn shape, a stated one, and one that states its block
SMALL = """
name: small
description: three small blocks
seed: 5
block_mm: [[40, 60], [40, 60], [14, 22]]
rod: {radius_mm: 2.5, length_mm: 40, tip: flat, edge_radius_mm: 1}
friction: 0.6
protocol: {shared_sites: 1, own_sites: 0, margin_mm: 12, max_angle_deg: 20, depth_mm: 1, frame_spacing_mm: 1}
softness: [S0, S1]
border_mm: 6
cover_mm: 6
refinement: 0.5
shapes:
  - {kind: cube, id: cube, draw: 1, side_mm: [6, 9]}
  - {kind: sphere, id: ball, radius_mm: 4, sunk_mm: 1}
  - {kind: cylinder, id: mine, radius_mm: 5, height_mm: 8, block_mm: [44, 58, 17.5]}
"""


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three shapes at two material levels, built by tisim."""
    return simulate_here(SMALL, tmp_path_factory.mktemp("blocks"))


def test_the_arrays_of_a_geometry_are_those_of_its_mesh(small: Path) -> None:
    store = zarr.open_group(small, mode="r")
    grid, level = store["grid_rest"], store["level_depth"]
    assert (grid.shape, grid.dtype, grid.attrs["units"]) == ((6, 32, 32, 3), np.float64, "m")
    assert (level.shape, level.dtype, level.attrs["units"]) == ((6, 128), np.float64, "m")
    stated = store.attrs["identity"]["recipe"]["shapes"]
    start, count = store["node_start"][:], store["node_count"][:]
    assert len(start) == 6
    for poke, geometry in enumerate(store["poke_geometry"][:]):
        rest = store["surface_rest"][start[poke] : start[poke] + count[poke]]
        block = rest.max(axis=0) - rest.min(axis=0)
        np.testing.assert_allclose(block, np.array(stated[geometry // 2]["block_mm"]) * 1e-3, atol=1e-12)
        np.testing.assert_allclose(rest.max(axis=0), block * [0.5, 0.5, 1.0], atol=1e-12)
        np.testing.assert_allclose(grid[geometry], grid_points(tuple(block)), atol=1e-12)
        np.testing.assert_allclose(level[geometry], level_depths(block[2]), atol=1e-12)
    assert len(np.unique(level[:, 0])) == 3
    assert stated[2]["block_mm"] == [44, 58, 17.5]


def test_it_is_read_poke_by_poke(small: Path) -> None:
    data = open_dataset(small)
    for index in range(data.n_pokes):
        poke, geometry = data.poke(index), int(data.table["poke_geometry"][index])
        np.testing.assert_allclose(poke.block, np.ptp(poke.surface_rest, axis=0), atol=1e-12)
        moved = data.read("grid_displacement", data.rows(index, "frame"))
        np.testing.assert_array_equal(poke.grid, data.table["grid_rest"][geometry] + moved)
        code = round(255 * [0.8, 0.0][geometry % 2]) / 255
        expected = profiles(grid_points(poke.block), poke.block[2], poke.inclusion, code)
        np.testing.assert_array_equal(poke.profile, expected)
        assert (expected == 255).any()


def test_learn_reads_the_block_of_each_poke(small: Path) -> None:
    """The surrogate's reader, which shares no code with the factory, finds the same blocks and fields."""
    store, written = open_store(small), open_dataset(small)
    assert len(store.setups) == 3
    for poke in range(store.pokes):
        setup, block = store.setup_of(poke), written.block(int(store.geometry[poke]))
        np.testing.assert_allclose(setup.block_size, block, rtol=1e-12)
        np.testing.assert_allclose(setup.with_block(block).points, setup.points, atol=1e-15)
        site = written.table["site"][poke]
        np.testing.assert_allclose(setup.contact_site(store.path_start[poke], store.direction[poke]), site)
        np.testing.assert_allclose(setup.first_touch(site, store.direction[poke]), store.path_start[poke])
    rows = np.arange(store.frames)
    assert interpolation_error_mm(store, rows) < 1e-4


def test_xarray_opens_it(small: Path) -> None:
    data = xarray.open_zarr(small)
    assert set(data.data_vars) >= set(SPECS)
    assert data.grid_rest.dims == ("geometry", "grid_row", "grid_column", "axis")
    assert data.level_depth.dims == ("geometry", "level")
    of_poke = data.grid_rest[data.poke_geometry]
    assert float(of_poke[-1, ..., 2].max()) == pytest.approx(0.0175)


def test_verify_and_inspect_know_its_blocks(
    small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(equilibrium, "ProcessPoolExecutor", lambda *_, **__: ThreadPoolExecutor(1))
    done = run_app(verify_app, small, "--assembly", "--workers", 1)
    assert done.exit_code == 0, done.output
    assert "6 pokes, 6 frames: no fault" in done.output
    assert "equilibrium by assembly of 3 pokes, 3 frames: 0 faults" in done.output
    assert run_app(inspect_app, small, "--arrays").exit_code == 0
    done = run_app(inspect_app, small, "--poke", 5, "--picture", tmp_path / "poke.png")
    assert done.exit_code == 0, done.output
    assert "44 x 58 x 17.5 mm" in done.stdout
    assert (tmp_path / "poke.png").stat().st_size > 10_000


def test_the_card_describes_them_and_its_snippet_runs(
    small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = run_app(factory.card.app, small, "--out", tmp_path / "card")
    assert done.exit_code == 0, done.output
    page = (tmp_path / "card" / "card.md").read_text(encoding="utf-8")
    found = np.array([s["block_mm"] for s in open_dataset(small).attributes["identity"]["recipe"]["shapes"]])
    spans = " x ".join(f"{low:g} to {high:g}" for low, high in zip(found.min(0), found.max(0), strict=True))
    assert f"- Block: {spans} mm, one for each shape, its base and the inclusion fixed." in page
    assert "| `mine` | cylinder | radius 5, height 8 | 44 x 58 x 17.5 |" in page
    (snippet,) = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    monkeypatch.chdir(small.parent)
    space: dict[str, Any] = {"__name__": "__main__"}
    with redirect_stdout(io.StringIO()):
        exec(snippet, space)
    np.testing.assert_array_equal(space["surface"], open_dataset(small).poke(space["poke"]).grid)


def test_its_zip_is_the_same_dataset(small: Path, tmp_path: Path) -> None:
    done = run_app(release_app, small, "--out", tmp_path / "store.zarr.zip")
    assert done.exit_code == 0, done.output
    assert not verify_dataset(tmp_path / "store.zarr.zip").total
    one, two = (open_dataset(path).poke(3) for path in (small, tmp_path / "store.zarr.zip"))
    np.testing.assert_array_equal(one.grid, two.grid)


def _scale(name: str, row: int, factor: float) -> Callable[[Path], None]:
    def change(store: Path) -> None:
        array = zarr.open_group(store, mode="r+")[name]
        array[row] = array[row] * factor

    return change


def _swap(store: Path) -> None:
    array = zarr.open_group(store, mode="r+")["grid_rest"]
    array[...] = np.roll(array[...], 2, axis=0)


def _stated(store: Path) -> None:
    metadata = json.loads((store / "zarr.json").read_text())
    metadata["attributes"]["identity"]["recipe"]["shapes"][1]["block_mm"][0] += 1.0
    (store / "zarr.json").write_text(json.dumps(metadata))


@pytest.mark.parametrize(
    ("change", "check", "faults"),
    [
        (_scale("grid_rest", 2, 1.01), "blocks", ["geometry 2: grid_rest is not that of its block"]),
        (_scale("level_depth", 3, 1.01), "blocks", ["geometry 3: level_depth is not that of its block"]),
        (_swap, "inclusions", ["geometry 0: the profile's rigid part is not the box described"]),
        (
            _stated,
            "blocks",
            ["geometry 2: grid_rest", "poke 2: its surface at rest is not that of its block"],
        ),
    ],
)
def test_verify_finds_what_is_of_another_block(
    change: Callable[[Path], None], check: str, faults: list[str], small: Path, tmp_path: Path
) -> None:
    store = Path(shutil.copytree(small, tmp_path / "a.zarr"))
    change(store)
    write_manifest(store)
    found = verify_dataset(store).faults[check]
    for fault in faults:
        assert any(one.startswith(fault) for one in found), found


def test_a_shape_without_its_block_is_named(small: Path, tmp_path: Path) -> None:
    store = Path(shutil.copytree(small, tmp_path / "a.zarr"))
    metadata = json.loads((store / "zarr.json").read_text())
    del metadata["attributes"]["identity"]["recipe"]["shapes"][1]["block_mm"]
    (store / "zarr.json").write_text(json.dumps(metadata))
    done = run_app(inspect_app, store)
    assert done.exit_code == 2
    assert "block_mm: expected three sides, or a block of each shape" in done.stderr


def test_it_is_built_again_byte_by_byte(tmp_path: Path, standin_build: Builder) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    digests = []
    for name in ("a.zarr", "b.zarr"):
        plan = make_plan(load_recipe(tmp_path / "small.yaml"), "ogden")
        standin_build(plan, tmp_path / name)
        digests.append(digest(tmp_path / name))
    assert digests[0] == digests[1]


def test_the_preview_shows_every_block(tmp_path: Path) -> None:
    """The map of the top is that of the deepest poke's own block."""
    (tmp_path / "small.yaml").write_text(SMALL)
    plan = make_plan(load_recipe(tmp_path / "small.yaml"), "ogden")
    ramp = np.linspace(1e-4, 1e-3, 5)
    traces = {
        poke.index: Trace(depth=ramp * (1 + poke.index), force=ramp, grid=np.zeros((32, 32, 3), np.float32))
        for poke in plan.pokes
    }
    draw_preview(plan, traces, tmp_path / "preview.png")
    assert (tmp_path / "preview.png").stat().st_size > 10_000
    figure = Figure()
    sites, top = figure.subplots(1, 2)
    figures._sites(plan, traces, sites)
    half = 1e3 * np.array(plan.blocks)[:, :2] / 2
    assert (sites.get_xlim()[1], sites.get_ylim()[1]) == pytest.approx(half.max(axis=0))
    outlines = [patch.get_bbox().max for patch in sites.patches if isinstance(patch, Rectangle)]
    np.testing.assert_allclose(sorted(map(tuple, outlines)), np.unique(half, axis=0))
    figures._top(plan, traces, top, figure)
    assert (top.get_xlim()[1], top.get_ylim()[1]) == pytest.approx((22, 29))
