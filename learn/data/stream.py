"""Frames of a store too large for memory: read block by block, shuffled through a bounded pool."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import torch.utils.data
from numpy.typing import NDArray

from learn.data.batch import Batch, make_batch
from learn.data.memory import epoch_order
from learn.data.store import Store, open_store

Floats32 = NDArray[np.float32]


class StreamDataset(torch.utils.data.IterableDataset[Batch]):
    """An iterable torch dataset of whole batches; with a DataLoader use `batch_size=None`.

    Blocks (files of the store) come in random order into a pool of `pool` blocks; batches are drawn at
    random from the pool while the next block is read in another thread. So memory is bounded by pool + 2
    blocks (`bytes_held`), whatever the store's size, and every frame comes exactly once an epoch. Loader
    workers and the ranks of torchrun each take their share of the blocks: in each, the order is another.

    >>> data = StreamDataset("https://example.org/pokes.zarr", split.train, batch=64, seed=1)
    >>> data.epoch = 3
    >>> for batch in data: ...
    """

    def __init__(
        self,
        store: Store | str,
        rows: NDArray[np.int64],
        *,
        batch: int = 64,
        pool: int = 4,
        seed: int | None = 0,
        rank: int = 0,
        world: int = 1,
    ) -> None:
        self.store = store if isinstance(store, Store) else open_store(store)
        self.rows = np.sort(np.asarray(rows, dtype=np.int64))
        self.batch, self.pool, self.seed, self.rank, self.world = batch, max(1, pool), seed, rank, world
        self.epoch = 0
        self._spare: list[list[Floats32]] = []

    @property
    def bytes_held(self) -> int:
        """Upper bound of the displacement held at any time [bytes]."""
        return (self.pool + 2) * self.store.block * len(self.store.points) * 3 * 4

    def __len__(self) -> int:
        """Frames, not batches: how many batches there are depends on the workers."""
        return len(self.rows)

    def __iter__(self) -> Iterator[Batch]:
        worker = torch.utils.data.get_worker_info()
        count, number = (worker.num_workers, worker.id) if worker is not None else (1, 0)
        share, shares = self.rank * count + number, self.world * count
        blocks = np.unique(self.rows // self.store.block)
        if self.seed is not None:
            blocks = blocks[epoch_order(len(blocks), self.seed, self.epoch)]
        random = np.random.default_rng(
            np.random.SeedSequence(entropy=self.seed or 0, spawn_key=(self.epoch, share))
        )
        yield from self._deal(blocks[share::shares], random)

    def _deal(self, blocks: NDArray[np.int64], random: np.random.Generator) -> Iterator[Batch]:
        counts = [len(self._rows_of(int(block))) for block in blocks]
        room = min(self.pool * self.store.block, sum(counts))
        # fresh memory costs as much as decompressing into it: an epoch hands its room to the next
        buffers = self._spare.pop() if self._spare else self._buffers()
        held = buffers[0]
        rows = np.empty(room, dtype=np.int64)
        room_to_read = buffers[1:]  # a block is read into one while the other is dealt into the pool
        free, full = np.arange(room), np.empty(0, dtype=np.int64)  # places in the pool
        with ThreadPoolExecutor(1) as reader:
            waiting = [reader.submit(self._read, int(block), room_to_read[0]) for block in blocks[:1]]
            for number, count in enumerate(counts):
                new_rows, new = waiting.pop().result()
                if number + 1 < len(blocks):
                    spare = room_to_read[(number + 1) % 2]
                    waiting.append(reader.submit(self._read, int(blocks[number + 1]), spare))
                while len(free) < count:
                    pick, full = full[: self.batch], full[self.batch :]
                    yield make_batch(self.store, rows[pick], held[pick])
                    free = np.concatenate([free, pick])
                place, free = free[:count], free[count:]
                rows[place], held[place] = new_rows, new
                full = np.concatenate([full, place])
                full = random.permutation(full) if self.seed is not None else full
        for first in range(0, len(full), self.batch):
            pick = full[first : first + self.batch]
            yield make_batch(self.store, rows[pick], held[pick])
        self._spare.append(buffers)

    def _buffers(self) -> list[Floats32]:
        block, points = min(self.store.block, self.store.frames), len(self.store.points)
        held = min(self.pool * self.store.block, len(self.rows))
        return [np.empty((count, points, 3), dtype=np.float32) for count in (held, block, block)]

    def _rows_of(self, block: int) -> NDArray[np.int64]:
        first = block * self.store.block
        low, high = np.searchsorted(self.rows, [first, first + self.store.block])
        return self.rows[low:high]

    def _read(self, block: int, room: Floats32) -> tuple[NDArray[np.int64], Floats32]:
        rows = self._rows_of(block)
        span = slice(int(rows[0]), int(rows[-1]) + 1)
        values = self.store.displacement(span, room[: span.stop - span.start])
        return rows, values if len(values) == len(rows) else values[rows - span.start]
