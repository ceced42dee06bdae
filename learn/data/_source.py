"""Where a store lies: a folder or an fsspec URL; its files, and errors of reading as one sentence."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fsspec
import zarr
from zarr.storage import FsspecStore, LocalStore

from learn.data._format import MANIFEST
from learn.data._shards import ShardReader, shard_reader
from learn.errors import InputError


@contextlib.contextmanager
def reading(what: str) -> Iterator[None]:
    """Turns whatever a damaged or missing file raises into an InputError that names it."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # codecs, file systems and zarr each raise kinds of their own
        text = " ".join(str(error).split())[:160] or type(error).__name__
        raise InputError(f"{what}: cannot be read ({text})") from error


_readers: dict[str, ShardReader | None] = {}
_opened: dict[tuple[int, str], zarr.Group] = {}


def group_here(location: str, *, fresh: bool = False) -> zarr.Group:
    """The root group, opened once a process: a loader's worker must not use its parent's connections."""
    key = (os.getpid(), location)
    if fresh or key not in _opened:
        _opened[key] = Source(location).group()
        _readers.pop(location, None)
    return _opened[key]


def displacement_reader(location: str) -> ShardReader | None:
    """The fast reader of a local store's displacement; None where zarr has to read it."""
    if location not in _readers:
        remote = Source(location).remote
        _readers[location] = None if remote else shard_reader(Path(location) / "grid_displacement")
    return _readers[location]


@dataclass(frozen=True)
class Source:
    """A folder or URL that holds a store."""

    location: str

    @property
    def remote(self) -> bool:
        return "://" in self.location

    def group(self) -> zarr.Group:
        """The store's root group; InputError where there is none."""
        store: LocalStore | FsspecStore
        if self.remote:
            with reading(self.location):
                store = FsspecStore.from_url(self.location, read_only=True)
        else:
            if not (Path(self.location) / "zarr.json").is_file():
                raise InputError(f"{self.location}: no dataset there (expected a Zarr 3 store)")
            store = LocalStore(Path(self.location), read_only=True)
        with reading(self.location):
            return zarr.open_group(store=store, mode="r", zarr_format=3)

    def check_manifest(self, arrays: list[str]) -> None:
        """Every file of these arrays is there and, in a folder, has the bytes of the manifest.

        Zarr reads a missing chunk as zeros, so that a truncated store must be found here. Over a URL
        only existence is checked: the bytes would have to be loaded twice.
        """
        wanted = {
            name: digest
            for name, digest in self._manifest().items()
            if name.split("/")[0] in arrays and not name.endswith("zarr.json")
        }
        for name in sorted(wanted):
            if self.remote:
                files, path = fsspec.url_to_fs(f"{self.location.rstrip('/')}/{name}")
                with reading(f"{self.location}: {name}"):
                    there = bool(files.exists(path))
                if not there:
                    raise InputError(f"{self.location}: {name} is missing, the store is incomplete")
                continue
            file = Path(self.location) / name
            if not file.is_file():
                raise InputError(f"{self.location}: {name} is missing, the store is incomplete")
            with file.open("rb") as stream:
                found = hashlib.file_digest(stream, "sha256").hexdigest()
            if found != wanted[name]:
                raise InputError(f"{self.location}: {name} was altered (its sha256 is not the manifest's)")

    def _manifest(self) -> dict[str, str]:
        where = f"{self.location}: {MANIFEST}"
        with reading(where):
            if self.remote:
                files, path = fsspec.url_to_fs(f"{self.location.rstrip('/')}/{MANIFEST}")
                text = files.cat_file(path)
            else:
                text = (Path(self.location) / MANIFEST).read_bytes()
            found: Any = json.loads(text)["sha256"]
            if not isinstance(found, dict) or not found:
                raise InputError(f"{where}: expected a table of sha256 sums")
            return {str(name): str(digest) for name, digest in found.items()}
