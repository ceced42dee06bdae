"""The files of a store in a folder, in a zip or at an fsspec URL, with read errors in one sentence."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import mmap
import os
import struct
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fsspec
import google_crc32c  # of zarr
import numpy as np
import zarr
from numcodecs.blosc import decompress
from numpy.typing import NDArray
from zarr.storage import FsspecStore, LocalStore, ZipStore

from learn.errors import InputError

MANIFEST = "provenance/manifest.json"
_ABSENT = 2**64 - 1  # index entry of a chunk that was never written and holds zeros
_CHECKSUM = 4  # bytes of the index's crc32c
_HEADER = struct.Struct("<26xHH")  # of a zip's entry: the lengths of its name and of its extra field


@contextlib.contextmanager
def reading(what: str) -> Iterator[None]:
    """Convert any error of a damaged or missing file to an InputError that names it."""
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
    """The root group, opened once per process: a loader's worker must not use its parent's connections."""
    key = (os.getpid(), location)
    if fresh or key not in _opened:
        _opened[key] = Source(location).group()
        _readers.pop(location, None)
        _place.cache_clear()
    return _opened[key]


def displacement_reader(location: str) -> ShardReader | None:
    """The fast reader of a store's displacement; None if zarr has to read it."""
    if location not in _readers:
        _readers[location] = shard_reader(location, "grid_displacement")
    return _readers[location]


def _is_local(name: str) -> bool:
    """True if a manifest's name is a plain path within the store."""
    parts = name.split("/")
    return not any(part in ("", ".", "..") or "\\" in part or ":" in part for part in parts)


@dataclass(frozen=True)
class Source:
    """A folder, a zip (as `factory.release` writes it) or a URL that holds a store."""

    location: str

    @property
    def remote(self) -> bool:
        return "://" in self.location

    def url(self, name: str) -> str:
        """URL of a file of a store at a URL."""
        return f"{self.location.rstrip('/')}/{name}"

    def group(self) -> zarr.Group:
        """The store's root group; InputError if there is none."""
        store: LocalStore | FsspecStore | ZipStore
        if self.remote:
            with reading(self.location):
                store = FsspecStore.from_url(self.location, read_only=True)
        elif Path(self.location).is_file():
            with reading(self.location), zipfile.ZipFile(self.location) as archive:
                if "zarr.json" not in archive.namelist():
                    raise InputError(f"{self.location}: no dataset there (expected the zip of a store)")
            store = ZipStore(Path(self.location), mode="r")
        else:
            if not (Path(self.location) / "zarr.json").is_file():
                raise InputError(f"{self.location}: no dataset there (expected a Zarr 3 store)")
            store = LocalStore(Path(self.location), read_only=True)
        with reading(self.location):
            return zarr.open_group(store=store, mode="r", zarr_format=3)

    def check_manifest(self, arrays: list[str]) -> None:
        """Check that every file of these arrays exists and, in a folder or zip, has the manifest's sha256.

        Zarr reads a missing chunk as zeros, so that a truncated store must be detected here. At a URL
        only existence is checked: the bytes would have to be loaded twice.
        """
        wanted = {
            name: digest
            for name, digest in self._manifest().items()
            if name.split("/")[0] in arrays and not name.endswith("zarr.json")
        }
        if self.remote:
            self._check_remote(sorted(wanted))
            return
        with self._stored() as open_stored:
            for name in sorted(wanted):
                with reading(f"{self.location}: {name}"):
                    stream = open_stored(name)
                    if stream is None:
                        raise InputError(f"{self.location}: {name} is missing, the store is incomplete")
                    with stream:
                        found = hashlib.file_digest(stream, "sha256").hexdigest()
                if found != wanted[name]:
                    raise InputError(
                        f"{self.location}: {name} was altered (its sha256 is not the manifest's)"
                    )

    def _check_remote(self, names: list[str]) -> None:
        for name in names:
            files, path = fsspec.url_to_fs(self.url(name))
            with reading(f"{self.location}: {name}"):
                there = bool(files.exists(path))
            if not there:
                raise InputError(f"{self.location}: {name} is missing, the store is incomplete")

    @contextlib.contextmanager
    def _stored(self) -> Iterator[Callable[[str], Any]]:
        """Yield a function that opens a file of the folder or zip by name, or returns None if missing."""
        if Path(self.location).is_dir():
            yield functools.partial(self._in_folder, Path(self.location).resolve())
            return
        with zipfile.ZipFile(self.location) as archive:
            names = set(archive.namelist())
            yield lambda name: archive.open(name) if name in names else None

    def _in_folder(self, folder: Path, name: str) -> Any:
        """The file of the resolved folder of the store, open; None if it is missing."""
        file = folder / name
        if not file.resolve().is_relative_to(folder):
            raise InputError(f"{self.location}: {name} is a link that leads out of the store")
        return file.open("rb") if file.is_file() else None

    def _manifest(self) -> dict[str, str]:
        where = f"{self.location}: {MANIFEST}"
        with reading(where):
            if self.remote:
                files, path = fsspec.url_to_fs(self.url(MANIFEST))
                text = files.cat_file(path)
            else:
                with self._stored() as open_stored:
                    stream = open_stored(MANIFEST)
                    if stream is None:
                        raise FileNotFoundError("No such file")
                    with stream:
                        text = stream.read()
            found: Any = json.loads(text)["sha256"]
            if not isinstance(found, dict) or not found:
                raise InputError(f"{where}: expected a table of sha256 sums")
            for name, digest in found.items():
                if not _is_local(name):
                    raise InputError(
                        f"{where}: name {name!r} leads out of the store, expected a path within it"
                    )
                if not isinstance(digest, str):
                    raise InputError(f"{where}: {name}: expected a sha256 sum, got {digest!r}"[:300])
            return dict(found)


@dataclass(frozen=True)
class ShardReader:
    """Reader of a store's shards, directly into the output array.

    zarr-python takes three times as long for a shard of 1,024 frames as its chunks take to decompress (copies
    and scheduling), and holds the shard several times. Stores with the factory's layout, in a folder, at a
    URL or not compressed in a zip, are read here; others by zarr, with the same values.

    `location` of the store, `name` of the array, number of `rows`, rows per `chunk` and per `shard`, shape of
    a `row`.
    """

    location: str
    name: str
    rows: int
    chunk: int
    shard: int
    row: tuple[int, ...]

    def read(self, start: int, stop: int, out: NDArray[np.float32]) -> None:
        """Read rows start to stop into `out`, (stop - start, *row); damaged data raise an exception."""
        for number in range(start // self.shard, -(-stop // self.shard)):
            first = number * self.shard
            low, high = max(start, first), min(stop, first + self.shard)
            self._read_shard(number, low - first, high - first, out[low - start : high - start])

    def _read_shard(self, number: int, low: int, high: int, out: NDArray[np.float32]) -> None:
        piece = _pieces(self.location, "/".join([self.name, "c", str(number), *("0" for _ in self.row)]))
        per = self.shard // self.chunk
        table = piece(-16 * per - _CHECKSUM, None)
        if google_crc32c.value(bytes(table[:-_CHECKSUM])).to_bytes(_CHECKSUM, "little") != table[-_CHECKSUM:]:
            raise ValueError("the checksum of a shard's index is not that of the index")
        index = np.frombuffer(table[:-_CHECKSUM], dtype="<u8").reshape(per, 2)
        chunks = range(low // self.chunk, -(-high // self.chunk))
        there = [k for k in chunks if index[k, 0] != _ABSENT]
        begin = min((int(index[k, 0]) for k in there), default=0)
        end = max((int(index[k].sum()) for k in there), default=0)
        data = piece(begin, end) if there else memoryview(b"")  # at a URL in one request
        for k in chunks:
            first = k * self.chunk
            a, b = max(low, first), min(high, first + self.chunk)
            where = out[a - low : b - low]
            if k not in there:
                where[...] = 0
                continue
            offset, size = (int(v) for v in index[k])
            view = data[offset - begin : offset - begin + size]
            if b - a == self.chunk:
                decompress(view, where)
            else:
                whole = np.empty((self.chunk, *self.row), dtype=np.float32)
                decompress(view, whole)
                where[...] = whole[a - first : b - first]


def _pieces(location: str, name: str) -> Callable[[int, int | None], memoryview]:
    """A function that returns the bytes of a store's file from one place to another, as slices do."""
    source = Source(location)
    if source.remote:
        files, remote = fsspec.url_to_fs(source.url(name))
        return lambda a, b: memoryview(files.cat_file(remote, a, b))
    path, begin, end = Path(location) / name, 0, None
    if Path(location).is_file():
        path, (begin, end) = Path(location), _place(Path(location), name)
    with path.open("rb") as file:
        # unmapped with the last view of it
        data = memoryview(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))[begin:end]
    return lambda a, b: data[a:b]


@functools.cache
def _place(archive: Path, name: str) -> tuple[int, int]:
    """Offsets in a zip at which the bytes of an uncompressed file begin and end."""
    with zipfile.ZipFile(archive) as entries:
        entry = entries.getinfo(name)
    if entry.compress_type != zipfile.ZIP_STORED:
        raise ValueError(f"{name} is compressed")
    with archive.open("rb") as file:
        file.seek(entry.header_offset)
        lengths = _HEADER.unpack(file.read(_HEADER.size))
    begin = entry.header_offset + _HEADER.size + sum(lengths)
    return begin, begin + entry.file_size


def shard_reader(location: str, name: str) -> ShardReader | None:
    """Reader of an array of a store; None if its layout is another."""
    source, text = Source(location), b""
    if source.remote:
        files, remote = fsspec.url_to_fs(source.url(f"{name}/zarr.json"))
        text = files.cat_file(remote)
    elif Path(location).is_file():
        with zipfile.ZipFile(location) as archive:
            compressed = any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist())
            text = archive.read(f"{name}/zarr.json")
        if compressed:
            return None
    else:
        text = (Path(location) / name / "zarr.json").read_bytes()
    meta: dict[str, Any] = json.loads(text)
    shape, grid, codecs = meta["shape"], meta["chunk_grid"]["configuration"]["chunk_shape"], meta["codecs"]
    if meta["data_type"] != "float32" or len(codecs) != 1 or codecs[0]["name"] != "sharding_indexed":
        return None
    inner = codecs[0]["configuration"]
    names = [[c["name"] for c in inner[key]] for key in ("codecs", "index_codecs")]
    little = inner["codecs"][0].get("configuration", {}).get("endian") == "little"
    chunk = inner["chunk_shape"]
    fits = (
        names == [["bytes", "blosc"], ["bytes", "crc32c"]]
        and little
        and inner.get("index_location", "end") == "end"
        and meta.get("fill_value") == 0
        and meta["chunk_key_encoding"] == {"name": "default", "configuration": {"separator": "/"}}
        and chunk[1:] == grid[1:] == shape[1:]
        and grid[0] % chunk[0] == 0
    )
    return ShardReader(location, name, shape[0], chunk[0], grid[0], tuple(shape[1:])) if fits else None
