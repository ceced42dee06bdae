"""`python -m learn.bench RUN...`: how fast runs answer, and how fast their dataset is read."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import numpy as np
import torch
import typer
from rich.table import Table

from learn._screen import make_console, plain_errors
from learn._throughput import loader_rates
from learn.data import MemoryDataset, Store, open_store
from learn.errors import InputError
from learn.export import OnnxSurrogate
from learn.models import Scene, Surrogate, pokes_of, scene_of
from learn.models.single import SinglePoke
from learn.training import Run, load_run

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.bench runs/fast-ours-ogden-0-0

The model and the small one beside it:

  python -m learn.bench runs/fast-ours-ogden-0-0 runs/fast-ours-small-ogden-0-0

Exported with learn.export before, the ONNX files are timed as well.
"""
_BATCH = 64
_YARDSTICK = 512  # rows and columns of the product that the table is read against


@app.command(epilog=EXAMPLES)
def main(
    runs: Annotated[list[Path], typer.Argument(help="Folders of runs, trained on one dataset.")],
    dataset: Annotated[str | None, typer.Option(help="The store, if it moved since the training.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Timed calls each.")] = 200,
    loader: Annotated[bool, typer.Option(help="Time the loaders as well.")] = True,
) -> None:
    """Latency of one poke on the dataset's grid, and loader throughput; medians, with the best beside."""
    console = make_console()
    with plain_errors():
        loaded = [load_run(run) for run in runs]
        store = open_store(dataset or loaded[0].location, verify=False)
        for run in loaded:
            if run.uuid != store.uuid:
                raise InputError(
                    f"{run.folder}: trained on dataset {run.uuid}, but {store.location} is {store.uuid}"
                )
        times = Table(title=f"One poke of {len(store.points)} points, the interior encoded before")
        for head in ("", "threads", "median ms", "best ms"):
            times.add_column(head, justify="left" if not head else "right")
        scene = scene_of(store)
        for run in loaded:
            _time_run(times, run, scene, store, repeats)
        console.print(times)
        square = np.ones((_YARDSTICK, _YARDSTICK), dtype=np.float32)
        middle, best = _times(lambda: square @ square, repeats)
        load = f", load average {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
        console.print(
            f"beside it, NumPy's product of two {_YARDSTICK} x {_YARDSTICK} float32 matrices: "
            f"median {middle:.2f} ms, best {best:.2f} ms; {os.cpu_count()} cores{load}"
        )
        if loader:
            table = Table(title=f"Loaders: {store.frames} frames, batches of {_BATCH}, random order")
            for head in ("", "frames a second", "of a memmap"):
                table.add_column(head, justify="left" if not head else "right")
            rates = loader_rates(store)
            for name, rate in rates.items():
                table.add_row(name, f"{rate:.0f}", f"{rate / rates['NumPy memmap']:.2f}")
            console.print(table)


@torch.inference_mode()
def _time_run(times: Table, run: Run, scene: Scene, store: Store, repeats: int) -> None:
    rows = np.arange(min(_BATCH, store.frames))
    data, model, name = MemoryDataset(store, rows), run.model, run.recipe.model
    one, many = pokes_of(data[0]), pokes_of(data.__getitems__(rows))
    encoded = model.encode(scene, model.prepare(scene))
    for threads in (1, 2):
        torch.set_num_threads(threads)
        if isinstance(model, Surrogate):
            single = SinglePoke(model, encoded, int(scene.rigid_index[one.geometry[0]]))
            poke = (
                one.start[0].numpy(),
                one.direction[0].numpy(),
                float(one.depth[0]),
                float(one.modulus[0]),
            )
            middle, best = _times(lambda single=single, poke=poke: single(*poke), repeats)  # type: ignore[misc]
            times.add_row(f"{name}, one at a time", str(threads), f"{middle:.2f}", f"{best:.2f}")
        middle, best = _times(lambda: model.decode(encoded, one), repeats)
        times.add_row(f"{name}, as a batch of one", str(threads), f"{middle:.2f}", f"{best:.2f}")
        middle, best = _times(lambda: model.decode(encoded, many), max(3, repeats // 10))
        each = f"{name}, {len(rows)} at once, each"
        times.add_row(each, str(threads), f"{middle / len(rows):.2f}", f"{best / len(rows):.2f}")
        if (run.folder / "onnx" / "encoder.onnx").is_file():
            onnx = OnnxSurrogate(run.folder / "onnx", threads=threads)
            code = onnx.encode(scene.rigid[scene.rigid_index[one.geometry[0]]])
            middle, best = _times(lambda onnx=onnx, code=code: onnx.poke(code, one, 0), repeats)  # type: ignore[misc]
            times.add_row(f"{name}, onnxruntime", str(threads), f"{middle:.2f}", f"{best:.2f}")
    if torch.cuda.is_available():
        there, on_gpu = model.cuda(), scene.to("cuda")
        prepared = there.prepare(scene)
        ready = there.encode(on_gpu, prepared and tuple(s.to("cuda") for s in prepared))
        moved = type(many)(**{k: v.cuda() for k, v in vars(many).items()})

        def answer() -> None:
            there.decode(ready, moved)
            torch.cuda.synchronize()

        middle, best = _times(answer, repeats)
        each = f"{name}, GPU, {len(rows)} at once, each"
        times.add_row(each, "-", f"{middle / len(rows):.3f}", f"{best / len(rows):.3f}")
        model.cpu()


def _times(call: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Median and best [ms]."""
    for _ in range(3):
        call()
    seconds = []
    for _ in range(repeats):
        begun = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - begun)
    return statistics.median(seconds) * 1e3, min(seconds) * 1e3


if __name__ == "__main__":
    app()
