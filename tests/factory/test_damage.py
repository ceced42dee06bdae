"""Damaged targets: one sentence in place of a traceback, damaged results simulated again, nothing lost."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from typer.testing import CliRunner, Result

from factory import _build
from factory._build import BuildProgress, Built, build_dataset
from factory._input import InputError
from factory._staging import Staging, building_folder
from factory._store import MANIFEST, write_manifest
from factory.build import app as build_app
from factory.inspect import app as inspect_app
from factory.plan import Plan
from factory.reader import open_dataset
from factory.verify import app as verify_app
from tests.factory.conftest import Builder, digest


def run(app: Any, *arguments: object) -> Result:
    """A command that must not end in a traceback."""
    result = CliRunner().invoke(app, [str(a) for a in arguments], env={"COLUMNS": "300"})
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


@pytest.fixture
def store(finished_store: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(finished_store, tmp_path / "reference.zarr"))


@pytest.fixture
def stopped(plan: Plan, standin_build: Builder, tmp_path: Path) -> Callable[[], Path]:
    """A build that was stopped after three of its four pokes."""

    def stop(state: BuildProgress) -> None:
        if state.done == 3:
            raise KeyboardInterrupt

    def make() -> Path:
        target = tmp_path / "stopped.zarr"
        with pytest.raises(KeyboardInterrupt):
            standin_build(plan, target, on_progress=stop)
        return target

    return make


def _torn(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-2000])


def _empty(path: Path) -> None:
    path.write_bytes(b"")


def _words(path: Path) -> None:
    path.write_text("my thesis\n" * 100)


def _flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def _folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def _other_poke(path: Path) -> None:
    shutil.copyfile(path.with_name("poke-00000.npz"), path)


def _rewritten(change: Callable[[dict[str, Any]], None]) -> Callable[[Path], None]:
    def rewrite(path: Path) -> None:
        with np.load(path) as kept:
            arrays = dict(kept)
        change(arrays)
        buffer = io.BytesIO()
        np.savez(buffer, **arrays)
        path.write_bytes(buffer.getvalue())

    return rewrite


def _unnamed_other(path: Path) -> None:
    """Another poke's result as an earlier version staged it: without the number of its poke."""
    _other_poke(path)
    _rewritten(lambda arrays: arrays.pop("poke"))(path)


def _pickled(path: Path) -> None:
    buffer = io.BytesIO()
    np.savez(buffer, depth=np.array([{"a": 1}], dtype=object))
    path.write_bytes(buffer.getvalue())


DAMAGE: dict[str, tuple[Callable[[Path], None], str]] = {
    "torn": (_torn, "zip"),
    "empty": (_empty, "No data left in file"),
    "no zip": (_words, "pickled"),
    "flipped bit": (_flipped, ""),
    "folder": (_folder, "Is a directory"),
    "of another poke": (_other_poke, "is the result of poke 0"),
    "of another scene": (_unnamed_other, "is the result of another scene"),
    "array gone": (_rewritten(lambda a: a.pop("rod_tip")), "has no array"),
    "array cut": (_rewritten(lambda a: a.update(depth=a["depth"][:-1])), "has type float64 and shape"),
    "array of words": (_rewritten(lambda a: a.update(status=np.array("x"))), "array status has type"),
    "not finite": (_rewritten(lambda a: a["rod_force"].__setitem__((0, 0), np.nan)), "not finite"),
    "unknown status": (_rewritten(lambda a: a.update(status=np.uint8(99))), "status 99 is unknown"),
    "triangle": (_rewritten(lambda a: a["surface_triangle"].__setitem__((0, 0), 10**6)), "no such node"),
    "pickle": (_pickled, ""),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_a_damaged_result_is_set_aside_and_simulated_again(
    name: str,
    plan: Plan,
    store: Path,
    stopped: Callable[[], Path],
    standin_build: Builder,
    caplog: pytest.LogCaptureFixture,
) -> None:
    target = stopped()
    spoil, words = DAMAGE[name]
    spoil(Staging(target).result_path(1))
    shown = run(inspect_app, target)
    assert shown.exit_code == 0
    built = standin_build(plan, target)
    assert (built.simulated, built.damaged, built.errors) == (2, (1,), {})
    assert "set aside as poke-00001.damaged-1, the poke is simulated again" in caplog.text
    assert words in caplog.text
    assert digest(target) == digest(store)


def test_inspect_names_a_damaged_result(stopped: Callable[[], Path]) -> None:
    target = stopped()
    _torn(Staging(target).result_path(1))
    shown = run(inspect_app, target)
    assert "2 of 4 pokes, 0 failed, 1 damaged" in shown.output
    assert "poke 1: its staged result is damaged (" in shown.output


def test_a_result_that_is_damaged_while_the_store_is_written(
    plan: Plan, store: Path, standin_build: Builder, tmp_path: Path
) -> None:
    target, calls = tmp_path / "a.zarr", []

    def spoil(state: BuildProgress) -> None:
        calls.append(state.done)
        if calls == [0, 1, 2, 3, 4]:
            _torn(state.staging.result_path(2))

    built = standin_build(plan, target, on_progress=spoil)
    assert (built.simulated, built.damaged) == (5, (2,))
    assert digest(target) == digest(store)


def test_a_disk_that_damages_everything_ends_the_build(
    plan: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    def spoil(state: BuildProgress) -> None:
        if state.done == 4:
            _torn(state.staging.result_path(2))

    with pytest.raises(InputError, match=r"staged result of poke 2: .*3 times in a row; is the disk sound"):
        standin_build(plan, tmp_path / "a.zarr", on_progress=spoil)
    assert Staging(tmp_path / "a.zarr").finished() == {0, 1, 2, 3}


def test_foreign_files_among_the_results(
    plan: Plan, store: Path, stopped: Callable[[], Path], standin_build: Builder
) -> None:
    target = stopped()
    results = Staging(target).results
    for name in ("poke-abc.npz", "poke-0000001.npz", "thesis.txt", "poke-00001.damaged-1"):
        (results / name).write_text("precious")
    shutil.copyfile(results / "poke-00000.npz", results / "poke-00099.npz")  # beyond the plan
    (results / "poke-00003.error").write_bytes(b"\xff\xfe torn")
    assert "1 damaged" in run(inspect_app, target).output
    built = standin_build(plan, target)
    assert (built.simulated, built.damaged) == (1, (99,))
    assert digest(target) == digest(store)


LEDGERS = [
    b"",
    b"\xff\xfe\x00",
    b'[1, 2]\nnull\n3\n"x"\n' + b"[" * 100_000 + b"\n",
    b'{"poke": "0", "wall_seconds": 1}\n{"poke": 0}\n{"poke": true, "wall_seconds": 1}\n',
    b'{"poke": 0, "wall_seconds": "long", "error": null}\n{"poke": 1, "wall_seconds": null}\n',
    b'{"poke": 0, "wall_seconds": NaN}\n{"poke": 1, "wall_seconds": 1e999}\n{"poke": 1, "wall_seconds": -3}',
    b'{"poke": 0, "wall_seconds": 1.0, "core_seconds": {}, "error": 5}\n',
]


@pytest.mark.parametrize("ledger", LEDGERS, ids=[str(i) for i in range(len(LEDGERS))])
def test_an_edited_ledger_stops_nobody(
    ledger: bytes, plan: Plan, store: Path, stopped: Callable[[], Path]
) -> None:
    target = stopped()
    Staging(target).ledger_file.write_bytes(ledger)
    assert run(inspect_app, target).exit_code == 0
    recipe = target.parent / "tiny.yaml"
    arguments = ("--model", "ogden", "--recipe", recipe, "--out", target)
    assert run(build_app, *arguments, "--dry-run").exit_code == 0
    (store / "provenance" / "ledger.jsonl").write_bytes(ledger)
    assert run(inspect_app, store).exit_code == 0
    assert run(verify_app, store).exit_code == 0
    del plan


@pytest.mark.parametrize(
    "content", [b"", b"{", b"null", b"[]", b"3", b"\xff", b"[" * 100_000], ids=[str(i) for i in range(7)]
)
def test_a_damaged_plan_file_is_named(
    content: bytes, plan: Plan, stopped: Callable[[], Path], standin_build: Builder
) -> None:
    target = stopped()
    file = Staging(target).plan_file
    file.write_bytes(content)
    with pytest.raises(InputError, match=re.escape(f"{file}: is damaged: give --overwrite")):
        standin_build(plan, target)
    assert Staging(target).finished() == {0, 1, 2}  # nothing is lost by asking
    shown = run(inspect_app, target)
    assert shown.exit_code == 2
    assert shown.stderr.startswith(f"error: {file}: ")
    assert standin_build(plan, target, overwrite=True).simulated == 4


def test_inspect_names_what_is_wrong_in_a_plan_file(stopped: Callable[[], Path]) -> None:
    target = stopped()
    file = Staging(target).plan_file
    identity = json.loads(file.read_text())
    del identity["recipe"]["softness"], identity["recipe"]["protocol"]
    file.write_text(json.dumps(identity))
    shown = run(inspect_app, target)
    assert shown.exit_code == 2
    assert "keys recipe.protocol, recipe.softness: these keys are missing" in shown.stderr


# --- finished stores


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
def test_broken_attributes_are_named(
    name: str, plan: Plan, store: Path, standin_build: Builder, tmp_path: Path
) -> None:
    target = tmp_path / "a.zarr"
    shutil.copytree(store, target)
    spoil, words = BROKEN[name]
    spoil(target)
    shown = run(inspect_app, target)
    assert shown.exit_code == 2
    assert shown.stderr.startswith("error: ")
    assert shown.stderr.count("\n") == 1
    assert words in shown.stderr
    assert run(inspect_app, target, "--poke", "0").exit_code == 2
    verified = run(verify_app, target)
    assert verified.exit_code == 1  # damage is a fault of the data, not of the call
    assert words in " ".join(verified.output.split())
    assert "checksums" in verified.output
    with pytest.raises(InputError, match=r"the dataset is damaged: give --overwrite"):
        standin_build(plan, target)
    built = standin_build(plan, target, overwrite=True)
    assert built.simulated == 4
    assert digest(target) == digest(store)


def _shard(store: Path, name: str) -> Path:
    return next(path for path in sorted((store / name / "c").rglob("*")) if path.is_file())


@pytest.mark.parametrize("name", ["depth", "message", "frame_count", "poke_softness", "grid_rest"])
@pytest.mark.parametrize("kept", [0, 7])
def test_a_truncated_shard_is_named(name: str, kept: int, store: Path) -> None:
    shard = _shard(store, name)
    shard.write_bytes(shard.read_bytes()[:kept])
    for arguments in ((), ("--poke", "1")):
        shown = run(inspect_app, store, *arguments)
        assert shown.exit_code == 2, shown.output
        assert shown.stderr.startswith(f"error: {store / name}: the array cannot be read (")
        assert shown.stderr.count("\n") == 1
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert "sha256 differs from the manifest" in verified.output
    assert "the array cannot be read" in verified.output


@pytest.mark.parametrize("name", ["surface_displacement", "profile", "grid_displacement"])
def test_a_truncated_shard_of_fields_is_named(name: str, store: Path) -> None:
    shard = _shard(store, name)
    shard.write_bytes(shard.read_bytes()[:7])
    assert run(inspect_app, store).exit_code == 0
    shown = run(inspect_app, store, "--poke", "0")
    assert shown.exit_code == 2
    assert f"{store / name}: the array cannot be read (" in shown.stderr


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
    shown = [run(inspect_app, store), run(inspect_app, store, "--poke", "0")]
    assert all(s.exit_code in (0, 2) for s in shown)
    assert words in "".join(s.stderr for s in shown)
    if not words:
        assert "unknown (" in "".join(s.output for s in shown)
    assert run(verify_app, store).exit_code == 1


def test_an_array_that_is_gone_is_named(store: Path) -> None:
    shutil.rmtree(store / "depth")
    shown = run(inspect_app, store)
    assert shown.exit_code == 2
    assert f"{store / 'depth'}: the array " in shown.stderr
    assert run(verify_app, store).exit_code == 1


def test_an_array_that_is_cut_is_named(store: Path) -> None:
    file = store / "depth" / "zarr.json"
    metadata = json.loads(file.read_text())
    metadata["shape"] = [2]
    file.write_text(json.dumps(metadata))
    root = json.loads((store / "zarr.json").read_text())
    root["consolidated_metadata"]["metadata"]["depth"]["shape"] = [2]
    (store / "zarr.json").write_text(json.dumps(root))
    shown = run(inspect_app, store)
    assert shown.exit_code == 2
    assert "depth: has shape (2,), expected " in shown.stderr
    assert run(verify_app, store).exit_code == 1


def test_a_failed_poke_is_shown(
    plan: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no frame and no surface: there is nothing to reshape."""
    monkeypatch.setenv("STANDIN_FAIL", f"{round(plan.pokes[1].scene.site[0] * 1e6)}")
    standin_build(plan, tmp_path / "b.zarr")
    assert open_dataset(tmp_path / "b.zarr").poke(1).surface.shape == (0, 0, 3)
    shown = run(inspect_app, tmp_path / "b.zarr", "--poke", "1")
    assert shown.exit_code == 0
    assert "failed: RuntimeError: the stand-in was told to fail" in shown.output


# --- the manifest and what lies beside the arrays


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
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert f"checksums: {MANIFEST}: {words}" in verified.output


@pytest.mark.parametrize(
    "name", ["../secret", "/etc/passwd", "depth/../../secret", "a//b", "./depth/zarr.json", ""]
)
def test_a_manifest_may_not_name_files_outside(name: str, store: Path) -> None:
    (store.parent / "secret").write_text("secret")
    content = json.loads((store / MANIFEST).read_text())
    content["sha256"][name] = "0" * 64
    (store / MANIFEST).write_text(json.dumps(content))
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert f"names {name!r}, which is not inside of the dataset" in verified.output


@pytest.mark.parametrize("target", ["/", "/etc/hostname", "nowhere", "../reference.zarr"])
def test_links_are_refused_and_not_followed(target: str, store: Path) -> None:
    (store / "depth" / "link").symlink_to(target)
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert "files: depth/link: is a symbolic link, which no dataset contains" in verified.output
    assert run(inspect_app, store).exit_code == 0


def test_a_pipe_is_refused_and_not_waited_for(store: Path) -> None:
    os.mkfifo(store / "depth" / "pipe")
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert "depth/pipe: is no plain file" in verified.output


def test_a_linked_shard_is_refused(store: Path) -> None:
    """Its content is right, so that its checksum would be."""
    shard = _shard(store, "depth")
    elsewhere = store.parent / "elsewhere"
    shard.rename(elsewhere)
    shard.symlink_to(elsewhere)
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert "is a symbolic link" in verified.output
    assert "missing" in verified.output


def test_a_profile_that_is_not_the_inclusion_is_found(store: Path) -> None:
    _edited("inclusion_centre", lambda v: v + 0.004)(store)
    verified = run(verify_app, store)
    assert verified.exit_code == 1
    assert "inclusions: geometry 0: the profile's rigid part is not the box described" in verified.output


# --- names, places, a full disk


@pytest.mark.parametrize(
    ("folder", "name"),
    [("my[red]set", "a"), ("x[", "b]"), ("a[b]c", "a[b]c"), (":smile:", "[link=x]y"), ("my set", "a b")],
)
def test_names_are_printed_as_they_are(
    folder: str, name: str, tmp_path: Path, serial: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """rich takes [words] in brackets for markup, "[/b]" of the path x[/b] for its end."""
    del serial
    _standin(monkeypatch)
    place = tmp_path / folder
    place.mkdir()
    target, recipe = place / f"{name}.zarr", place / "tiny.yaml"
    recipe.write_text((tmp_path / "tiny.yaml").read_text())
    arguments = ("--model", "ogden", "--recipe", recipe, "--out", target)
    assert str(target) in run(build_app, *arguments, "--dry-run").output
    assert f"{target}: 4 of 4 pokes" in run(build_app, *arguments).output
    for shown in (run(inspect_app, target), run(inspect_app, target, "--poke", "1"), run(verify_app, target)):
        assert shown.exit_code == 0
        assert str(target) in shown.output
    gone = run(inspect_app, place / "[no].zarr")
    assert f"{place / '[no].zarr'}: no such dataset" in gone.stderr


@pytest.fixture(autouse=True)
def _tiny(tiny_file: Path) -> None:
    del tiny_file  # tmp_path / "tiny.yaml"


def _standin(monkeypatch: pytest.MonkeyPatch) -> None:
    def build(*args: Any, **kwargs: Any) -> Built:
        return build_dataset(*args, **{**kwargs, "simulator": "tests.factory.standin:simulate"})

    monkeypatch.setattr(_build, "build_dataset", build)


def test_little_room_is_said_before_the_build(
    tmp_path: Path, serial: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    del serial
    _standin(monkeypatch)
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=1000))
    arguments = ("--model", "ogden", "--recipe", tmp_path / "tiny.yaml", "--out", tmp_path / "a.zarr")
    shown = run(build_app, *arguments)
    assert shown.exit_code == 0
    assert "0.0 GB are free, and the build is expected to need" in shown.stderr


def test_a_link_in_the_building_folder_is_removed_not_followed(
    plan: Plan, stopped: Callable[[], Path], standin_build: Builder, tmp_path: Path
) -> None:
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("precious")
    target = stopped()
    (building_folder(target) / "link").symlink_to(precious)
    standin_build(plan, target)
    assert not building_folder(target).exists()
    assert (precious / "thesis.txt").exists()
