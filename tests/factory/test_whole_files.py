"""Two processes that write one target at once do not spoil each other's; an error leaves nothing beside it.

The second process is played by a second write within the first.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from matplotlib.figure import Figure

from factory.inspection.figures import draw_preview, preview_of
from factory.plan import Plan
from factory.publishing import files as card_files
from factory.store import archive as store_archive
from factory.store.files import MANIFEST
from factory.store.staging import write_atomic

Meeting = Callable[[Any, str, Callable[[], None]], None]


@pytest.fixture
def meets(monkeypatch: pytest.MonkeyPatch) -> Meeting:
    """A function that lets another act take place at the end of the first call of a function."""

    def arrange(owner: Any, name: str, other: Callable[[], None]) -> None:
        real = getattr(owner, name)

        def meeting(*words: Any, **options: Any) -> Any:
            monkeypatch.setattr(owner, name, real)
            result = real(*words, **options)
            other()
            return result

        monkeypatch.setattr(owner, name, meeting)

    return arrange


def _stop() -> None:
    raise KeyboardInterrupt


def test_two_that_write_one_file(tmp_path: Path, meets: Meeting) -> None:
    path = tmp_path / "plan.json"
    meets(os, "fsync", lambda: write_atomic(path, b"other, longer"))
    write_atomic(path, b"one")
    assert path.read_bytes() == b"one"
    assert list(tmp_path.iterdir()) == [path]


def test_an_interrupted_file_leaves_the_old_one_alone(tmp_path: Path, meets: Meeting) -> None:
    path = tmp_path / "plan.json"
    write_atomic(path, b"old")
    meets(os, "fsync", _stop)
    with pytest.raises(KeyboardInterrupt):
        write_atomic(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_two_previews(plan: Plan, tmp_path: Path, meets: Meeting) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    path = folder / "store.png"
    meets(Figure, "savefig", lambda: draw_preview(plan, {}, path, "other"))
    draw_preview(plan, {}, path, "one")
    assert preview_of(path) == "one"
    assert list(folder.iterdir()) == [path]
    meets(Figure, "savefig", _stop)
    with pytest.raises(KeyboardInterrupt):
        draw_preview(plan, {}, path, "new")
    assert preview_of(path) == "one"
    assert list(folder.iterdir()) == [path]


def test_two_releases_of_a_store(finished_store: Path, tmp_path: Path, meets: Meeting) -> None:
    target = tmp_path / "store.zarr.zip"
    sums = store_archive.sums_file(target)
    meets(
        store_archive,
        "zip_faults",
        lambda: (store_archive.release_store(finished_store, target), target.unlink())[1],
    )
    released = store_archive.release_store(finished_store, target)
    assert sorted(tmp_path.iterdir()) == [target, sums]
    assert store_archive.zip_faults(target) == []
    assert sums.read_text() == f"{released.sha256}  {target.name}\n"


def test_a_release_removes_what_killed_ones_left(finished_store: Path, tmp_path: Path) -> None:
    """But not what another process writes at the time, which holds a lock on it."""
    target = tmp_path / "store.zarr.zip"
    left, held, foreign = (
        tmp_path / f"store.zarr.zip.{end}" for end in ("00000000.part", "11111111.part", "mine.part")
    )
    for path in (left, held, foreign):
        path.write_bytes(b"PK")
    with held.open("rb") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        store_archive.release_store(finished_store, target)
    assert sorted(tmp_path.iterdir()) == sorted([target, store_archive.sums_file(target), held, foreign])


def test_two_cards(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, meets: Meeting) -> None:
    root, out = tmp_path / "store.zarr", tmp_path / "cards" / "card"
    (root / MANIFEST).parent.mkdir(parents=True)
    (root / MANIFEST).write_text("{}")

    def facts(text: str) -> Any:
        data = SimpleNamespace(root=root, poke=lambda _: None)
        summary = SimpleNamespace(model=None, done=None, levels=None)
        return SimpleNamespace(data=data, summary=summary, rows=text, shown=0, sums={}, text=text)

    monkeypatch.setattr(card_files, "write_features", lambda text, path: path.write_text(text))
    monkeypatch.setattr(card_files, "write_softness", lambda *words: words[-1].touch())
    monkeypatch.setattr(card_files, "draw_features", lambda _, path: path.touch())
    monkeypatch.setattr(card_files, "draw_poke", lambda *words: words[-1].touch())
    monkeypatch.setattr(card_files, "page", lambda facts: facts.text)
    meets(card_files, "page", lambda: card_files.write_card(facts("other"), out))
    card_files.write_card(facts("one"), out)
    assert ((out / "features.csv").read_text(), (out / "card.md").read_text()) == ("one", "one")
    meets(card_files, "page", _stop)
    with pytest.raises(KeyboardInterrupt):
        card_files.write_card(facts("new"), out)
    assert list(out.parent.iterdir()) == [out]
