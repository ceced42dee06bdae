"""The run's own part of a page, saved as a zip, from which the same page is made later."""

from __future__ import annotations

import importlib.util
import json
import zipfile
from pathlib import Path

import pytest

from learn.page import command
from learn.page.document import Parts, parts_of
from learn.predictor import Predictor
from learn.training.run_folder import write_whole
from tests.learn.commands import call, refused

NEEDED = ("onnx", "onnxscript", "onnxruntime")
pytestmark = pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in NEEDED),
    reason=f"one of {', '.join(NEEDED)} is not installed",
)


@pytest.fixture(scope="module")
def saved(predictor: Predictor, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("parts") / "poke.zip"
    done = call(command.app, predictor.run.folder, "--shape", "shape-0", "--pokes", 1, "--parts", path)
    assert done.exit_code == 0, done.output
    return path


def test_the_page_from_the_zip_is_the_page_from_the_run(
    predictor: Predictor, saved: Path, tmp_path: Path
) -> None:
    done = call(command.app, saved, "--out", tmp_path / "later.html")
    assert done.exit_code == 0, done.output
    assert "2 interiors, 1 simulated poke of" in done.output
    now = parts_of(predictor, shapes=["shape-0"], pokes=1).write(tmp_path / "now.html")
    assert now.path.read_bytes() == (tmp_path / "later.html").read_bytes()
    assert saved.stat().st_size < 0.3 * now.gzipped
    again = tmp_path / "again.zip"
    Parts.load(saved).save(again)
    assert again.read_bytes() == saved.read_bytes()


def _without(saved: Path, path: Path, name: str, content: bytes | None) -> Path:
    """Copy of the zip with other content of one member, or without it."""
    with zipfile.ZipFile(saved) as old, zipfile.ZipFile(path, "w") as new:
        for member in old.namelist():
            found = old.read(member) if member != name else content
            if found is not None:
                new.writestr(member, found)
    return path


def test_what_is_no_zip_of_parts_is_refused(saved: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(saved) as file:
        stated = json.loads(file.read("page.json"))
    bare = json.dumps({**stated, "about": {}}).encode()
    (tmp_path / "text.zip").write_text("no zip")
    locked = bytearray(saved.read_bytes())
    locked[locked.index(b"PK\x01\x02") + 8] |= 1  # the first entry's bit of encryption
    (tmp_path / "locked.zip").write_bytes(locked)
    cases = {
        tmp_path / "locked.zip": "expected the parts of a page",
        tmp_path / "none.zip": "expected the parts of a page",
        tmp_path / "text.zip": "expected the parts of a page",
        _without(saved, tmp_path / "less.zip", "poke.onnx", None): "expected the parts of a page",
        _without(saved, tmp_path / "more.zip", "page.json", json.dumps({**stated, "x": 1}).encode()): "key x",
        _without(saved, tmp_path / "bad.zip", "page.json", b"{"): "page.json",
        _without(saved, tmp_path / "bare.zip", "page.json", bare): "page.json: key about.arrays: this key is",
    }
    for path, sentence in cases.items():
        refused(call(command.app, path, "--out", tmp_path / "out.html"), str(path), sentence)
    refused(call(command.app, saved, "--shape", "shape-0"), "its content is settled")
    refused(call(command.app, saved, "--pokes", 8), "its content is settled")
    assert not (tmp_path / "out.html").exists()


def test_a_folder_is_no_file_to_write(tmp_path: Path) -> None:
    for flag in ("--out", "--parts"):
        refused(call(command.app, tmp_path, flag, "."), f"{flag} .: expected the name of a file")
    with pytest.raises(IsADirectoryError):
        write_whole(Path(), b"")
