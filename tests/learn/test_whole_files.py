"""Files of a run in one piece: an error or a kill leaves the old file whole, two writers do not mix."""

from __future__ import annotations

from pathlib import Path

import pytest

from learn.training.run_folder import Log, write_whole


def test_two_processes_that_write_a_file_do_not_mix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While one moves its file into place, another begins and ends: each file is one's own, whole."""
    path, plain = tmp_path / "page.html", Path.replace

    def meanwhile(self: Path, target: Path) -> Path:
        monkeypatch.setattr(Path, "replace", plain)
        write_whole(path, b"other")
        assert path.read_bytes() == b"other"
        return plain(self, target)

    monkeypatch.setattr(Path, "replace", meanwhile)
    write_whole(path, b"one")
    assert path.read_bytes() == b"one"
    assert [p.name for p in tmp_path.iterdir()] == ["page.html"]


def test_ctrl_c_leaves_the_old_file_and_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "page.html"
    write_whole(path, b"old")

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", stopped)
    with pytest.raises(KeyboardInterrupt):
        write_whole(path, b"new")
    assert path.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["page.html"]


def test_parts_that_a_kill_left_go_with_the_next_training(tmp_path: Path) -> None:
    """Those of checkpoints and log, which no other process writes; a page may be another's, at this time."""
    for name in ("last.pt.0a1b2c3d.part", "best.part", "log.jsonl.0a1b2c3d.part", "page.html.0a1b2c3d.part"):
        (tmp_path / name).write_bytes(b"half")
    Log(tmp_path, epochs_done=0).close()
    assert [p.name for p in tmp_path.glob("*.part")] == ["page.html.0a1b2c3d.part"]
