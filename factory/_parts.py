"""The folder of a dataset being built: one finished file a poke, under a lock.

    NAME.zarr.building/
        lock            held with flock while a builder runs: freed by the system whatever ends it
        plan.json       what is being built
        parts/poke-00012.npz      a finished poke; written beside, synced, then renamed
        parts/poke-00013.error    the text of a poke that failed; tried again by the next run
        ledger.jsonl    wall times, one line a poke
        store/          the store being assembled from the parts

Only the builder's main process writes here.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from factory._record import Outcome
from factory.errors import InputError


def building_folder(target: Path) -> Path:
    """Where the dataset `target` is built."""
    return target.with_name(target.name + ".building")


class Parts:
    """The building folder of one target; use as a context manager, which holds the lock."""

    def __init__(self, target: Path) -> None:
        self.folder = building_folder(target)
        self.parts = self.folder / "parts"
        self.plan_file = self.folder / "plan.json"
        self.ledger_file = self.folder / "ledger.jsonl"
        self.store = self.folder / "store"
        self._lock: int | None = None

    def __enter__(self) -> Self:
        while True:
            self.folder.mkdir(parents=True, exist_ok=True)
            lock = os.open(self.folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                os.close(lock)
                raise InputError(f"{self.folder}: another builder is at work on this dataset") from None
            # the builder before us may have finished and removed the file between open and flock
            try:
                same = (self.folder / "lock").stat().st_ino == os.fstat(lock).st_ino
            except FileNotFoundError:
                same = False
            if same:
                self._lock = lock
                return self
            os.close(lock)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def read_plan(self) -> dict[str, Any] | None:
        """The identity that the parts belong to, where there is one."""
        try:
            found: dict[str, Any] = json.loads(self.plan_file.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except ValueError:
            raise InputError(f"{self.plan_file}: damaged: give --overwrite to build it anew") from None
        return found

    def begin(self, identity: dict[str, Any]) -> None:
        """Clears what was there and notes what is built from now on."""
        self.plan_file.unlink(missing_ok=True)  # first: parts without a plan are nobody's
        self.ledger_file.unlink(missing_ok=True)
        for folder in (self.parts, self.store):
            shutil.rmtree(folder, ignore_errors=True)
        self.parts.mkdir(parents=True)
        write_atomic(self.plan_file, json.dumps(identity, indent=1, sort_keys=True).encode())

    def keep(self, outcome: Outcome) -> None:
        """Stores a poke for good: after this returns, no crash can lose it."""
        part, note = self.part(outcome.index), self._note(outcome.index)
        if outcome.payload is not None:
            write_atomic(part, outcome.payload)
            note.unlink(missing_ok=True)
        else:
            write_atomic(note, (outcome.error or "unknown error").encode())

    def part(self, index: int) -> Path:
        return self.parts / f"poke-{index:05d}.npz"

    @contextlib.contextmanager
    def opened(self, index: int) -> Iterator[Mapping[str, NDArray[Any]]]:
        """The arrays of a finished poke, each read when it is asked for."""
        with self.part(index).open("rb") as file, np.load(file) as arrays:
            yield arrays

    def _note(self, index: int) -> Path:
        return self.parts / f"poke-{index:05d}.error"

    def done(self) -> set[int]:
        """Indices of the finished pokes."""
        return {int(path.stem[5:]) for path in self.parts.glob("poke-*.npz")}

    def errors(self) -> dict[int, str]:
        """Texts of the pokes that failed and have not succeeded since."""
        done = self.done()
        found = {int(path.stem[5:]): path for path in self.parts.glob("poke-*.error")}
        return {i: path.read_text(encoding="utf-8") for i, path in sorted(found.items()) if i not in done}

    def log(self, line: dict[str, Any]) -> None:
        """Appends to the ledger; a line torn by a crash is skipped when it is read."""
        with self.ledger_file.open("a", encoding="utf-8") as file:
            file.write("\n" + json.dumps(line) if _torn(self.ledger_file) else json.dumps(line))
            file.write("\n")

    def remove(self) -> None:
        """Removes the folder, the lock last (it is still held)."""
        lock = self.folder / "lock"
        for path in self.folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            elif path != lock:
                path.unlink(missing_ok=True)
        lock.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.folder.rmdir()


def write_atomic(path: Path, content: bytes) -> None:
    """The file appears whole or not at all, and stays through a power cut."""
    temporary = path.with_name(f".{path.name}.tmp")
    try:
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Makes renames inside the folder durable."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def read_ledger(path: Path) -> dict[int, dict[str, Any]]:
    """The last line of each poke."""
    lines: dict[int, dict[str, Any]] = {}
    for line in _lines(path):
        with contextlib.suppress(ValueError, KeyError, TypeError):
            entry = json.loads(line)
            lines[int(entry["poke"])] = entry
    return lines


def _lines(path: Path) -> Iterator[str]:
    if path.is_file():
        yield from path.read_text(encoding="utf-8", errors="replace").splitlines()


def _torn(path: Path) -> bool:
    if not path.is_file() or path.stat().st_size == 0:
        return False
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) != b"\n"
