"""Frames of a store too large for memory: read block by block, shuffled through a bounded pool."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
import torch.utils.data
from numpy.typing import NDArray

from learn.data.batch import Batch, make_batch
from learn.data.memory import epoch_order
from learn.data.store import Store, open_store

Floats32 = NDArray[np.float32]
_READERS = 2  # threads: decompressing takes some four times as long as dealing


class StreamDataset(torch.utils.data.IterableDataset[Batch]):
    """An iterable torch dataset of whole batches; with a DataLoader use `batch_size=None`.

    Blocks (files of the store) come in random order into a pool of `pool` blocks; batches are drawn at
    random from the pool while the next block is read in two other threads. So memory is bounded by pool + 2
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
        self._block, self._chunk = self.store.block, self.store.chunk  # asking the store takes milliseconds
        self.epoch = 0
        self._spare: list[list[Floats32]] = []

    @property
    def bytes_held(self) -> int:
        """Upper bound of the displacement held at any time [bytes]."""
        return (self.pool + 2) * self._block * len(self.store.points) * 3 * 4

    def __len__(self) -> int:
        """Frames, not batches: how many batches there are depends on the workers."""
        return len(self.rows)

    def __iter__(self) -> Iterator[Batch]:
        worker = torch.utils.data.get_worker_info()
        count, number = (worker.num_workers, worker.id) if worker is not None else (1, 0)
        share, shares = self.rank * count + number, self.world * count
        blocks = np.unique(self.rows // self._block)
        if self.seed is not None:
            blocks = blocks[epoch_order(len(blocks), self.seed, self.epoch)]
        random = np.random.default_rng(
            np.random.SeedSequence(entropy=self.seed or 0, spawn_key=(self.epoch, share))
        )
        yield from self._deal(blocks[share::shares], random)

    def _deal(self, blocks: NDArray[np.int64], random: np.random.Generator) -> Iterator[Batch]:
        counts = [len(self._rows_of(int(block))) for block in blocks]
        room = min(self.pool * self._block, sum(counts))
        # fresh memory costs as much as decompressing into it: an epoch hands its room to the next
        buffers = self._spare.pop() if self._spare else self._buffers()
        held = buffers[0]
        rows = np.empty(room, dtype=np.int64)
        room_to_read = buffers[1:]  # a block is read into one while the other is dealt into the pool
        free, full = np.arange(room), np.empty(0, dtype=np.int64)  # places in the pool
        with ThreadPoolExecutor(_READERS) as readers:
            waiting = [self._ask(readers, int(block), room_to_read[0]) for block in blocks[:1]]
            for number, count in enumerate(counts):
                new_rows, new = self._got(int(blocks[number]), room_to_read[number % 2], waiting.pop())
                if number + 1 < len(blocks):
                    spare = room_to_read[(number + 1) % 2]
                    waiting.append(self._ask(readers, int(blocks[number + 1]), spare))
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
        block, points = min(self._block, self.store.frames), len(self.store.points)
        held = min(self.pool * self._block, len(self.rows))
        return [np.empty((count, points, 3), dtype=np.float32) for count in (held, block, block)]

    def _rows_of(self, block: int) -> NDArray[np.int64]:
        first = block * self._block
        low, high = np.searchsorted(self.rows, [first, first + self._block])
        return self.rows[low:high]

    def _span(self, block: int) -> tuple[int, int]:
        rows = self._rows_of(block)
        return int(rows[0]), int(rows[-1]) + 1

    def _ask(self, readers: ThreadPoolExecutor, block: int, room: Floats32) -> list[Future[Floats32]]:
        """Reads a block's frames, cut between two chunks so that both readers have as much to do."""
        start, stop = self._span(block)
        chunk = self._chunk
        middle = min(max(round((start + stop) / 2 / chunk) * chunk, start), stop)
        return [
            readers.submit(self.store.displacement, slice(a, b), room[a - start : b - start])
            for a, b in ((start, middle), (middle, stop))
            if a < b
        ]

    def _got(
        self, block: int, room: Floats32, asked: list[Future[Floats32]]
    ) -> tuple[NDArray[np.int64], Floats32]:
        for part in asked:
            part.result()
        rows, (start, stop) = self._rows_of(block), self._span(block)
        return rows, room[: len(rows)] if len(rows) == stop - start else room[rows - start]
