"""`python -m learn.bench`: latency of a surrogate, throughput of the loaders."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from learn._options import Dataset, Plugins, Runs, Version, load_plugins, single
from learn._terminal import make_console, plain_errors, print_table

EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.bench runs/quick

The network that comes with tisim:

  python -m learn.bench covers

The surrogate and the small one beside it:

  python -m learn.bench runs/fast-invariant-gnn-ogden-0-0 runs/fast-invariant-gnn-small-ogden-0-0

Exported with learn.export before, the ONNX files are timed as well.
"""


def main(
    runs: Runs,
    dataset: Dataset = None,
    repeats: Annotated[int, typer.Option(min=3, help="Number of timed calls.")] = 200,
    loader: Annotated[bool, typer.Option(help="Measure the loaders too.")] = True,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Measure the latency of one prediction and the throughput of the loaders (median and best)."""
    console = make_console()
    with plain_errors():
        from learn.benchmark import BATCH, latencies, loader_rates, yardstick
        from learn.training import check_dataset, load_run, open_tables

        load_plugins(plugin or [])
        loaded = [load_run(run) for run in runs]
        store = open_tables(loaded[0], dataset)
        for run in loaded:
            check_dataset(run.uuid, run.folder, store)
        rows = [row for run in loaded for row in latencies(run, store, repeats)]
        print_table(
            console,
            f"One poke of {store.n_points} points, the interior encoded before",
            ["", "threads", "median ms", "best ms"],
            [[name, threads, f"{median:.2f}", f"{best:.2f}"] for name, threads, median, best in rows],
        )
        median, best = yardstick(repeats)
        load = f", load average {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
        console.print(
            f"beside it, NumPy's product of two 512 x 512 float32 matrices: "
            f"median {median:.2f} ms, best {best:.2f} ms; {os.cpu_count()} cores{load}"
        )
        if loader and not store.has_fields:
            console.print(f"{store.location} is not here: its loaders are not measured")
        elif loader:
            rates = loader_rates(store)
            memmap = rates["NumPy memmap"]
            print_table(
                console,
                f"Loaders: {store.frames} frames, batches of {BATCH}, random order",
                ["", "frames a second", "relative to a memmap"],
                [[name, f"{rate:.0f}", f"{rate / memmap:.2f}"] for name, rate in rates.items()],
            )


app = single(main, EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.bench")
