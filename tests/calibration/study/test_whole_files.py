"""Files in one piece: an error or a kill leaves the old file whole, and leftovers are known as such."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from calibration._files import whole_name, write_whole
from calibration.study._store import remove_fits

ROOT = Path(__file__).parents[3]
KILLED = """
import os, sys
from pathlib import Path
from calibration._files import write_whole

Path.replace = lambda *_: os._exit(9)
write_whole(Path(sys.argv[1]), sys.argv[2])
"""


def test_what_is_written_is_there(tmp_path: Path) -> None:
    path = tmp_path / "made" / "page.html"
    assert write_whole(path, "ä\r\n") == path
    assert path.read_bytes() == b"\xc3\xa4\r\n"
    write_whole(path, b"\xff")
    assert path.read_bytes() == b"\xff"
    assert [p.name for p in path.parent.iterdir()] == ["page.html"]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such permissions")
def test_a_group_reads_what_its_members_write(tmp_path: Path) -> None:
    before = os.umask(0o002)
    try:
        path = write_whole(tmp_path / "page.html", "x")
    finally:
        os.umask(before)
    assert path.stat().st_mode & 0o777 == 0o664


def test_an_error_leaves_the_old_file_and_nothing_beside_it(tmp_path: Path) -> None:
    path = write_whole(tmp_path / "page.html", "old")
    with pytest.raises(UnicodeEncodeError):
        write_whole(path, "new \ud800")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match="folder"):
        write_whole(tmp_path / "folder", "new")
    assert path.read_text() == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["folder", "page.html"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("S0-ogden.json", '{"header": {}}'),
        ("S0-ogden.json", '{"hea'),
        ("S0-ogden.jsonl", '{"format": 2}\n'),
        ("S0-ogden.jsonl", '{"format": 2}\n{"restart": 0}\n'),
    ],
)
def test_what_a_kill_leaves_of_a_fit_goes_with_it(name: str, content: str, tmp_path: Path) -> None:
    path = write_whole(tmp_path / name, content)
    words = [sys.executable, "-c", KILLED, str(path), content]
    assert subprocess.run(words, cwd=ROOT, check=False).returncode == 9
    (left,) = [p.name for p in tmp_path.iterdir() if p != path]
    assert whole_name(left) == name
    assert path.read_text() == content
    remove_fits(tmp_path, {"S1-ogden"})
    assert len([p for p in tmp_path.iterdir() if p.name != ".lock"]) == 2
    remove_fits(tmp_path, {"S0-ogden"})
    assert [p.name for p in tmp_path.iterdir()] == [".lock"]


@pytest.mark.parametrize(
    ("name", "whole"),
    [
        ("a.json.part", "a.json"),  # of earlier versions
        ("a.part.json.part", "a.part.json"),
        ("a.json", "a.json"),
        ("a.part.json", "a.part.json"),
        ("a.json.partial", "a.json.partial"),
    ],
)
def test_names_of_leftovers(name: str, whole: str) -> None:
    assert whole_name(name) == whole
