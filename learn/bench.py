"""`python -m learn.bench RUN`: how fast a run answers, and how fast its dataset is read."""

from __future__ import annotations

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
from learn.data import MemoryDataset, open_store
from learn.export import OnnxSurrogate
from learn.models import pokes_of, scene_of
from learn.training import load_run

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Example[/bold]

  python -m learn.bench runs/fast-ours-ogden-0-0

Exported with learn.export before, the ONNX files are timed as well.
"""
_BATCH = 64


@app.command(epilog=EXAMPLES)
def main(
    run: Annotated[Path, typer.Argument(help="Folder of a run.")],
    dataset: Annotated[str | None, typer.Option(help="The store, if it moved since the training.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Timed calls each.")] = 50,
    loader: Annotated[bool, typer.Option(help="Time the loaders as well.")] = True,
) -> None:
    """Latency of one poke on the dataset's grid, and loader throughput; medians, with the best beside."""
    console = make_console()
    with plain_errors():
        loaded = load_run(run)
        store = open_store(dataset or loaded.location, verify=False)
        rows = np.arange(min(_BATCH, store.frames))
        data = MemoryDataset(store, rows)
        scene = scene_of(store)
        one, many = pokes_of(data[0]), pokes_of(data.__getitems__(rows))
        times = Table(title=f"One poke of {len(store.points)} points, the interior encoded before")
        for head in ("", "threads", "median ms", "best ms"):
            times.add_column(head, justify="left" if not head else "right")
        with torch.no_grad():
            encoded = loaded.model.encode(scene, loaded.model.prepare(scene))
            for threads in (1, 2):
                torch.set_num_threads(threads)
                middle, best = _times(lambda: loaded.model.decode(encoded, one), repeats)
                times.add_row("torch", str(threads), f"{middle:.2f}", f"{best:.2f}")
                middle, best = _times(lambda: loaded.model.decode(encoded, many), max(3, repeats // 10))
                times.add_row(
                    f"torch, {len(rows)} at once, each",
                    str(threads),
                    f"{middle / len(rows):.2f}",
                    f"{best / len(rows):.2f}",
                )
            if torch.cuda.is_available():
                there, on_gpu = loaded.model.cuda(), scene.to("cuda")
                ready = there.encode(on_gpu, tuple(s.to("cuda") for s in there.prepare(scene)))
                moved = type(many)(**{k: v.cuda() for k, v in vars(many).items()})

                def answer() -> None:
                    there.decode(ready, moved)
                    torch.cuda.synchronize()

                middle, best = _times(answer, repeats)
                times.add_row(
                    f"GPU, {len(rows)} at once, each",
                    "-",
                    f"{middle / len(rows):.3f}",
                    f"{best / len(rows):.3f}",
                )
        if (run / "onnx" / "poke.onnx").is_file():
            for threads in (1, 2):
                onnx = OnnxSurrogate(run / "onnx", threads=threads)
                code = onnx.encode(scene.rigid[scene.rigid_index[one.geometry[0]]])
                middle, best = _times(lambda onnx=onnx, code=code: onnx.poke(code, one, 0), repeats)  # type: ignore[misc]
                times.add_row("onnxruntime", str(threads), f"{middle:.2f}", f"{best:.2f}")
        console.print(times)
        if loader:
            table = Table(title=f"Loaders: {store.frames} frames, batches of {_BATCH}, random order")
            for head in ("", "frames a second", "of a memmap"):
                table.add_column(head, justify="left" if not head else "right")
            rates = loader_rates(store)
            for name, rate in rates.items():
                table.add_row(name, f"{rate:.0f}", f"{rate / rates['NumPy memmap']:.2f}")
            console.print(table)


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
