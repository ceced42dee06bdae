"""Frames as batches of tensors: a part in memory, or streamed shard by shard through a shuffle buffer."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, fields

import numpy as np
import torch
import torch.utils.data
from numpy.typing import NDArray
from torch import Tensor

from learn.data.opening import open_store
from learn.data.store import Store
from learn.errors import InputError

Floats32 = NDArray[np.float32]
_READERS = 2  # threads: decompression takes some four times as long as shuffling


def no_clock(count: int = 0) -> Tensor:
    """Empty clock (count, 0) of frames without time."""
    return torch.empty(count, 0, dtype=torch.float64)


@dataclass(frozen=True, eq=False, kw_only=True)
class Batch:
    """b frames on one grid of n points. SI units.

    Positions are in float64, so that translating the scene far from the origin costs no digits.

    Attributes
    ----------
    frame : row of the store, shape (b,).
    geometry : row of the store's profile, shape (b,).
    start : the indenter's tip at first contact [m], shape (b, 3).
    direction : unit vector of the push, shape (b, 3).
    depth : travel since first contact [m], shape (b,).
    modulus : shear modulus at small strain [Pa], shape (b,).
    displacement : displacement of the grid's points [m], shape (b, n, 3), float32.
    force : magnitude of the force on the indenter [N], shape (b,), float32.
    clock : time since first contact [s], the rod's speed along the push and its speed of approach [m/s]
        (`Clock`), shape (b, 3); shape (b, 0) if the dataset has no time.
    """

    frame: Tensor
    geometry: Tensor
    start: Tensor
    direction: Tensor
    depth: Tensor
    modulus: Tensor
    displacement: Tensor
    force: Tensor
    clock: Tensor = field(default_factory=no_clock)

    def __len__(self) -> int:
        return len(self.frame)

    def to(self, device: torch.device | str) -> Batch:
        """The same batch on a device."""
        return Batch(**{f.name: getattr(self, f.name).to(device, non_blocking=True) for f in fields(self)})


def without_fields(store: Store, rows: NDArray[np.int64]) -> Batch:
    """Batch of these frames at no points: the pokes, and the forces."""
    return make_batch(store, rows, np.empty((len(rows), 0, 3), dtype=np.float32))


def make_batch(store: Store, rows: NDArray[np.int64], displacement: NDArray[np.float32]) -> Batch:
    """Batch of these frames, with their `displacement` (b, n, 3), which is not copied."""
    poke = store.frame_poke[rows]
    return Batch(
        frame=torch.from_numpy(rows),
        geometry=torch.from_numpy(store.geometry[poke]),
        start=torch.from_numpy(store.path_start[poke]),
        direction=torch.from_numpy(store.direction[poke]),
        depth=torch.from_numpy(store.depth[rows]),
        modulus=torch.from_numpy(store.modulus[poke]),
        displacement=torch.from_numpy(displacement),
        force=torch.from_numpy(np.linalg.norm(store.rod_force[rows], axis=1).astype(np.float32)),
        clock=torch.from_numpy(store.clocks(rows)),
    )


def epoch_order(count: int, seed: int, epoch: int) -> NDArray[np.int64]:
    """Random order of one epoch, a function of seed and epoch alone, so that a resumed run repeats it."""
    return np.random.default_rng(np.random.SeedSequence(entropy=seed, spawn_key=(epoch,))).permutation(count)


class MemoryDataset(torch.utils.data.Dataset[Batch]):
    """A map-style torch dataset; with a DataLoader use `collate_fn=lambda batch: batch`.

    >>> data = MemoryDataset(store, split.train)
    >>> for batch in data.batches(64, seed=1, epoch=0): ...
    """

    def __init__(self, store: Store, rows: NDArray[np.int64]) -> None:
        self.store, self.rows = store, np.asarray(rows, dtype=np.int64)
        self._displacement = np.empty((len(rows), store.n_points, 3), dtype=np.float32)
        shard = store.shard
        for first in np.unique(self.rows // shard) * shard:
            here = np.flatnonzero((self.rows >= first) & (self.rows < first + shard))
            values = store.displacement(slice(int(first), min(int(first) + shard, store.frames)))
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
        """Batches of one epoch, in random order if a seed is given.

        Process `rank` of `world` gets every `world`-th batch; all processes get equally many (with several
        processes, the epoch's last incomplete round is left out).
        """
        count = len(self)
        order = np.arange(count) if seed is None else epoch_order(count, seed, epoch)
        if world > 1:
            order = order[: count - count % (size * world)] if count >= size * world else order
        for first in range(rank * size, len(order), size * world):
            yield self.__getitems__(order[first : first + size])


class StreamDataset(torch.utils.data.IterableDataset[Batch]):
    """An iterable torch dataset of whole batches; with a DataLoader use `batch_size=None`.

    Shards (files of the store) are read in random order into a buffer of `shuffle_buffer` shards; batches are
    drawn at random from the buffer while two other threads read the next shard. Memory is thus bounded by
    shuffle_buffer + 2 shards (`bytes_held`) and, from a URL, the compressed bytes of one, whatever the
    store's size, and every frame occurs exactly once per epoch. Loader workers and the ranks of torchrun each
    take a subset of the shards, with a different shuffle in each. InputError if a frame is given twice, or is
    none of the store.

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
        shuffle_buffer: int = 4,
        seed: int | None = 0,
        rank: int = 0,
        world: int = 1,
    ) -> None:
        self.store = store if isinstance(store, Store) else open_store(store)
        self.rows = np.unique(np.asarray(rows, dtype=np.int64))
        frames = self.store.frames
        if len(self.rows) < len(rows) or ((self.rows < 0) | (self.rows >= frames)).any():
            raise InputError(
                f"rows: expected each of the {frames} frames of the store, 0 and up, at most once"
            )
        if batch < 1:
            raise InputError(f"batch: expected 1 or more frames, got {batch}")
        self.batch, self.shuffle_buffer, self.seed = batch, max(1, shuffle_buffer), seed
        self.rank, self.world = rank, world
        self._per_shard, self._chunk = self.store.shard, self.store.chunk  # slow to look up
        # shared, so that workers of a DataLoader see it change
        self._epoch = torch.zeros(1, dtype=torch.int64).share_memory_()
        self._spare: list[list[Floats32]] = []

    @property
    def epoch(self) -> int:
        """Number of the epoch, of which the order is a function."""
        return int(self._epoch)

    @epoch.setter
    def epoch(self, number: int) -> None:
        self._epoch.fill_(number)

    @property
    def bytes_held(self) -> int:
        """Upper bound of the displacement held at any time [bytes]."""
        return (self.shuffle_buffer + 2) * self._per_shard * self.store.n_points * 3 * 4

    def __len__(self) -> int:
        """Number of frames; that of batches depends on the workers."""
        return len(self.rows)

    def __iter__(self) -> Iterator[Batch]:
        worker = torch.utils.data.get_worker_info()
        count, number = (worker.num_workers, worker.id) if worker is not None else (1, 0)
        share, shares = self.rank * count + number, self.world * count
        shards = np.unique(self.rows // self._per_shard)
        if self.seed is not None:
            shards = shards[epoch_order(len(shards), self.seed, self.epoch)]
        random = np.random.default_rng(
            np.random.SeedSequence(entropy=self.seed or 0, spawn_key=(self.epoch, share))
        )
        yield from self._deal(shards[share::shares], random)

    def _deal(self, shards: NDArray[np.int64], random: np.random.Generator) -> Iterator[Batch]:
        counts = [len(self._rows_of(int(shard))) for shard in shards]
        room = min(self.shuffle_buffer * self._per_shard, sum(counts))
        # new memory costs as much as decompressing into it: the next epoch reuses the buffers
        buffers = self._spare.pop() if self._spare else self._buffers()
        held = buffers[0]
        rows = np.empty(room, dtype=np.int64)
        room_to_read = buffers[1:]  # a shard is read into one while the other is copied into the buffer
        free, full = np.arange(room), np.empty(0, dtype=np.int64)  # positions in the buffer
        with ThreadPoolExecutor(_READERS) as readers:
            waiting = [self._ask(readers, int(shard), room_to_read[0]) for shard in shards[:1]]
            for number, count in enumerate(counts):
                room_here = room_to_read[number % 2]
                for part in waiting.pop():
                    part.result()
                if number + 1 < len(shards):
                    spare = room_to_read[(number + 1) % 2]
                    waiting.append(self._ask(readers, int(shards[number + 1]), spare))
                while len(free) < count:
                    pick, full = full[: self.batch], full[self.batch :]
                    yield make_batch(self.store, rows[pick], held[pick])
                    free = np.concatenate([free, pick])
                place, free = free[:count], free[count:]
                rows[place] = self._rows_of(int(shards[number]))
                self._fill(held, place, int(shards[number]), room_here)
                full = np.concatenate([full, place])
                full = random.permutation(full) if self.seed is not None else full
        for first in range(0, len(full), self.batch):
            pick = full[first : first + self.batch]
            yield make_batch(self.store, rows[pick], held[pick])
        self._spare.append(buffers)

    def _buffers(self) -> list[Floats32]:
        shard, points = min(self._per_shard, self.store.frames), self.store.n_points
        held = min(self.shuffle_buffer * self._per_shard, len(self.rows))
        return [np.empty((count, points, 3), dtype=np.float32) for count in (held, shard, shard)]

    def _rows_of(self, shard: int) -> NDArray[np.int64]:
        first = shard * self._per_shard
        low, high = np.searchsorted(self.rows, [first, first + self._per_shard])
        return self.rows[low:high]

    def _span(self, shard: int) -> tuple[int, int]:
        rows = self._rows_of(shard)
        return int(rows[0]), int(rows[-1]) + 1

    def _ask(self, readers: ThreadPoolExecutor, shard: int, room: Floats32) -> list[Future[Floats32]]:
        """Read a shard's frames, divided between two chunks so that both readers have equal work."""
        start, stop = self._span(shard)
        chunk = self._chunk
        middle = min(max(round((start + stop) / 2 / chunk) * chunk, start), stop)
        return [
            readers.submit(self.store.displacement, slice(a, b), room[a - start : b - start])
            for a, b in ((start, middle), (middle, stop))
            if a < b
        ]

    def _fill(self, held: Floats32, place: NDArray[np.int64], shard: int, room: Floats32) -> None:
        """Copy a shard's frames from the room that it was read into to their places in the buffer."""
        start, stop = self._span(shard)
        at = self._rows_of(shard) - start
        for first in range(0, len(at), self.batch):  # in slices, since an index of rows makes a copy
            some = slice(first, min(first + self.batch, len(at)))
            held[place[some]] = room[some] if len(at) == stop - start else room[at[some]]
