"""Streaming: every frame once, in an order fixed by a seed, in bounded memory, from a folder or by HTTP."""

from __future__ import annotations

import functools
import threading
import tracemalloc
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest
import torch.utils.data

from learn.data import Batch, MemoryDataset, Store, StreamDataset, open_store, split_pokes
from learn.errors import InputError
from tests.learn.small_store import write_store


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_store(tmp_path_factory.mktemp("stream") / "small.zarr", shapes=5)


@pytest.fixture(scope="module")
def store(folder: Path) -> Store:
    return open_store(folder)


def _frames(batches: Iterator[Batch] | StreamDataset) -> list[int]:
    return [int(frame) for batch in batches for frame in batch.frame]


@pytest.mark.parametrize("rows", [[0, 0, 2], [-1, 0], [0, 10_000]])
def test_frames_that_are_none_or_come_twice_are_refused(store: Store, rows: list[int]) -> None:
    """[0, 0, 2] was given the displacement of the frames 0, 1 and 2."""
    with pytest.raises(InputError, match=r"rows: expected each of the .* frames of the store, 0 and up"):
        StreamDataset(store, np.array(rows))
    with pytest.raises(InputError, match="batch: expected 1 or more"):
        StreamDataset(store, np.array([0]), batch=0)  # went on without end


def test_each_frame_comes_once_with_its_own_values(store: Store) -> None:
    rows = split_pokes(store, fold=2).train
    whole = store.displacement(slice(0, store.frames))
    seen = []
    for batch in StreamDataset(store, rows, batch=7, shuffle_buffer=2, seed=3):
        np.testing.assert_array_equal(batch.displacement, whole[batch.frame])
        np.testing.assert_allclose(batch.depth, store.depth[batch.frame])
        seen += batch.frame.tolist()
    assert sorted(seen) == rows.tolist()


def test_order_depends_on_seed_and_epoch_alone(store: Store) -> None:
    rows = np.arange(store.frames)
    data = StreamDataset(store, rows, batch=8, shuffle_buffer=2, seed=3)
    first, again = _frames(data), _frames(data)
    assert first == again != sorted(first)
    data.epoch = 1
    assert _frames(data) != first
    assert _frames(StreamDataset(store, rows, batch=8, shuffle_buffer=2, seed=None)) == sorted(first)


def test_blocks_are_mixed(store: Store) -> None:
    """A batch contains frames of several blocks, not a sequence of one."""
    data = StreamDataset(store, np.arange(store.frames), batch=8, shuffle_buffer=4, seed=0)
    batches = [batch.frame.numpy() // store.shard for batch in data]
    assert np.mean([len(np.unique(blocks)) for blocks in batches]) > 2


def test_memory_is_bounded_by_the_pool(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames read but not yet returned never exceed the shuffle buffer and two blocks in transit."""
    read = given = most = 0
    plain = Store.displacement

    def counted(
        self: Store, rows: slice, out: np.ndarray[tuple[int, ...], np.dtype[np.float32]] | None = None
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
        nonlocal read
        read += rows.stop - rows.start
        return plain(self, rows, out)

    monkeypatch.setattr(Store, "displacement", counted)
    data = StreamDataset(store, np.arange(store.frames), batch=4, shuffle_buffer=2)
    for batch in data:
        most = max(most, read - given)
        given += len(batch)
    assert most * 1024 * 12 <= data.bytes_held < store.frames * 1024 * 12


@pytest.mark.parametrize("scheme", ["", "file://"])
def test_memory_is_bounded_where_a_part_takes_some_frames_of_a_shard(scheme: str, tmp_path: Path) -> None:
    """Every second frame takes what all take, and some batches and chunks: no copy of a shard, at a URL its
    compressed bytes."""
    folder = write_store(tmp_path / "s.zarr", frames=16, chunk=4, shard=96)
    store = open_store(f"{scheme}{folder}")
    compressed = max(p.stat().st_size for p in (folder / "grid_displacement" / "c").rglob("*") if p.is_file())
    rows = np.arange(0, store.frames, 2)
    data = StreamDataset(store, rows, batch=4, shuffle_buffer=1, seed=1)
    tracemalloc.start()
    try:
        seen = sorted(_frames(data))
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert seen == rows.tolist()
    assert most < data.bytes_held + 24 * 1024 * 12 + (compressed if scheme else 0)


@pytest.mark.parametrize("workers", [0, 2])
def test_workers_of_a_loader_share_the_work(store: Store, workers: int) -> None:
    data = StreamDataset(store, np.arange(store.frames), batch=8, seed=1)
    loader = torch.utils.data.DataLoader(data, batch_size=None, num_workers=workers)
    assert sorted(_frames(iter(loader))) == list(range(store.frames))


def test_workers_that_stay_see_the_next_epoch(store: Store) -> None:
    data = StreamDataset(store, np.arange(store.frames), batch=8, seed=1)
    loader = torch.utils.data.DataLoader(data, batch_size=None, num_workers=1, persistent_workers=True)
    orders = []
    for data.epoch in (0, 1, 0):
        orders.append(_frames(iter(loader)))
    assert orders[0] == orders[2] != orders[1]
    assert sorted(orders[1]) == list(range(store.frames))


def test_ranks_share_the_work(store: Store) -> None:
    rows = np.arange(store.frames)
    shares = [_frames(StreamDataset(store, rows, batch=8, rank=rank, world=2)) for rank in (0, 1)]
    assert sorted(shares[0] + shares[1]) == rows.tolist()
    memory = MemoryDataset(store, rows)
    parts = [_frames(memory.batches(4, seed=1, rank=rank, world=2)) for rank in (0, 1)]
    assert len(parts[0]) == len(parts[1])
    assert not set(parts[0]) & set(parts[1])


def test_memory_dataset_in_a_plain_loader(store: Store) -> None:
    data = MemoryDataset(store, np.arange(10))
    loader = torch.utils.data.DataLoader(data, batch_size=4, collate_fn=lambda batch: batch)
    assert [len(batch) for batch in loader] == [4, 4, 2]


class _Ranges(SimpleHTTPRequestHandler):
    """File server with byte ranges, like an object store; the standard handler has none."""

    def do_GET(self) -> None:
        path, asked = Path(self.translate_path(self.path)), self.headers.get("Range")
        if not path.is_file():
            self.send_error(404)
            return
        body = path.read_bytes()
        size, status = len(body), 200
        if asked:
            low, high = asked.removeprefix("bytes=").split("-")
            first = int(low) if low else size - int(high)
            body = body[first : int(high) + 1 if low and high else size]
            status = 206
        self.send_response(status)
        if asked:
            self.send_header("Content-Range", f"bytes {first}-{first + len(body) - 1}/{size}")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_args: object) -> None:
        pass


@pytest.fixture
def server(folder: Path) -> Iterator[str]:
    handler = functools.partial(_Ranges, directory=str(folder.parent))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as http:
        thread = threading.Thread(target=http.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{http.server_port}"
        http.shutdown()
        thread.join()


def test_over_http_the_same_as_from_a_folder(server: str, store: Store) -> None:
    far = open_store(f"{server}/small.zarr")
    assert far.uuid == store.uuid
    np.testing.assert_array_equal(far.profile, store.profile)
    rows = split_pokes(far).train
    near = list(StreamDataset(store, rows, batch=8, seed=5))
    for a, b in zip(StreamDataset(far, rows, batch=8, seed=5), near, strict=True):
        np.testing.assert_array_equal(a.displacement, b.displacement)


def test_over_http_a_damaged_index_of_a_shard_is_named(server: str, folder: Path) -> None:
    far = open_store(f"{server}/small.zarr")
    shard = next(p for p in (folder / "grid_displacement" / "c").rglob("*") if p.is_file())
    kept = shard.read_bytes()
    shard.write_bytes(kept[:-9] + bytes([kept[-9] ^ 1]) + kept[-8:])
    try:
        with pytest.raises(InputError, match=r"cannot be read \(the checksum of a shard's index"):
            far.displacement(slice(0, far.frames))
    finally:
        shard.write_bytes(kept)


def test_over_http_what_is_missing_is_named(server: str, folder: Path) -> None:
    with pytest.raises(InputError, match="nowhere"):
        open_store(f"{server}/nowhere.zarr")
    lost = next(p for p in (folder / "grid_displacement" / "c").rglob("*") if p.is_file())
    kept = lost.read_bytes()
    lost.unlink()
    try:
        with pytest.raises(InputError, match="is missing, the store is incomplete"):
            open_store(f"{server}/small.zarr")
    finally:
        lost.write_bytes(kept)
