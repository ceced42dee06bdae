"""How fast learn's loaders read the dataset's displacement, for several layouts, beside a NumPy memmap.

    python -m benchmarks.loader_throughput [--frames 14000]

Fields as smooth as simulated ones (decaying from random sites, float32) are written in the dataset's format;
each layout is read for three epochs in random order in batches of 64. Medians; the file cache is warm.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from rich.console import Console
from rich.table import Table
from zarr.codecs import BloscCodec, BloscShuffle

from learn.benchmark import loader_rates
from learn.data import Setup, Store
from learn.data._files import group_here

# name, frames a chunk, frames a shard, codec of Blosc (None: uncompressed), shuffle
LAYOUTS: list[tuple[str, int, int, str | None, str]] = [
    ("256 / 1024, zstd shuffle", 256, 1024, "zstd", "shuffle"),
    ("64 / 1024, zstd shuffle", 64, 1024, "zstd", "shuffle"),
    ("1024 / 1024, zstd shuffle", 1024, 1024, "zstd", "shuffle"),
    ("256 / 1024, lz4 shuffle (the factory's)", 256, 1024, "lz4", "shuffle"),
    ("256 / 1024, lz4 bitshuffle", 256, 1024, "lz4", "bitshuffle"),
    ("256 / 1024, uncompressed", 256, 1024, None, "shuffle"),
]


def fields(frames: int) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Displacements of random pokes, 11 frames each."""
    random = np.random.default_rng(0)
    x = (np.arange(32) + 0.5) / 32 * 0.1 - 0.05
    grid = np.stack(np.meshgrid(x, x), axis=-1)
    out = np.empty((frames, 32, 32, 3), dtype=np.float32)
    for first in range(0, frames, 11):
        offset = grid - random.uniform(-0.03, 0.03, 2)
        radius = np.sqrt((offset**2).sum(axis=-1) + 0.004**2)
        fall = 0.004 / radius * np.exp(-radius / 0.03)
        heading = random.normal(size=3) * (0.4, 0.4, 0.2) - (0, 0, 1)
        sideways = np.concatenate([offset / radius[..., None] * 0.2, np.zeros((32, 32, 1))], axis=-1)
        for k in range(first, min(first + 11, frames)):
            depth = 1e-3 * (k - first + 1)
            out[k] = depth * fall[..., None] * (heading + sideways * (1 + 20 * depth))
    return out


def store_of(folder: Path, data: np.ndarray[Any, Any]) -> Store:
    """A `Store` around one displacement array; its tables say one poke with all frames."""
    frames = len(data)
    one, three = np.ones(1), np.array([[0.0, 0.0, 1.0]])
    flat = np.stack(np.meshgrid(np.arange(32.0), np.arange(32.0)), axis=-1).reshape(-1, 2) * 3.125e-3
    zero = np.zeros(1, dtype=np.int64)
    points = np.column_stack([flat, np.zeros(1024)])
    setup = Setup(
        points=points, normals=np.repeat(three, 1024, axis=0), level_depth=np.zeros(128),
        rod_radius=2.5e-3, rod_edge=1e-3,
    )  # fmt: skip
    return Store(
        location=str(folder), attributes={}, setups=(setup,), setup_index=zero,
        profile=np.zeros((1, 1024, 128), dtype=np.uint8), done=one.astype(bool),
        shape=zero, softness=zero, geometry=zero,
        modulus=one, direction=three, path_start=three, frame_start=zero, frame_count=np.array([frames]),
        frame_poke=np.zeros(frames, dtype=np.int64), depth=np.full(frames, 1e-3),
        rod_force=np.repeat(three, frames, axis=0), solved_as=zero,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=14000)
    options = parser.parse_args()
    data = fields(options.frames)
    table = Table(title=f"{len(data)} frames, {data.nbytes / 1e6:.0f} MB; thousand frames a second")
    for head in ("frames a chunk / shard, codec", "size", "streamed", "memmap", "ratio", "in memory"):
        table.add_column(head, justify="left" if head[:8] == "frames a" else "right")
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, chunk, shard, codec, shuffle) in enumerate(LAYOUTS):
            path = Path(folder) / f"{number}.zarr"
            array = zarr.create_group(path).create_array(
                "grid_displacement",
                shape=data.shape,
                dtype="f4",
                chunks=(chunk, 32, 32, 3),
                shards=(shard, 32, 32, 3),
                compressors=BloscCodec(cname=codec, clevel=3, shuffle=BloscShuffle(shuffle), typesize=4)
                if codec
                else None,
            )
            for first in range(0, len(data), shard):
                array[first : first + shard] = data[first : first + shard]
            group_here(str(path), fresh=True)
            store = store_of(path, data)
            rates = loader_rates(store)
            size = sum(f.stat().st_size for f in path.rglob("*") if f.is_file())
            stream, memmap = rates["streamed, shuffled shards"], rates["NumPy memmap"]
            table.add_row(
                name,
                f"{size / data.nbytes:.2f}",
                f"{stream / 1e3:.1f}",
                f"{memmap / 1e3:.1f}",
                f"{stream / memmap:.2f}",
                f"{rates['in memory'] / 1e3:.1f}",
            )
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
