"""The folder of a dataset being built: one staged result per poke, under a lock.

    NAME.zarr.building/
        lock            held with flock while a builder runs: released by the system however that ends
        plan.json       identity of the plan
        parts/poke-00012.npz      a staged result; written under another name, synced, then renamed
        parts/poke-00012.damaged-1    a staged result that could not be read; its poke is simulated again
        parts/poke-00013.error    the text of a poke that failed; tried again by the next run
        ledger.jsonl    wall and core times, one line per poke
        store/          the store being assembled from the staged results

Only the builder's main process writes here.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import itertools
import json
import logging
import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from factory.errors import InputError, one_line
from factory.plan.poke import PlannedPoke
from factory.simulation.record import Outcome, check_arrays
from factory.store.files import read_json
from tisim.io.whole import whole_file
from tisim.parallel.termination import uninterrupted

log = logging.getLogger(__name__)
_RESULT = re.compile(r"poke-(\d{5,})\.npz")
_ERROR = re.compile(r"poke-(\d{5,})\.error")
_OF_THE_SYSTEM = {errno.EACCES, errno.EPERM, errno.EIO, errno.EMFILE, errno.ENFILE, errno.ENOMEM}


class DamagedResultError(Exception):
    """A staged result that cannot be read, or that is not the result of its poke."""

    def __init__(self, index: int, reason: str) -> None:
        super().__init__(f"staged result of poke {index}: {reason}")
        self.index, self.reason = index, reason


def building_folder(target: Path) -> Path:
    """Folder in which the dataset `target` is built."""
    return target.with_name(target.name + ".building")


class Staging:
    """The building folder of one target; as a context manager it holds the lock."""

    def __init__(self, target: Path) -> None:
        self.folder = building_folder(target)
        self.results = self.folder / "parts"
        self.plan_file = self.folder / "plan.json"
        self.ledger_file = self.folder / "ledger.jsonl"
        self.overwriting = self.folder / "overwriting"  # there while a whole store is to be replaced
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
        """Identity of the plan that the staged results belong to; None if there is none."""
        try:
            found = read_json(self.plan_file)
        except FileNotFoundError:
            return None
        except ValueError:
            found = None
        if not isinstance(found, dict):
            raise InputError(f"{self.plan_file}: is damaged: give --overwrite to simulate everything again")
        return found

    def begin(self, identity: dict[str, Any], *, overwrites: bool = False) -> None:
        """Clear the folder and write the identity of the plan to build.

        overwrites : True if the target holds a store that this build replaces when it is complete.
        """
        self.plan_file.unlink(missing_ok=True)  # first, since results without a plan are never used
        self.ledger_file.unlink(missing_ok=True)
        for folder in (self.results, self.store):
            shutil.rmtree(folder, ignore_errors=True)
        self.results.mkdir(parents=True)
        self.overwriting.unlink(missing_ok=True)
        if overwrites:
            write_atomic(self.overwriting, b"")
        write_atomic(self.plan_file, json.dumps(identity, indent=1, sort_keys=True).encode())

    def stage(self, outcome: Outcome) -> None:
        """Write the outcome of a poke durably: after this returns, no crash can lose it."""
        result, note = self.result_path(outcome.index), self._note(outcome.index)
        if outcome.payload is not None:
            write_atomic(result, outcome.payload)
            note.unlink(missing_ok=True)
        else:
            write_atomic(note, (outcome.error or "unknown error").encode())

    def result_path(self, index: int) -> Path:
        """Path of a poke's staged result."""
        return self.results / f"poke-{index:05d}.npz"

    @contextlib.contextmanager
    def opened(self, index: int) -> Iterator[Mapping[str, NDArray[Any]]]:
        """Open the arrays of a staged result, each read on access; DamagedResultError if one cannot be."""
        with contextlib.ExitStack() as stack:
            with _damage_named(index), uninterrupted():
                file = stack.enter_context(self.result_path(index).open("rb"))
                arrays = np.load(file, allow_pickle=False)
                if not isinstance(arrays, np.lib.npyio.NpzFile):
                    raise ValueError("is no .npz file")
                stack.enter_context(arrays)
            yield _Checked(index, arrays)  # outside: errors of the caller are not damage

    def check(self, poke: PlannedPoke) -> None:
        """Read all of a staged result; DamagedResultError if it is damaged or not this poke's."""
        with _damage_named(poke.index), self.opened(poke.index) as arrays:
            check_arrays(arrays, poke)

    def set_aside(self, index: int, reason: str) -> Path:
        """Rename a damaged staged result, so that its poke is simulated again; returns the new path."""
        path = self.result_path(index)
        for number in itertools.count(1):
            aside = path.with_suffix(f".damaged-{number}")
            if not aside.exists():
                break
        path.rename(aside)
        log.warning(
            "The staged result of poke %d is damaged (%s): set aside as %s, the poke is simulated again.",
            index,
            reason,
            aside.name,
        )
        return aside

    def _note(self, index: int) -> Path:
        return self.results / f"poke-{index:05d}.error"

    def finished(self) -> set[int]:
        """Indices of the pokes with a staged result."""
        return set(self._matching(_RESULT))

    def errors(self) -> dict[int, str]:
        """Error texts, by index, of the pokes that failed and have not succeeded since."""
        finished, notes = self.finished(), self._matching(_ERROR)
        texts = {}
        for index in sorted(set(notes) - finished):
            try:
                texts[index] = notes[index].read_text(encoding="utf-8", errors="replace")
            except OSError as error:
                texts[index] = f"its error text cannot be read ({error.strerror})"
        return texts

    def _matching(self, pattern: re.Pattern[str]) -> dict[int, Path]:
        if not self.results.is_dir():
            return {}
        names = ((pattern.fullmatch(path.name), path) for path in self.results.iterdir())
        found = ((int(match[1]), path) for match, path in names if match)
        return {index: path for index, path in found if path.stem == f"poke-{index:05d}"}

    def note_times(self, outcome: Outcome) -> None:
        """Append a poke's times to the ledger; readers skip a line truncated by a crash."""
        line = json.dumps(
            {
                "poke": outcome.index,
                "wall_seconds": round(outcome.wall, 3),
                "core_seconds": round(outcome.core, 3),
                "error": outcome.error,
            }
        )
        with self.ledger_file.open("a", encoding="utf-8") as file:
            file.write(f"\n{line}\n" if _torn(self.ledger_file) else f"{line}\n")

    def remove(self) -> None:
        """Remove the folder, the lock last (it is still held)."""
        lock = self.folder / "lock"
        for path in self.folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path, ignore_errors=True)
            elif path != lock:
                path.unlink(missing_ok=True)
        lock.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.folder.rmdir()


class _Checked(Mapping[str, "NDArray[Any]"]):
    """Arrays of a staged result; a failed read raises DamagedResultError."""

    def __init__(self, index: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._index, self._arrays = index, arrays

    def __getitem__(self, name: str) -> NDArray[Any]:
        with _damage_named(self._index):
            return self._arrays[name]

    def __contains__(self, name: object) -> bool:
        return name in self._arrays

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)


@contextlib.contextmanager
def _damage_named(index: int) -> Iterator[None]:
    """Convert what NumPy and zipfile raise on a truncated, empty or foreign file to DamagedResultError."""
    try:
        yield
    except (DamagedResultError, InputError):
        raise
    except FileNotFoundError:
        raise DamagedResultError(index, "is missing") from None
    except OSError as error:
        if error.errno in _OF_THE_SYSTEM:
            raise
        raise DamagedResultError(index, one_line(error)) from None
    except KeyError as error:
        raise DamagedResultError(index, f"has no array {error}") from None
    except Exception as error:
        raise DamagedResultError(index, one_line(error)) from None


def set_damaged_aside(staging: Staging, pokes: Sequence[PlannedPoke]) -> list[int]:
    """Set aside every staged result that is not a valid result of its poke; return their indices."""
    planned = {poke.index: poke for poke in pokes}
    damaged = []
    for index in sorted(staging.finished()):
        try:
            if index not in planned:
                raise DamagedResultError(index, f"the plan has {len(planned)} pokes")
            staging.check(planned[index])
        except DamagedResultError as error:
            staging.set_aside(index, error.reason)
            damaged.append(index)
    return damaged


def write_atomic(path: Path, content: bytes) -> None:
    """Write a file that appears complete or not at all, and survives a power failure."""
    with whole_file(path) as part, part.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Make renames inside the folder durable."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _torn(path: Path) -> bool:
    if not path.is_file() or path.stat().st_size == 0:
        return False
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) != b"\n"
