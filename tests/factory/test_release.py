"""One zip of a store: the same bytes for the same store, as in the manifest, complete or absent."""

from __future__ import annotations

import hashlib
import os
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest

import factory.card
import factory.inspect
import factory.release
import factory.verify
from factory import open_dataset
from factory.store import archive as store_archive
from factory.store.files import LEDGER
from tests.factory.conftest import digest, run_app


@pytest.fixture(scope="module")
def released(finished_store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The zip of the finished store; no test changes it."""
    target = tmp_path_factory.mktemp("released") / "store.zarr.zip"
    result = run_app(factory.release.app, finished_store, "--out", target)
    assert result.exit_code == 0, result.output
    return target


def test_the_zip_holds_the_store_and_its_sum(released: Path, finished_store: Path) -> None:
    with zipfile.ZipFile(released) as archive:
        entries = archive.infolist()
        found = {e.filename: hashlib.sha256(archive.read(e)).hexdigest() for e in entries}
    ledger = hashlib.sha256((finished_store / LEDGER).read_bytes()).hexdigest()
    assert found == {**digest(finished_store), LEDGER: ledger}
    assert [e.filename for e in entries] == sorted(found)
    assert {e.compress_type for e in entries} == {zipfile.ZIP_STORED}
    text = released.with_name("store.zarr.zip.sha256").read_text()
    assert text == f"{hashlib.sha256(released.read_bytes()).hexdigest()}  store.zarr.zip\n"
    assert {p.name for p in released.parent.iterdir()} == {"store.zarr.zip", "store.zarr.zip.sha256"}


def test_the_same_store_gives_the_same_bytes(released: Path, store: Path, tmp_path: Path) -> None:
    """Dates, permissions and order of the files on disk differ."""
    other = tmp_path / "other.zarr"
    for path in sorted(store.rglob("*"), reverse=True):
        if path.is_file():
            (other / path.relative_to(store)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, other / path.relative_to(store))
            (other / path.relative_to(store)).chmod(0o600)
            os.utime(other / path.relative_to(store), (1.2e9, 1.2e9))
    target = tmp_path / "again.zarr.zip"
    assert run_app(factory.release.app, other, "--out", target).exit_code == 0
    assert target.read_bytes() == released.read_bytes()


def test_the_zip_is_read_as_the_folder(released: Path, finished_store: Path) -> None:
    folder, zipped = open_dataset(finished_store), open_dataset(released)
    assert zipped.attributes == folder.attributes
    for index in range(folder.n_pokes):
        a, b = folder.poke(index), zipped.poke(index)
        for name in ("depth", "rod_force", "grid", "surface", "triangles", "profile"):
            assert np.array_equal(getattr(a, name), getattr(b, name)), name
    assert zipped.size_of() == folder.size_of()
    assert zipped.size_of("depth") == folder.size_of("depth") > 0


def test_other_commands_take_the_zip(released: Path, tmp_path: Path) -> None:
    result = run_app(factory.verify.app, released)
    assert (result.exit_code, "4 pokes" in result.stdout) == (0, True), result.output
    assert "finished: 4 of 4 pokes" in run_app(factory.inspect.app, released).stdout
    result = run_app(factory.card.app, released, "--out", tmp_path / "card")
    assert result.exit_code == 0, result.output
    assert "| completed | not recorded |" in (tmp_path / "card" / "card.md").read_text()


def test_a_damaged_zip_is_found(released: Path, tmp_path: Path) -> None:
    """A changed byte of an array, an additional entry, half of a file."""
    with zipfile.ZipFile(released) as archive:
        name = next(n for n in archive.namelist() if n.startswith("depth/c"))
        content = archive.read(name)
    whole = released.read_bytes()
    assert whole.count(content) == 1
    bad = tmp_path / "bad.zarr.zip"
    bad.write_bytes(whole.replace(content, content[:-1] + bytes([content[-1] ^ 1])))
    assert store_archive.zip_faults(bad) == [f"{name}: sha256 differs from the manifest"]
    assert run_app(factory.verify.app, bad).exit_code == 1
    bad.write_bytes(whole)
    with zipfile.ZipFile(bad, "a") as archive:
        archive.writestr("depth/more", "x")
    assert store_archive.zip_faults(bad) == ["depth/more: not in the manifest"]
    bad.write_bytes(whole[: len(whole) // 2])
    result = run_app(factory.inspect.app, bad)
    assert (result.exit_code, "cannot be read as a zip" in result.stderr) == (2, True), result.output


def test_a_damaged_store_gives_no_zip(store: Path, tmp_path: Path) -> None:
    file = next(path for path in sorted((store / "depth").rglob("*")) if path.is_file() and "c" in path.parts)
    file.write_bytes(file.read_bytes()[:-1] + b"?")
    result = run_app(factory.release.app, store, "--out", tmp_path / "a.zarr.zip")
    assert result.exit_code == 2
    assert "the dataset is damaged: depth/" in result.stderr
    assert result.stderr.count("\n") == 1
    assert [p.name for p in tmp_path.iterdir()] == [store.name]


def test_a_store_that_changes_on_the_way_gives_no_zip(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The written content, not the content as read, is compared with the manifest."""
    sound = store_archive.check_sound

    def change(path: Path) -> None:
        sound(path)
        (path / "depth" / "zarr.json").write_text("{}")

    monkeypatch.setattr(store_archive, "check_sound", change)
    result = run_app(factory.release.app, store, "--out", tmp_path / "a.zarr.zip")
    assert result.exit_code == 2
    assert "depth/zarr.json: sha256 differs from the manifest" in result.stderr
    assert [p.name for p in tmp_path.iterdir()] == [store.name]


@pytest.mark.parametrize(
    ("out", "sentence"),
    [
        ("a.zip", "expected a name that ends in .zarr.zip"),
        ("there.zarr.zip", "exists already"),
        ("reference.zarr/a.zarr.zip", "lies in the store"),
        ("nowhere/a.zarr.zip", "expected a folder that exists"),
    ],
)
def test_targets_that_are_refused(out: str, sentence: str, store: Path, tmp_path: Path) -> None:
    (tmp_path / "there.zarr.zip").write_text("mine")
    before = digest(store)
    result = run_app(factory.release.app, store, "--out", tmp_path / out)
    assert (result.exit_code, sentence in result.stderr) == (2, True), result.stderr
    assert result.stderr.count("\n") == 1
    assert digest(store) == before
    assert {p.name for p in tmp_path.iterdir()} == {store.name, "there.zarr.zip"}
    assert (tmp_path / "there.zarr.zip").read_text() == "mine"


def test_an_interrupted_release_begins_anew(
    released: Path, finished_store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C during the comparison; then the remains of a kill: half of a file, and a sum without a zip."""
    target = tmp_path / "store.zarr.zip"

    def interrupt(_path: Path) -> list[str]:
        assert not target.exists()
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(store_archive, "zip_faults", interrupt)
        result = run_app(factory.release.app, finished_store, "--out", target)
    assert (result.exit_code, list(tmp_path.iterdir())) == (130, [])
    (tmp_path / "store.zarr.zip.0a1b2c3d.part").write_bytes(released.read_bytes()[:1000])
    shutil.copy(released.with_name("store.zarr.zip.sha256"), tmp_path)
    assert run_app(factory.release.app, finished_store, "--out", target).exit_code == 0
    assert target.read_bytes() == released.read_bytes()
    assert {p.name for p in tmp_path.iterdir()} == {"store.zarr.zip", "store.zarr.zip.sha256"}


def test_a_sum_of_another_file_is_not_replaced(finished_store: Path, tmp_path: Path) -> None:
    (tmp_path / "a.zarr.zip.sha256").write_text("mine")
    result = run_app(factory.release.app, finished_store, "--out", tmp_path / "a.zarr.zip")
    assert (result.exit_code, "states another sum" in result.stderr) == (2, True)
    assert [p.name for p in tmp_path.iterdir()] == ["a.zarr.zip.sha256"]
