"""A damaged store or manifest, or an unusual location: one sentence that names it instead of a traceback."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

from factory import verify_dataset
from factory.build import app as build_app
from factory.building import build as building
from factory.building.build import Built, build_dataset
from factory.errors import InputError
from factory.inspect import app as inspect_app
from factory.plan import Plan
from factory.reader import open_dataset
from factory.store.files import MANIFEST, DamagedError, altered_files, write_manifest
from factory.verify import app as verify_app
from tests.factory.conftest import Builder, digest, run_app


def _attributes(change: Callable[[dict[str, Any]], None]) -> Callable[[Path], None]:
    def edit(store: Path) -> None:
        metadata = json.loads((store / "zarr.json").read_text())
        change(metadata["attributes"])
        (store / "zarr.json").write_text(json.dumps(metadata))

    return edit


def _set(**values: object) -> Callable[[Path], None]:
    return _attributes(lambda attributes: attributes.update(values))


def _drop(*keys: str) -> Callable[[Path], None]:
    return _attributes(lambda attributes: [attributes.pop(key) for key in keys] and None)


BROKEN: dict[str, tuple[Callable[[Path], None], str]] = {
    "no pokes": (_drop("pokes"), "attributes: key pokes: this key is missing"),
    "two gone": (_drop("pokes_done", "uuid"), "keys uuid, pokes_done: these keys are missing"),
    "no fingerprint": (_drop("fingerprint"), "attributes: key fingerprint: this key is missing"),
    "null": (_set(softness=None), "key softness: input should be a valid list"),
    "words": (_set(pokes="four"), "key pokes: input should be a valid integer, got 'four'"),
    "negative": (_set(pokes=-1), "key pokes: "),
    "numbers": (_set(shapes=[1, 2]), "key shapes.0: "),
    "identity gone": (_drop("identity"), "key identity: this key is missing"),
    "identity null": (_set(identity=None), "key identity: "),
    "recipe gone": (_attributes(lambda a: a["identity"].pop("recipe")), "key identity.recipe: "),
    "tolerance": (_set(solver_tolerance="fine"), "key solver_tolerance: "),
    "no attributes": (
        lambda store: (store / "zarr.json").write_text('{"zarr_format": 3, "node_type": "group"}') and None,
        "the file is missing or damaged",
    ),
    "attributes null": (
        lambda store: (store / "zarr.json").write_text('{"attributes": null}') and None,
        "the file is missing or damaged",
    ),
    "torn root": (
        lambda store: (store / "zarr.json").write_text('{"attri') and None,
        "the file is missing or damaged",
    ),
    "deep root": (
        lambda store: (store / "zarr.json").write_text("[" * 100_000) and None,
        "the file is missing or damaged",
    ),
    "no root": (lambda store: (store / "zarr.json").unlink(), "the file is missing or damaged"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_attributes_are_named(name: str, plan: Plan, store: Path, standin_build: Builder) -> None:
    spoil, words = BROKEN[name]
    spoil(store)
    shown = run_app(inspect_app, store)
    assert shown.exit_code == 2
    assert shown.stderr.startswith("error: ")
    assert shown.stderr.count("\n") == 1
    assert words in shown.stderr
    assert run_app(inspect_app, store, "--poke", "0").exit_code == 2
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1  # damage is a fault of the data, not of the call
    assert words in " ".join(verified.output.split())
    assert "checksums" in verified.output
    with pytest.raises(InputError, match=r"the dataset is damaged: give --overwrite"):
        standin_build(plan, store)


@pytest.mark.parametrize("name", ["identity null", "torn root", "no root"])
def test_a_broken_store_is_built_anew_where_that_is_asked(
    name: str, plan: Plan, finished_store: Path, store: Path, standin_build: Builder
) -> None:
    """Overwriting reads no attribute of the damaged store."""
    BROKEN[name][0](store)
    assert standin_build(plan, store, overwrite=True).simulated == 4
    assert digest(store) == digest(finished_store)


def _shard(store: Path, name: str) -> Path:
    return next(path for path in sorted((store / name / "c").rglob("*")) if path.is_file())


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("depth", 0),
        ("message", 7),
        ("frame_count", 0),
        ("frame_count", 7),
        ("poke_softness", 7),
        ("grid_rest", 0),
    ],
)
def test_a_truncated_shard_is_named(name: str, kept: int, store: Path) -> None:
    shard = _shard(store, name)
    shard.write_bytes(shard.read_bytes()[:kept])
    for arguments in ((), ("--poke", "1")):
        shown = run_app(inspect_app, store, *arguments)
        assert shown.exit_code == 2, shown.output
        assert shown.stderr.startswith(f"error: {store / name}: the array cannot be read (")
        assert shown.stderr.count("\n") == 1
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1
    assert "sha256 differs from the manifest" in verified.output
    assert "the array cannot be read" in verified.output


@pytest.mark.parametrize("name", ["surface_displacement", "profile", "grid_displacement"])
def test_a_truncated_shard_of_fields_is_named(name: str, store: Path) -> None:
    shard = _shard(store, name)
    shard.write_bytes(shard.read_bytes()[:7])
    assert run_app(inspect_app, store).exit_code == 0
    shown = run_app(inspect_app, store, "--poke", "0")
    assert shown.exit_code == 2
    assert f"{store / name}: the array cannot be read (" in shown.stderr


@pytest.mark.parametrize("name", ["grid_displacement", "depth", "profile"])
def test_a_missing_chunk_is_not_read_as_zeros(name: str, store: Path) -> None:
    _shard(store, name).unlink()
    with pytest.raises(DamagedError, match=rf"{name}/c.*: missing, and the manifest lists it"):
        open_dataset(store).poke(0)
    shown = run_app(inspect_app, store, "--poke", "0")
    assert shown.exit_code == 2
    assert "missing, and the manifest lists it" in " ".join(shown.stderr.split())
    assert run_app(verify_app, store).exit_code == 1


@pytest.mark.parametrize("name", ["mesh_nodes", "rod_force", "site"])
def test_another_value_in_a_table_is_named(name: str, store: Path) -> None:
    """It decodes without an error, and would be shown as it is."""
    array: Any = zarr.open_group(store=store, mode="r+")[name]
    array[...] = array[...] * 2
    for arguments in ((), ("--poke", "1")):
        shown = run_app(inspect_app, store, *arguments)
        assert shown.exit_code == 2, shown.output
        assert shown.stderr == f"error: {_shard(store, name)}: its sha256 differs from the manifest\n"


FIELDS = ("profile", "grid_displacement", "surface_displacement", "surface_rest", "surface_triangle")


@pytest.mark.parametrize("name", FIELDS)
def test_another_value_in_a_field_is_named_where_a_poke_is_shown(name: str, store: Path) -> None:
    array: Any = zarr.open_group(store=store, mode="r+")[name]
    array[...] = array[...] // 2 if array.dtype.kind in "iu" else array[...] * 2
    shown = run_app(inspect_app, store, "--poke", "1")
    assert shown.exit_code == 2, shown.output
    assert shown.stderr == f"error: {_shard(store, name)}: its sha256 differs from the manifest\n"
    assert run_app(inspect_app, store).exit_code == 0  # tables alone are read


def test_metadata_of_the_root_are_compared(store: Path) -> None:
    """Zarr reads shapes, types and fill values of all arrays from there."""
    text = (store / "zarr.json").read_text()
    (store / "zarr.json").write_text(text.replace('"fill_value": 0', '"fill_value": 1', 1))
    for arguments in ((), ("--poke", "1")):
        shown = run_app(inspect_app, store, *arguments)
        assert shown.exit_code == 2, shown.output
        assert shown.stderr == f"error: {store / 'zarr.json'}: its sha256 differs from the manifest\n"


def test_only_shards_with_rows_of_the_poke_are_compared(tmp_path: Path) -> None:
    names = ["a/zarr.json", "a/c/0/0/0", "a/c/1/0/0", "a/c/1/1/0", "a/c/10/0/0", "ab/c/1/0/0", "zarr.json"]
    (tmp_path / MANIFEST).parent.mkdir()
    (tmp_path / MANIFEST).write_text(json.dumps({"sha256": dict.fromkeys(names, "other")}))
    assert altered_files(tmp_path, {"a": None}) == [*sorted(names[:5]), "zarr.json"]
    assert altered_files(tmp_path, {"a": range(1, 2)}) == [*names[2:4], "a/zarr.json", "zarr.json"]
    assert altered_files(tmp_path, {"a": range(0)}) == ["a/zarr.json", "zarr.json"]


@pytest.mark.parametrize("content", [None, "[1]"])
def test_tables_that_no_manifest_vouches_for_are_not_shown(content: str | None, store: Path) -> None:
    if content is None:
        (store / MANIFEST).unlink()
    else:
        (store / MANIFEST).write_text(content)
    shown = run_app(inspect_app, store)
    assert shown.exit_code == 2
    assert f"{store / MANIFEST}: missing or damaged" in shown.stderr


def _edited(name: str, change: Callable[[Any], Any]) -> Callable[[Path], None]:
    def edit(store: Path) -> None:
        array: Any = zarr.open_group(store=store, mode="r+")[name]
        array[...] = change(array[...])
        write_manifest(store)

    return edit


VALUES: dict[str, tuple[Callable[[Path], None], str]] = {
    "shape of none": (_edited("poke_shape", lambda v: v + 7), ""),
    "level of none": (_edited("poke_softness", lambda v: v - 9), ""),
    "geometry of none": (_edited("poke_geometry", lambda v: v + 70), "geometry 70 is not in the store"),
    "status of none": (_edited("status", lambda v: v + 90), ""),
    "frames beyond": (_edited("frame_count", lambda v: v * 1000), "expected "),
    "frames negative": (_edited("frame_count", lambda v: v * 0 - 5), "expected "),
    "inclusion of none": (_edited("inclusion_kind", lambda v: v + 9), "inclusion of geometry 0"),
    "inclusion of no size": (_edited("inclusion_size", lambda v: v * np.nan), "inclusion of geometry 0"),
}


@pytest.mark.parametrize("name", VALUES)
def test_impossible_values_are_named(name: str, store: Path) -> None:
    spoil, words = VALUES[name]
    spoil(store)
    shown = [run_app(inspect_app, store), run_app(inspect_app, store, "--poke", "0")]
    assert all(s.exit_code in (0, 2) for s in shown)
    assert words in "".join(s.stderr for s in shown)
    if not words:
        assert "unknown (" in "".join(s.output for s in shown)
    assert run_app(verify_app, store).exit_code == 1


def test_an_array_that_is_gone_is_named(store: Path) -> None:
    shutil.rmtree(store / "depth")
    shown = run_app(inspect_app, store)
    assert shown.exit_code == 2
    assert f"{store / 'depth'}: the array " in shown.stderr
    assert run_app(verify_app, store).exit_code == 1


def test_an_array_that_is_cut_is_named(store: Path) -> None:
    file = store / "depth" / "zarr.json"
    metadata = json.loads(file.read_text())
    metadata["shape"] = [2]
    file.write_text(json.dumps(metadata))
    root = json.loads((store / "zarr.json").read_text())
    root["consolidated_metadata"]["metadata"]["depth"]["shape"] = [2]
    (store / "zarr.json").write_text(json.dumps(root))
    shown = run_app(inspect_app, store)
    assert shown.exit_code == 2
    assert "depth: has shape (2,), expected " in shown.stderr
    assert run_app(verify_app, store).exit_code == 1


def test_a_failed_poke_is_shown(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A failed poke has no frame and no surface, so there is nothing to reshape."""
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[1].scene.site[0] * 1e6)}")
    standin_build(plan, tmp_path / "b.zarr")
    assert open_dataset(tmp_path / "b.zarr").poke(1).surface.shape == (0, 0, 3)
    shown = run_app(inspect_app, tmp_path / "b.zarr", "--poke", "1")
    assert shown.exit_code == 0
    assert "failed: RuntimeError: the stand-in was told to fail" in shown.output


# --- the manifest and files beside the arrays


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "is not valid JSON"),
        ("[" * 100_000, "is not valid JSON"),
        ("[]", "expected {"),
        ('{"sha256": null}', "expected {"),
        ('{"sha256": ["a"]}', "expected {"),
    ],
)
def test_a_damaged_manifest_is_named(content: str, words: str, store: Path) -> None:
    (store / MANIFEST).write_text(content)
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1
    assert f"checksums: {MANIFEST}: {words}" in verified.output


def test_a_manifest_may_not_name_files_outside(store: Path) -> None:
    (store.parent / "secret").write_text("secret")
    names = ["../secret", "/etc/passwd", "depth/../../secret", "a//b", "./depth/zarr.json", ""]
    content = json.loads((store / MANIFEST).read_text())
    content["sha256"].update(dict.fromkeys(names, "0" * 64))
    (store / MANIFEST).write_text(json.dumps(content))
    faults = " ".join(verify_dataset(store).faults["checksums"])
    for name in names:
        assert f"names {name!r}, which is not inside of the dataset" in faults


def test_links_are_refused_and_not_followed(store: Path) -> None:
    targets = ["/", "/etc/hostname", "nowhere", "../reference.zarr"]
    for k, target in enumerate(targets):
        (store / "depth" / f"link-{k}").symlink_to(target)
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1
    for k in range(len(targets)):
        assert f"depth/link-{k}: is a symbolic link, which no dataset contains" in verified.output
    assert run_app(inspect_app, store).exit_code == 0


def test_a_pipe_is_refused_and_not_waited_for(store: Path) -> None:
    os.mkfifo(store / "depth" / "pipe")
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1
    assert "depth/pipe: is no plain file" in verified.output


def test_a_linked_shard_is_refused(store: Path) -> None:
    """The link's content, and so its checksum, is right."""
    shard = _shard(store, "depth")
    elsewhere = store.parent / "elsewhere"
    shard.rename(elsewhere)
    shard.symlink_to(elsewhere)
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1
    assert "is a symbolic link" in verified.output
    assert "missing" in verified.output


def test_a_profile_that_is_not_the_inclusion_is_found(store: Path) -> None:
    _edited("inclusion_centre", lambda v: v + 0.004)(store)
    verified = run_app(verify_app, store)
    assert verified.exit_code == 1
    assert "inclusions: geometry 0: the profile's rigid part is not the box described" in verified.output


# --- names, locations, a full disk


@pytest.mark.parametrize(
    ("folder", "name"),
    [("my[red] set", "a b"), ("x[", "b]"), ("a[b]c:smile:", "[link=x]y")],
)
@pytest.mark.usefixtures("unrendered")
def test_names_are_printed_as_they_are(
    folder: str, name: str, tmp_path: Path, serial: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """rich takes [words] in brackets as markup, and "[/b]" of the path x[/b] as its end."""
    del serial
    _standin(monkeypatch)
    place = tmp_path / folder
    place.mkdir()
    target, recipe = place / f"{name}.zarr", place / "tiny.yaml"
    recipe.write_text((tmp_path / "tiny.yaml").read_text())
    arguments = ("--model", "ogden", "--recipe", recipe, "--out", target)
    assert str(target) in run_app(build_app, *arguments, "--dry-run").output
    assert f"{target}: 4 of 4 pokes" in run_app(build_app, *arguments).output
    for shown in (
        run_app(inspect_app, target),
        run_app(inspect_app, target, "--poke", "1"),
        run_app(verify_app, target),
    ):
        assert shown.exit_code == 0
        assert str(target) in shown.output
    gone = run_app(inspect_app, place / "[no].zarr")
    assert f"{place / '[no].zarr'}: no such dataset" in gone.stderr


@pytest.fixture(autouse=True)
def _tiny(tiny_file: Path) -> None:
    del tiny_file  # tmp_path / "tiny.yaml"


def _standin(monkeypatch: pytest.MonkeyPatch) -> None:
    def build(*args: Any, **kwargs: Any) -> Built:
        return build_dataset(*args, **{**kwargs, "simulator": "tests.factory.standin:simulate"})

    monkeypatch.setattr(building, "build_dataset", build)


@pytest.mark.usefixtures("unrendered")
def test_little_room_is_said_before_the_build(
    tmp_path: Path, serial: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    del serial
    _standin(monkeypatch)
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=1000))
    arguments = ("--model", "ogden", "--recipe", tmp_path / "tiny.yaml", "--out", tmp_path / "a.zarr")
    shown = run_app(build_app, *arguments)
    assert shown.exit_code == 0
    assert "0.0 GB are free, and the build is expected to need" in shown.stderr
