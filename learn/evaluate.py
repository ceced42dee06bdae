"""`python -m learn.evaluate RUN...`: tables and a report of trained models."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import torch
import typer
from rich.table import Table

from learn._screen import make_console, plain_errors
from learn.data import open_store
from learn.errors import InputError
from learn.evaluation import evaluate, save_intervals, write_report
from learn.evaluation.report import full_table, interval_table, paper_table, symmetry_table
from learn.training import load_run

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.evaluate runs/fast-ours-ogden-0-0

Several folds, or our model beside the paper's; the first run's folder gets the report:

  python -m learn.evaluate runs/fast-ours-ogden-*-0 runs/paper-cegnn-ogden-0-0

Runs of one fold that differ in seed, alone and together:

  python -m learn.evaluate runs/fast-ours-ogden-0-0 runs/fast-ours-ogden-0-1 --ensemble

On pokes of another law or recipe than it was trained on:

  python -m learn.evaluate runs/fast-ours-ogden-0-0 --dataset datasets/paper-mooney-rivlin.zarr --transfer

Exit codes: 0 done, 2 bad input.
"""


@app.command(epilog=EXAMPLES)
def main(
    runs: Annotated[list[Path], typer.Argument(help="Folders of runs, trained on one dataset.")],
    dataset: Annotated[str | None, typer.Option(help="The store, if it moved since the training.")] = None,
    transfer: Annotated[
        bool,
        typer.Option(
            "--transfer", help="Allow another dataset than the run was trained on: all its unseen shapes."
        ),
    ] = False,
    baselines: Annotated[bool, typer.Option(help="Fit and show the baselines as well.")] = True,
    clouds: Annotated[bool, typer.Option(help="Show errors on other point clouds as well.")] = True,
    ensemble: Annotated[
        bool,
        typer.Option("--ensemble", help="Join runs that differ in seed alone, and evaluate them as one too."),
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Default: evaluation/ in the first run.")] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="CPU threads. Default: one a core.")] = None,
) -> None:
    """Tables of the test part, baselines beside, and report.html with pictures."""
    torch.set_num_threads(threads or os.cpu_count() or 1)
    console = make_console()
    with plain_errors():
        loaded = [load_run(folder) for folder in runs]
        store = open_store(dataset or loaded[0].location)
        for run in loaded:
            if run.uuid != store.uuid and not transfer:
                raise InputError(
                    f"{run.folder}: trained on dataset {run.uuid}, but {store.location} is {store.uuid} "
                    "(--transfer allows it)"
                )
        found = evaluate(
            loaded, store, baselines=baselines, clouds=clouds, ensemble=ensemble, say=console.print
        )
        folder = out or runs[0] / "evaluation"
        write_report(found, folder)
        if not transfer:
            for run, covered in found.intervals:
                save_intervals(run, covered)
    everything = {name: levels["all"] for name, levels in found.tables.items()}
    for title, (heads, rows) in {
        "The paper's table": paper_table(found),
        "Test part, all softness": full_table(everything, "model"),
        "Symmetry": symmetry_table(found),
        "Intervals": interval_table(found),
        **({"Other clouds": full_table(found.clouds, "points")} if found.clouds else {}),
        **({"Deeper than trained": full_table(found.deeper, "frames")} if found.deeper else {}),
    }.items():
        table = Table(title=title)
        for k, head in enumerate(heads):
            table.add_column(head, justify="left" if k == 0 else "right", no_wrap=k == 0)
        for row in rows:
            table.add_row(*row)
        console.print(table)
    console.print(f"{folder}: report.html, tables.json, pictures")


if __name__ == "__main__":
    app()
