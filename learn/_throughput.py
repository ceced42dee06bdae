"""Frames a second out of the loaders, beside a NumPy memmap of the same array."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from learn.data import Batch, MemoryDataset, Store, StreamDataset, make_batch
from learn.data.memory import epoch_order


def _memmap_batches(store: Store, array: np.memmap, size: int, epoch: int) -> Iterator[Batch]:
    order = epoch_order(len(array), 1, epoch)
    for first in range(0, len(order), size):
        rows = order[first : first + size]
        yield make_batch(store, rows, np.asarray(array[rows]))


def _rate(frames: int, epoch: Callable[[int], Iterable[Batch]], repeats: int) -> float:
    seconds = []
    for number in range(repeats):
        begun = time.perf_counter()
        for batch in epoch(number):
            batch.displacement[:, ::64].sum()  # touch every frame
        seconds.append(time.perf_counter() - begun)
    return frames / statistics.median(seconds)


def loader_rates(store: Store, *, batch: int = 64, pool: int = 4, repeats: int = 3) -> dict[str, float]:
    """Frames a second of whole epochs in random order: streamed, in memory, and a memmap. File cache warm."""
    rows = np.arange(store.frames)
    stream = StreamDataset(store, rows, batch=batch, pool=pool, seed=1)

    def streamed(epoch: int) -> Iterable[Batch]:
        stream.epoch = epoch
        return stream

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "displacement.f4"
        shape = (store.frames, len(store.points), 3)
        array = np.memmap(path, dtype=np.float32, mode="w+", shape=shape)
        for first in range(0, store.frames, store.block):
            block = store.displacement(slice(first, min(first + store.block, store.frames)))
            array[first : first + len(block)] = block
        array.flush()
        mapped = np.memmap(path, dtype=np.float32, mode="r", shape=shape)
        rates = {
            "streamed, shuffled blocks": _rate(store.frames, streamed, repeats),
            "NumPy memmap": _rate(store.frames, lambda e: _memmap_batches(store, mapped, batch, e), repeats),
        }
    memory = MemoryDataset(store, rows)
    rates["in memory"] = _rate(store.frames, lambda e: memory.batches(batch, seed=1, epoch=e), repeats)
    return rates
