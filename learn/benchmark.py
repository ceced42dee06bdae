"""Latency of one prediction and throughput of the loaders, with reference timings of the same machine."""

from __future__ import annotations

import itertools
import statistics
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
import torch

from learn.data import Batch, MemoryDataset, Store, StreamDataset, make_batch
from learn.data.loaders import epoch_order, without_fields
from learn.models import InvariantGnn, Model, Pokes, Response, Scene, Scenes, pokes_of
from learn.models.single_poke import SinglePoke
from learn.onnx_bundle import OnnxBundle, bundle_in
from learn.predictor import Predictor
from learn.quantities import interior_of
from learn.real_time import RealTime
from learn.training import Run

BATCH = 64
DEEPEST = 5e-3  # m; largest depth of the pokes in real time
THREADS = (1, 2)
_YARDSTICK = 512  # rows and columns of the matrix product


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


def loader_rates(
    store: Store, *, batch: int = 64, shuffle_buffer: int = 4, repeats: int = 3
) -> dict[str, float]:
    """Frames per second in random order, with a warm file cache: streamed, in memory, and from a memmap."""
    rows = np.arange(store.frames)
    stream = StreamDataset(store, rows, batch=batch, shuffle_buffer=shuffle_buffer, seed=1)

    def streamed(epoch: int) -> Iterable[Batch]:
        stream.epoch = epoch
        return stream

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "displacement.f4"
        shape = (store.frames, store.n_points, 3)
        array = np.memmap(path, dtype=np.float32, mode="w+", shape=shape)
        for first in range(0, store.frames, store.shard):
            some = store.displacement(slice(first, min(first + store.shard, store.frames)))
            array[first : first + len(some)] = some
        array.flush()
        mapped = np.memmap(path, dtype=np.float32, mode="r", shape=shape)
        rates = {
            "streamed, shuffled shards": _rate(store.frames, streamed, repeats),
            "NumPy memmap": _rate(store.frames, lambda e: _memmap_batches(store, mapped, batch, e), repeats),
        }
    memory = MemoryDataset(store, rows)
    rates["in memory"] = _rate(store.frames, lambda e: memory.batches(batch, seed=1, epoch=e), repeats)
    return rates


def latencies(run: Run, store: Store, repeats: int) -> list[tuple[str, str, float, float]]:
    """Latency of one poke: name, threads, median and best [ms]; the interior is already encoded.

    InputError if the run has an incomplete export.
    """
    before = torch.get_num_threads()
    try:
        return _latencies(run, store, repeats)
    finally:
        torch.set_num_threads(before)


@torch.inference_mode()
def _latencies(run: Run, store: Store, repeats: int) -> list[tuple[str, str, float, float]]:
    exported = run.folder / "onnx"
    has_export = isinstance(run.model, InvariantGnn) and bundle_in(exported)
    times: list[tuple[str, str, float, float]] = []
    setup = store.setup_index[store.geometry[store.frame_poke]]
    rows = np.flatnonzero(setup == setup[0])[:BATCH]
    model, name = run.model, run.recipe.model
    scenes = Scenes.of(store)
    scene = scenes.scenes[setup[0]]
    [(_, _, many)] = scenes.parts(pokes_of(without_fields(store, rows)))
    one = type(many)(**{name: value[:1] for name, value in vars(many).items()})
    encoded = model.encode(scene, model.prepare(scene))
    first = store.frame_poke[0]  # a poke before it may not have been simulated
    shape, level = store.shapes[store.shape[first]], store.softness_names[store.softness[first]]
    interior = {"shape": shape, "softness": level}
    soft = interior_of(store.setup_of(first), store.profile[store.geometry[first]]).soft
    deepest = min(DEEPEST, 0.9 * float(soft.min()))  # a tip in the inclusion would be refused
    for threads in THREADS:
        torch.set_num_threads(threads)
        if isinstance(model, InvariantGnn) and not model.takes_clock:
            single = SinglePoke(model, encoded, int(scene.rigid_index[one.geometry[0]]))
            poke = (
                one.start[0].numpy(),
                one.direction[0].numpy(),
                float(one.depth[0]),
                float(one.modulus[0]),
            )
            middle, best = timed(lambda single=single, poke=poke: single(*poke), repeats)  # type: ignore[misc]
            times.append((f"{name}, one at a time", str(threads), middle, best))
            touch, number = Predictor(run, store).real_time(interior), itertools.count()
            for what, apart in (("", 0.0), (", first of a contact", 1e-7)):
                middle, best = timed(
                    partial(_touched, touch, number, apart, deepest),
                    repeats,
                )
                times.append((f"{name}, in real time with intervals{what}", str(threads), middle, best))
        middle, best = timed(lambda: model.decode(encoded, one), repeats)
        times.append((f"{name}, as a batch of one", str(threads), middle, best))
        middle, best = timed(lambda: model.decode(encoded, many), max(3, repeats // 10))
        each = f"{name}, {len(rows)} at once, each"
        times.append((each, str(threads), middle / len(rows), best / len(rows)))
        if has_export:
            onnx = OnnxBundle(exported, threads=threads)
            code = onnx.encode(scene.rigid[scene.rigid_index[one.geometry[0]]])
            middle, best = timed(lambda onnx=onnx, code=code: onnx.poke(code, one, 0), repeats)  # type: ignore[misc]
            times.append((f"{name}, onnxruntime", str(threads), middle, best))
    if torch.cuda.is_available():
        middle, best = timed(on_device(model, scene, many, "cuda", torch.cuda.synchronize), repeats)
        each = f"{name}, GPU, {len(rows)} at once, each"
        times.append((each, "-", middle / len(rows), best / len(rows)))
        model.cpu()
    return times


def _touched(touch: RealTime, numbers: Iterator[int], apart: float, deepest: float) -> None:
    """Evaluate everything that a real-time program may need of a poke.

    The next deeper of one contact, whose depth goes from a fifth of `deepest` [m] to it again and again, or
    of the next contact, `apart` [m] from the last.
    """
    number = next(numbers)
    site, depth = (3e-3 + number * apart, -4e-3), deepest * (0.2 + 0.8 * (number % 4000) / 4000)
    answer = touch(site=site, direction=(0.0, 0.6, -0.8), depth=depth)
    assert np.isfinite(answer.distance)
    assert answer.radius is None or np.isfinite(answer.radius).all()


def on_device(
    model: Model, scene: Scene, pokes: Pokes, device: str, synchronize: Callable[[], None]
) -> Callable[[], Response]:
    """Function that predicts pokes on a device and waits for the result; the model is moved there."""
    prepared = model.prepare(scene)
    there = model.to(device)
    ready = there.encode(scene.to(device), prepared and tuple(s.to(device) for s in prepared))
    moved = type(pokes)(**{k: v.to(device) for k, v in vars(pokes).items()})

    def answer() -> Response:
        found = there.decode(ready, moved)
        synchronize()
        return found

    return answer


def yardstick(repeats: int) -> tuple[float, float]:
    """Median and best [ms] of NumPy's product of two 512 x 512 float32 matrices."""
    square = np.ones((_YARDSTICK, _YARDSTICK), dtype=np.float32)
    return timed(lambda: square @ square, repeats)


def timed(call: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Median and best time of a call [ms]."""
    for _ in range(3):
        call()
    seconds = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - begun)
    return statistics.median(seconds) * 1e3, min(seconds) * 1e3
