"""The store: readable without tisim, equal to the simulation, and verified."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
import zarr
from typer.testing import CliRunner

from factory.building.build import BuildProgress
from factory.inspect import app as inspect_app
from factory.plan import Plan
from factory.reader import Dataset, open_dataset
from factory.store import schema
from factory.store.files import write_manifest
from factory.verify import app as verify_app
from tests.factory import standin
from tests.factory.conftest import Builder

run = CliRunner().invoke


@pytest.fixture
def store(finished_store: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished_store, tmp_path / "a.zarr"))


def test_xarray_opens_it_with_nothing_of_ours(store: Path, tmp_path: Path) -> None:
    """In a separate process, with warnings as errors."""
    code = f"""
import sys, xarray
for consolidated in (None, False):
    data = xarray.open_zarr({str(store)!r}, consolidated=consolidated)
    assert data.grid_displacement.dims == ("frame", "grid_row", "grid_column", "axis")
    assert data.depth.attrs["units"] == "m" and data.rod_force.attrs["units"] == "N"
    assert sorted(set(data.profile.values.round(6).ravel().tolist())) == [0.0, 0.8, 1.0]
    start, count = int(data.frame_start[2]), int(data.frame_count[2])
    assert (data.frame_poke[start:start + count] == 2).all()
    assert data.attrs["model"] == "ogden" and data.attrs["identity"]["recipe"]["seed"] == 3
assert not any(name.split(".")[0] in ("factory", "tisim") for name in sys.modules)
print("opened")
"""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-P", "-c", code],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert done.stdout == "opened\n", done.stderr


def test_every_array_says_what_it_is(store: Path) -> None:
    data = xarray.open_zarr(store)
    assert set(data.data_vars) == set(schema.SPECS)
    for name, array in data.data_vars.items():
        assert array.attrs["long_name"], name
        if array.dtype.kind == "f" and name != "parameter":
            assert "units" in array.attrs, name


def test_a_poke_comes_back_as_it_was_simulated(plan: Plan, store: Path) -> None:
    data = open_dataset(store)
    for planned in plan.pokes:
        result = standin.simulate([planned.scene], workers=1)[0]
        poke = data.poke(planned.index)
        np.testing.assert_array_equal(poke.depth, result.load)
        np.testing.assert_array_equal(poke.rod_force, result.rod_force)
        np.testing.assert_array_equal(poke.base_force, result.support_force)
        np.testing.assert_array_equal(poke.rod_tip, result.rod_tip)
        on_surface = np.unique(result.mesh.facet_sets["surface"])
        np.testing.assert_allclose(poke.surface, result.positions[:, on_surface], atol=1e-8)
        np.testing.assert_array_equal(poke.surface_rest, result.mesh.nodes[on_surface])
        assert poke.triangles.max() == len(on_surface) - 1
        # the grid moves with the top: exactly at grid points that coincide with nodes of the top
        assert poke.grid.shape == (len(result.load), 32, 32, 3)
        sunk = data.table["grid_rest"][..., 2] - poke.grid[-1, ..., 2]
        assert 0 < sunk.max() <= (result.mesh.nodes - result.positions[-1])[:, 2].max() + 1e-9
        assert poke.message == result.message
        assert poke.status == "not-converged"
        table, i = data.table, planned.index
        np.testing.assert_allclose(table["path_start"][i], [*planned.scene.site, 0.032], atol=1e-12)
        reach = table["path_end"][i] - table["path_start"][i]
        np.testing.assert_allclose(reach, 0.03 * np.array(planned.scene.direction), atol=1e-12)
        assert table["mesh_nodes"][i] == result.mesh.n_nodes
        assert table["mesh_elements"][i] == result.mesh.n_elements
        assert table["newton_iterations"][i] == result.cost.newton_iterations
        assert table["seed"][i] == planned.seed
        assert table["site_shared"][i] == planned.shared
        np.testing.assert_allclose(table["site"][i], planned.scene.site)
        expected = planned.scene.material.parameters
        assert table["parameter"][i].tolist() == [*expected["mu"], *expected["alpha"], expected["bulk"]]  # type: ignore[misc]
    assert data.attributes["parameter_names"] == ["mu_1", "alpha_1", "bulk"]
    assert data.attributes["scales_with_modulus"] is True


def test_several_shards_hold_the_same_as_one(
    plan: Plan, store: Path, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows keep their positions across the boundaries of chunks and shards."""
    from dataclasses import replace

    small = {
        name: replace(spec, chunk=6, shard=12) if spec.shard > spec.chunk else spec
        for name, spec in schema.SPECS.items()
    }
    monkeypatch.setattr(schema, "SPECS", small)
    standin_build(plan, tmp_path / "b.zarr")
    one, two = open_dataset(store), open_dataset(tmp_path / "b.zarr")
    assert len(list((tmp_path / "b.zarr" / "surface_displacement").rglob("c/*/*"))) > 10
    for name in schema.SPECS:
        np.testing.assert_array_equal(one.array(name)[...], two.array(name)[...], err_msg=name)


def test_a_dataset_without_any_frame(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    codes = ",".join(f"{round(poke.scene.site[0] * 1e6)}" for poke in plan.pokes)
    monkeypatch.setenv("STANDIN_FAIL", codes)
    built = standin_build(plan, tmp_path / "b.zarr")
    assert len(built.errors) == 4
    assert open_dataset(tmp_path / "b.zarr").array("depth").shape == (0,)


def test_results_that_are_not_finite_are_refused(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dataclasses import replace

    real = standin._poke

    def bad(scene: Any) -> Any:
        result = real(scene)
        result.rod_force[1, 0] = np.nan
        return replace(result)

    monkeypatch.setattr(standin, "_poke", bad)
    built = standin_build(plan, tmp_path / "b.zarr")
    assert built.errors[0] == "ValueError: the simulator returned values of rod_force that are not finite"


# --- verify


def test_verify_finds_no_fault(store: Path) -> None:
    result = run(verify_app, [str(store)])
    assert result.exit_code == 0, result.output
    assert "no fault" in result.output


def test_verify_finds_a_flipped_bit_a_lost_and_a_new_file(store: Path) -> None:
    shard = next(
        path for path in (store / "grid_displacement").rglob("*") if path.name == "0" and path.is_file()
    )
    content = bytearray(shard.read_bytes())
    content[len(content) // 2] ^= 1
    shard.write_bytes(content)
    (store / "depth" / "extra").write_text("x")
    (store / "site" / "zarr.json").rename(store / "site" / "gone")
    result = run(verify_app, [str(store), "--show", "20"])
    assert result.exit_code == 1
    name = shard.relative_to(store).as_posix()
    for text in (f"{name}: sha256 differs", "depth/extra: not in the manifest", "site/zarr.json: missing"):
        assert text in result.output


def _edit(name: str, row: int, change: Callable[[Any], Any]) -> Callable[[Dataset, Any], None]:
    def edit(_: Dataset, group: Any) -> None:
        array = group[name]
        values = array[...]
        values[row] = change(values[row])
        array[...] = values

    return edit


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (_edit("base_force", 2, lambda f: 1.02 * f), "base reaction = rod force: poke 0"),
        (_edit("residual", 0, lambda _: 6e-4), "residual above 0.0005"),
        (_edit("min_jacobian", 0, lambda _: -0.1), "an element turned over"),
        (_edit("penetration", 1, lambda _: 6e-4), "penetration above half the edge radius (0.5 mm)"),
        (_edit("depth", 1, lambda d: d + 1e-4), "the tip is off the rod's path"),
        (_edit("depth", 1, lambda d: d - 5e-4), "nearer to the frame before"),
        (_edit("grid_displacement", 1, lambda g: g * np.nan), "grid_displacement: has values that are not"),
        (_edit("frame_count", 1, lambda n: n + 1), "frame: "),
        (_edit("surface_triangle", 0, lambda t: t + 100_000), "a surface triangle has no such node"),
        (_edit("done", 1, lambda _: False), "statuses: poke 1: failed: "),
        (_edit("message", 1, lambda m: 0 * m), "ended as not-converged without a message"),
    ],
)
def test_verify_finds(edit: Callable[..., None], words: str, store: Path) -> None:
    """Faults of the data themselves: the checksums are updated to match."""
    edit(None, zarr.open_group(store=store, mode="r+"))
    write_manifest(store)
    result = run(verify_app, [str(store)])
    assert result.exit_code == 1
    assert words in result.output or words.replace("frame: ", "depth: ") in result.output


def test_verify_of_what_is_no_dataset(tmp_path: Path) -> None:
    for path in (tmp_path / "nothing.zarr", tmp_path):
        result = run(verify_app, [str(path)])
        assert result.exit_code == 2
        assert str(path) in result.stderr
        assert result.stderr.count("\n") == 1


# --- inspect


def test_inspect_shows_what_was_reached_beside_the_paper(store: Path, plan: Plan) -> None:
    result = run(inspect_app, [str(store)])
    assert result.exit_code == 0, result.output
    data = open_dataset(store)
    softness = data.table["poke_softness"][data.table["frame_poke"]]
    depth = data.table["depth"][softness == 0] * 1e3
    for text in ("4 of 4 pokes", plan.uuid, "16.32 +- 6.53", f"{depth.mean():.2f} +- {depth.std():.2f}"):
        assert text in result.output
    assert "not-converged" in result.output
    everything = run(inspect_app, [str(store), "--arrays"]).output
    assert "newton_iterations" in everything


def test_inspect_shows_how_far_a_build_is(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "b.zarr"
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[2].scene.site[0] * 1e6)}")

    def stop(state: BuildProgress) -> None:
        if state.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        standin_build(plan, target, on_progress=stop)
    result = run(inspect_app, [str(target)])
    assert result.exit_code == 0, result.output
    assert "2 of 4 pokes, 1 failed" in result.output
    assert "poke 2 failed: RuntimeError: the stand-in was told to fail" in result.output
    assert "still being built" in run(verify_app, [str(target)]).stderr


def test_picture_of_a_poke(store: Path, tmp_path: Path) -> None:
    picture = tmp_path / "poke.png"
    result = run(inspect_app, [str(store), "--poke", "2", "--picture", str(picture)])
    assert result.exit_code == 0, result.output
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert "cube-18, S1" in result.output


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--poke", "4"], "--poke 4: expected 0 to 3"),
        (["--poke", "1", "--picture", "a.jpg"], "expected a name that ends in .png"),
        (["--picture", "a.png"], "expected --poke N with it"),
    ],
)
def test_bad_calls_of_inspect(arguments: list[str], words: str, store: Path) -> None:
    result = run(inspect_app, [str(store), *arguments])
    assert result.exit_code == 2
    assert words in result.stderr
    assert result.stderr.count("\n") == 1
