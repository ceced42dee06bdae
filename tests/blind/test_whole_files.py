"""Two runs that keep a file of one name do not spoil each other's; an error leaves nothing beside it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.blind.under_test import VerdictFile
from benchmarks.whole import whole_file, write_whole


def test_two_that_write_one_file(tmp_path: Path) -> None:
    path = tmp_path / "edges.npz"
    with whole_file(path) as one:
        one.write(b"one")
        write_whole(path, "other, longer")
    assert path.read_bytes() == b"one"
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_leaves_the_old_file_alone(tmp_path: Path) -> None:
    path = tmp_path / "edges.npz"
    write_whole(path, "old")
    with pytest.raises(TypeError, match="bytes"), whole_file(path) as file:
        file.write("text")  # type: ignore[arg-type]
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_verdicts_are_kept_in_one_piece(tmp_path: Path) -> None:
    """Names of files that differ in the ending alone had one temporary file."""
    path = tmp_path / "verdicts.json"
    other = tmp_path / "verdicts.part"
    other.write_text("mine")
    VerdictFile(path).add("case", {"status": "clear"})
    assert json.loads(path.read_text()) == VerdictFile(path).answers == {"case": {"status": "clear"}}
    assert (other.read_text(), len(list(tmp_path.iterdir()))) == ("mine", 2)
