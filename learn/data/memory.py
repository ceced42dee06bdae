"""The frames of one part of a store, held in memory."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import torch.utils.data
from numpy.typing import NDArray

from learn.data.batch import Batch, make_batch
from learn.data.store import Store


def epoch_order(count: int, seed: int, epoch: int) -> NDArray[np.int64]:
    """The random order of one epoch: a function of seed and epoch alone, so that a resumed run goes on."""
    return np.random.default_rng(np.random.SeedSequence(entropy=seed, spawn_key=(epoch,))).permutation(count)


class MemoryDataset(torch.utils.data.Dataset[Batch]):
    """A map-style torch dataset; with a DataLoader use `collate_fn=lambda batch: batch`.

    >>> data = MemoryDataset(store, split.train)
    >>> for batch in data.batches(64, seed=1, epoch=0): ...
    """

    def __init__(self, store: Store, rows: NDArray[np.int64]) -> None:
        self.store, self.rows = store, np.asarray(rows, dtype=np.int64)
        self._displacement = np.empty((len(rows), len(store.points), 3), dtype=np.float32)
        block = store.block
        for first in np.unique(self.rows // block) * block:
            here = np.flatnonzero((self.rows >= first) & (self.rows < first + block))
            values = store.displacement(slice(int(first), min(int(first) + block, store.frames)))
            self._displacement[here] = values[self.rows[here] - first]

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: int) -> Batch:
        return self.__getitems__([index])

    def __getitems__(self, index: list[int] | NDArray[np.int64]) -> Batch:
        picked = np.asarray(index, dtype=np.int64)
        return make_batch(self.store, self.rows[picked], self._displacement[picked])

    def batches(
        self, size: int, *, seed: int | None = None, epoch: int = 0, rank: int = 0, world: int = 1
    ) -> Iterator[Batch]:
        """Batches of one epoch, in random order where a seed is given.

        rank, world: this process's share of every batch; all processes get as many batches (the epoch's
        last, incomplete round is left out where there is more than one process).
        """
        count = len(self)
        order = np.arange(count) if seed is None else epoch_order(count, seed, epoch)
        if world > 1:
            order = order[: count - count % (size * world)] if count >= size * world else order
        for first in range(rank * size, len(order), size * world):
            yield self.__getitems__(order[first : first + size])
