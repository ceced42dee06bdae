"""Chunks, shards and codecs for the dataset's biggest array, measured side by side.

    python -m benchmarks.store_layout [--frames 3072] [--repeats 3]

The array is `grid_displacement` (frame, 32, 32, 3) in float32, filled with decaying fields of random
pokes, so that it compresses as the real one does. For each layout: write, size on disk, a training batch
of 64 random frames, the same batch out of shuffled blocks (a shard's worth of neighbouring frames read at
once and then dealt out, as learn/ streams what does not fit in memory), and the whole array into memory.
Medians; the file cache is warm.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import zarr
from rich.console import Console
from rich.table import Table
from zarr.codecs import BloscCodec, BloscShuffle, ZstdCodec

# name, frames a chunk, frames a shard (0: one file a chunk), codec
LAYOUTS: list[tuple[str, int, int, Any]] = [
    ("1 / 1024, zstd shuffle", 1, 1024, "shuffle"),
    ("16 / 1024, zstd shuffle", 16, 1024, "shuffle"),
    ("64 / 1024, zstd shuffle", 64, 1024, "shuffle"),
    ("256 / 1024, zstd shuffle (ours)", 256, 1024, "shuffle"),
    ("1024 / 1024, zstd shuffle", 1024, 1024, "shuffle"),
    ("256 unsharded, zstd shuffle", 256, 0, "shuffle"),
    ("256 / 1024, zstd bitshuffle", 256, 1024, "bitshuffle"),
    ("256 / 1024, plain zstd", 256, 1024, "plain"),
    ("256 / 1024, none", 256, 1024, None),
]
BATCH = 64
BLOCK = 1024


def fields(frames: int, seed: int = 0) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Displacements of random pokes, 16 frames each: decaying from the rod's site."""
    random = np.random.default_rng(seed)
    x = (np.arange(32) + 0.5) / 32 * 0.1 - 0.05
    grid = np.stack(np.meshgrid(x, x), axis=-1)
    out = np.empty((frames, 32, 32, 3), dtype=np.float32)
    for start in range(0, frames, 16):
        site = random.uniform(-0.03, 0.03, 2)
        heading = random.normal(size=3) * (0.4, 0.4, 0.2) - (0, 0, 1)
        offset = grid - site
        radius = np.sqrt((offset**2).sum(-1) + 0.004**2)
        fall = (0.004 / radius) * np.exp(-radius / 0.03)
        spread = np.concatenate([offset / radius[..., None] * 0.2, np.zeros((32, 32, 1))], axis=-1)
        for k in range(start, min(start + 16, frames)):
            depth = 0.001 * (k - start + 1)
            out[k] = depth * fall[..., None] * (heading + spread * (1 + 20 * depth))
    return out


def codec_of(name: str | None) -> Any:
    if name is None:
        return None
    if name == "plain":
        return ZstdCodec(level=3)
    return BloscCodec(cname="zstd", clevel=3, shuffle=BloscShuffle(name), typesize=4)


def median(action: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        action()
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=3072)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    data = fields(options.frames)
    random = np.random.default_rng(1)
    batches = [np.sort(random.choice(len(data), BATCH, replace=False)) for _ in range(50)]
    table = Table(title=f"grid_displacement, {len(data)} frames, {data.nbytes / 1e6:.0f} MB")
    for head in (
        "frames a chunk / shard, codec",
        "write s",
        "size",
        "random batch ms",
        "block batch ms",
        "all s",
    ):
        table.add_column(head, justify="right")
    folder = Path(tempfile.mkdtemp())
    try:
        for number, (name, chunk, shard, code) in enumerate(LAYOUTS):
            path = folder / f"{number}.zarr"
            codec = codec_of(code)

            def write(path: Path = path, chunk: int = chunk, shard: int = shard, codec: Any = codec) -> None:
                array = zarr.create_array(
                    store=path,
                    shape=data.shape,
                    dtype="f4",
                    chunks=(chunk, 32, 32, 3),
                    shards=(shard, 32, 32, 3) if shard else None,
                    compressors=codec,
                    overwrite=True,
                )
                for start in range(0, len(data), BLOCK):
                    array[start : start + BLOCK] = data[start : start + BLOCK]

            seconds = median(write, options.repeats)
            size = sum(f.stat().st_size for f in path.rglob("*") if f.is_file())
            array: Any = zarr.open_array(store=path, mode="r")
            picks = iter(batches)
            batch = median(lambda array=array, picks=picks: array.oindex[next(picks)], 3 * options.repeats)
            blocks = median(lambda array=array: array[:BLOCK], options.repeats) * BATCH / BLOCK
            whole = median(lambda array=array: array[:], options.repeats)
            table.add_row(
                name,
                f"{seconds:.2f}",
                f"{size / data.nbytes:.2f}",
                f"{batch * 1e3:.0f}",
                f"{blocks * 1e3:.2f}",
                f"{whole:.2f}",
            )
            shutil.rmtree(path)
    finally:
        shutil.rmtree(folder)
    Console().print(table)


if __name__ == "__main__":
    main()
