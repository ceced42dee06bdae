"""A store in one zip, as published, is read like its folder."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from learn.data import MemoryDataset, StreamDataset, open_store
from learn.data._files import displacement_reader
from learn.errors import InputError
from learn.predictor import load
from learn.training import load_run
from tests.learn.commands import train_small
from tests.learn.small_store import write_store


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_store(tmp_path_factory.mktemp("store") / "small.zarr")


def zipped(
    folder: Path,
    target: Path,
    *,
    compression: int = zipfile.ZIP_STORED,
    change: Callable[[str, bytes], bytes | None] = lambda _, content: content,
) -> Path:
    with zipfile.ZipFile(target, "w", compression) as archive:
        for path in sorted(p for p in folder.rglob("*") if p.is_file()):
            name = path.relative_to(folder).as_posix()
            content = change(name, path.read_bytes())
            if content is not None:
                archive.writestr(name, content)
    return target


@pytest.mark.parametrize("compression", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])
def test_it_is_read_as_the_folder_is(folder: Path, tmp_path: Path, compression: int) -> None:
    path = zipped(folder, tmp_path / "small.zarr.zip", compression=compression)
    one, other = open_store(path), open_store(folder)
    assert one.uuid == other.uuid
    assert np.array_equal(one.rod_force, other.rod_force)
    rows = np.arange(3, one.frames, 2)
    assert np.array_equal(MemoryDataset(one, rows)._displacement, MemoryDataset(other, rows)._displacement)
    assert np.array_equal(one.displacement(slice(1, 5)), other.displacement(slice(1, 5)))


def test_it_streams_the_same_batches(folder: Path, tmp_path: Path) -> None:
    path = zipped(folder, tmp_path / "small.zarr.zip")
    rows = np.arange(open_store(folder).frames)
    each = [
        [batch.displacement.numpy() for batch in StreamDataset(str(place), rows, batch=4, seed=1)]
        for place in (path, folder)
    ]
    assert len(each[0]) > 1
    assert all(np.array_equal(a, b) for a, b in zip(*each, strict=True))


def test_what_was_not_compressed_is_read_without_zarr(folder: Path, tmp_path: Path) -> None:
    path = zipped(folder, tmp_path / "small.zarr.zip")
    reader = displacement_reader(str(path))
    assert reader is not None
    found = np.empty((12, *reader.row), dtype=np.float32)
    reader.read(1, 13, found)
    assert np.array_equal(found.reshape(12, 1024, 3), open_store(folder).displacement(slice(1, 13)))
    packed = zipped(folder, tmp_path / "packed.zarr.zip", compression=zipfile.ZIP_DEFLATED)
    assert displacement_reader(str(packed)) is None


def test_it_can_be_trained_on(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Training works with a relative path, and later from another folder."""
    path = zipped(folder, tmp_path / "small.zarr.zip")
    monkeypatch.chdir(tmp_path)
    run = train_small(Path(path.name), tmp_path / "run")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert load_run(run).uuid == open_store(folder).uuid
    answer = load(run).predict({"site_mm": [0, 0], "depth_mm": 2, "softness": "S0", "shape": "shape-1"})
    assert answer.force > 0


def _altered(name: str, content: bytes) -> bytes:
    return content[:-1] + bytes([content[-1] ^ 1]) if name.startswith("rod_force/c") else content


def _without_a_chunk(name: str, content: bytes) -> bytes | None:
    return None if name.startswith("rod_force/c") else content


def _without_a_manifest(name: str, content: bytes) -> bytes | None:
    return None if name == "provenance/manifest.json" else content


def _without_a_root(name: str, content: bytes) -> bytes | None:
    return None if name == "zarr.json" else content


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (_altered, r"small\.zarr\.zip: rod_force/c/\S* was altered"),
        (_without_a_chunk, r"small\.zarr\.zip: rod_force/c/\S* is missing, the store is incomplete"),
        (
            _without_a_manifest,
            r"small\.zarr\.zip: provenance/manifest\.json: cannot be read \(No such file\)",
        ),
        (_without_a_root, r"small\.zarr\.zip: no dataset there \(expected the zip of a store\)"),
    ],
)
def test_damaged_zips_are_one_sentence(
    folder: Path, tmp_path: Path, change: Callable[[str, bytes], bytes | None], words: str
) -> None:
    path = zipped(folder, tmp_path / "small.zarr.zip", change=change)
    with pytest.raises(InputError, match=words):
        open_store(path)


def test_a_file_that_is_no_zip_is_refused(folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "small.zarr.zip"
    shutil.copy(folder / "zarr.json", path)
    with pytest.raises(InputError, match=r"small\.zarr\.zip: cannot be read \(File is not a zip file\)"):
        open_store(path)
