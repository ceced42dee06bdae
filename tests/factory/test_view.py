"""A three-dimensional view of a poke of a store, read by the format alone."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest

from factory.reader import open_dataset
from factory.store.archive import release_store
from tisim.view import view_of_file
from tisim.view.command import _bare


def test_a_poke_of_a_store_is_shown(finished_store: Path, tmp_path: Path) -> None:
    shown = view_of_file(finished_store, poke=2)
    poke = open_dataset(finished_store).poke(2)
    assert len(shown.labels) == len(poke.depth)
    assert shown.surfaces[0].positions == pytest.approx(poke.surface, abs=1e-7)
    assert np.array_equal(shown.surfaces[0].triangles, poke.triangles)
    assert f"{np.linalg.norm(poke.rod_force[-1]):.4g} N" in shown.labels[-1]
    zipped = release_store(finished_store, tmp_path / "store.zarr.zip").path
    assert view_of_file(zipped, poke=2).labels == shown.labels
    assert "poke 0" in view_of_file(finished_store).title
    with pytest.raises(ValueError, match="expected one that was simulated, of 4, 9 is none"):
        view_of_file(finished_store, poke=9)


def test_a_poke_that_cannot_be_read_is_one_sentence(finished_store: Path, tmp_path: Path) -> None:
    store = tmp_path / "damaged.zarr"
    shutil.copytree(finished_store, store)
    (chunk,) = [p for p in (store / "surface_displacement" / "c").rglob("*") if p.is_file()][:1]
    content = bytearray(chunk.read_bytes())
    content[40:120] = bytes(80)
    chunk.write_bytes(bytes(content))
    with pytest.raises(ValueError, match=r"damaged\.zarr: poke 0 cannot be read \("):
        view_of_file(store)


def test_a_missing_file_is_not_shown_as_zeros(finished_store: Path, tmp_path: Path) -> None:
    store = tmp_path / "damaged.zarr"
    shutil.copytree(finished_store, store)
    lost = next(p for p in sorted((store / "surface_displacement" / "c").rglob("*")) if p.is_file())
    lost.unlink()
    words = rf"damaged\.zarr: {lost.relative_to(store)} is missing, which its manifest lists"
    with pytest.raises(ValueError, match=words):
        view_of_file(store)
    zipped = tmp_path / "damaged.zarr.zip"
    with zipfile.ZipFile(zipped, "w") as archive:
        for file in sorted(p for p in store.rglob("*") if p.is_file()):
            archive.write(file, file.relative_to(store))
    with pytest.raises(ValueError, match=words.replace("zarr:", "zarr\\.zip:")):
        view_of_file(zipped)
    (store / "provenance" / "manifest.json").write_text("{")
    with pytest.raises(ValueError, match=r"damaged\.zarr: provenance/manifest\.json cannot be read \("):
        view_of_file(store)


def test_a_page_has_its_files_whole_name() -> None:
    assert [_bare(n) for n in ("G=1.5kPa.vtu", "quick.zarr.zip", "quick.zarr", "a.b")] == [
        "G=1.5kPa",
        "quick",
        "quick",
        "a.b",
    ]
