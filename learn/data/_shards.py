"""Whole shards of a local store, decoded straight to where they are wanted.

zarr-python reads a shard of 1,024 frames three times as slowly as its chunks take to decompress (copies and
scheduling). Where the store has the factory's layout in a folder, its shards are read here; elsewhere
zarr reads them, to the same values.
"""

from __future__ import annotations

import json
import mmap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numcodecs.blosc import decompress
from numpy.typing import NDArray

_ABSENT = 2**64 - 1  # of a chunk that was never written: it holds zeros
_CHECKSUM = 4  # bytes of the index's crc32c


@dataclass(frozen=True)
class ShardReader:
    """Rows of one array; chunk, shard: rows in each; row: shape of one."""

    folder: Path
    rows: int
    chunk: int
    shard: int
    row: tuple[int, ...]

    def read(self, start: int, stop: int, out: NDArray[np.float32]) -> None:
        """Rows start to stop into out, (stop - start, *row). Whatever is damaged raises."""
        for number in range(start // self.shard, -(-stop // self.shard)):
            first = number * self.shard
            low, high = max(start, first), min(stop, first + self.shard)
            self._read_shard(number, low - first, high - first, out[low - start : high - start])

    def _read_shard(self, number: int, low: int, high: int, out: NDArray[np.float32]) -> None:
        path = self.folder / "c" / "/".join(str(k) for k in (number, *(0 for _ in self.row)))
        per = self.shard // self.chunk
        with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            index = np.frombuffer(data[-16 * per - _CHECKSUM : -_CHECKSUM], dtype="<u8").reshape(per, 2)
            for k in range(low // self.chunk, -(-high // self.chunk)):
                first = k * self.chunk
                a, b = max(low, first), min(high, first + self.chunk)
                where = out[a - low : b - low]
                offset, size = (int(v) for v in index[k])
                if offset == _ABSENT:
                    where[...] = 0
                    continue
                view = memoryview(data)[offset : offset + size]
                try:
                    if b - a == self.chunk:
                        decompress(view, where)
                    else:
                        whole = np.empty((self.chunk, *self.row), dtype=np.float32)
                        decompress(view, whole)
                        where[...] = whole[a - first : b - first]
                finally:
                    view.release()


def shard_reader(folder: Path) -> ShardReader | None:
    """A reader of an array's folder; None where its layout is another."""
    meta: dict[str, Any] = json.loads((folder / "zarr.json").read_text(encoding="utf-8"))
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
    return ShardReader(folder, shape[0], chunk[0], grid[0], tuple(shape[1:])) if fits else None
