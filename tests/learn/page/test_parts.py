"""The run's own part of a page, saved as a zip: what is said of it, and what is refused.

`test_browser` states that the same page is made from it.
"""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

from learn.page import command, document
from learn.page.content import content_of
from learn.page.document import Parts
from learn.page.simulated import shortage
from learn.predictor import Predictor
from learn.training.run_folder import write_whole
from tests.learn.commands import call, refused


@pytest.fixture(scope="module")
def saved(predictor: Predictor, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A zip with no network in it, which would take longest and is none of what is stated here."""
    path = tmp_path_factory.mktemp("parts") / "poke.zip"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(document, "write_page_graph", lambda _part, _example, path: path.write_bytes(b"graph"))
        done = call(command.app, predictor.run.folder, "--shape", "shape-0", "--pokes", 1, "--parts", path)
    assert done.exit_code == 0, done.output
    return path


@pytest.fixture
def without_graph(monkeypatch: pytest.MonkeyPatch, saved: Path) -> None:
    """The command makes the content of a page, and takes its graph from `saved`."""

    def parts(predictor: Predictor, *, shapes: list[str] | None, pokes: int) -> Parts:
        content_of(predictor, shapes=shapes, pokes=pokes)
        return Parts.load(saved)

    monkeypatch.setattr(document, "parts_of", parts)


@pytest.mark.usefixtures("without_graph")
def test_fewer_simulated_pokes_than_asked_for_are_explained(predictor: Predictor, tmp_path: Path) -> None:
    [trained, *_], [tested] = (predictor.run.groups[name] for name in ("train", "test"))
    asked = "simulated poke.? to compare with, of"
    cases = {
        (trained, 2): f"no {asked} 2 asked for: none .* in the test part, which has {tested}$",
        (tested, 90): f"6 {asked} 90 asked for: the test part has no more over the page's inclusions$",
        (tested, 6): "$",
        (trained, 0): "$",
    }
    for (shape, pokes), words in cases.items():
        flags = ("--shape", shape, "--pokes", pokes, "--parts", tmp_path / "poke.zip")
        done = call(command.app, predictor.run.folder, *flags)
        assert done.exit_code == 0, done.output
        [*notes, _] = done.output.splitlines()  # the last is of the file
        assert re.match(words, " ".join(notes)), done.output
    nothing = np.zeros(0, dtype=np.int64)
    assert str(shortage(predictor.store, nothing, [tested], 4)).endswith(": the run has no test part")


@pytest.mark.usefixtures("without_graph")
def test_a_page_of_a_network_whose_dataset_is_elsewhere_says_so(tmp_path: Path) -> None:
    done = call(command.app, "covers", "--shape", "sphere-03", "--parts", tmp_path / "poke.zip")
    assert done.exit_code == 0, done.output
    assert "no simulated pokes to compare with: covers.zarr is not here" in " ".join(done.output.split())


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
        tmp_path / "none.zip": "no such file, expected the parts of a page",
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
