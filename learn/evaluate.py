"""`python -m learn.evaluate`: a surrogate's errors and intervals on test pokes, with a report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from learn._options import (
    Dataset,
    Device,
    Plugins,
    Runs,
    Threads,
    Version,
    check_folder,
    load_plugins,
    set_threads,
    single,
)
from learn._terminal import log_to, make_console, plain_errors, print_table
from learn.errors import InputError

EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.evaluate runs/quick

Several folds, or the surrogate beside the paper's model; the first run's folder gets the report:

  python -m learn.evaluate runs/fast-invariant-gnn-ogden-*-0 runs/paper-cegnn-ogden-0-0

Runs of one fold that differ in seed, alone and together:

  python -m learn.evaluate runs/fast-invariant-gnn-ogden-0-0 runs/fast-invariant-gnn-ogden-0-1 --ensemble

On pokes of another law or recipe than it was trained on:

  python -m learn.evaluate runs/quick --dataset datasets/paper-mooney-rivlin.zarr --transfer

Exit codes: 0 done, 2 bad input.
"""


def main(
    runs: Runs,
    dataset: Dataset = None,
    transfer: Annotated[
        bool,
        typer.Option(
            "--transfer",
            help="Evaluate on a dataset that the run was not trained on, on what is new to the run: shapes, "
            "or contact points if it was split by site.",
        ),
    ] = False,
    baselines: Annotated[bool, typer.Option(help="Evaluate the baselines too.")] = True,
    clouds: Annotated[bool, typer.Option(help="Evaluate at scattered points too.")] = True,
    ensemble: Annotated[
        bool,
        typer.Option(
            "--ensemble", help="Average runs that differ only in their seed, and evaluate the average too."
        ),
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="Default: evaluation/ in the first run, or covers-evaluation/.")
    ] = None,
    device: Device = "auto",
    threads: Threads = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Evaluate runs on the test part: tables beside baselines, and report.html."""
    console = make_console()
    with plain_errors():
        from learn.evaluation import evaluate as evaluate_runs
        from learn.evaluation import replaced_text, save_intervals
        from learn.evaluation.report import cautions, tables, verdict, write_report
        from learn.pretrained import is_shipped, results_of
        from learn.training import check_dataset, load_run, make_device, open_dataset

        load_plugins(plugin or [])
        set_threads(threads)
        log_to(console)
        chosen = make_device(device)
        folder = out or results_of(runs[0], "evaluation")
        check_folder(folder)
        loaded = [load_run(path) for path in runs]
        store = open_dataset(loaded[0], dataset)
        if transfer and all(run.uuid == store.uuid for run in loaded):
            raise InputError(
                f"--transfer: {store.location} is what was trained on, expected another --dataset"
            )
        for run in loaded if not transfer else ():
            check_dataset(run.uuid, run.folder, store, hint=" (--transfer allows it)")
        found = evaluate_runs(
            loaded, store, baselines=baselines, clouds=clouds, ensemble=ensemble, device=chosen
        )
        write_report(found, folder)
        for title, ((heads, rows), notes) in tables(found).items():
            if rows:
                print_table(console, title, heads, rows)
            else:
                console.print(f"{title}: {' '.join(notes[:-1])}")
        for sentence in (verdict(found), *cautions(found)):
            console.print(sentence)
        console.print(f"{folder}: report.html, tables.json, pictures")
        if transfer:
            return
        # last, so that a run's folder that cannot be written costs no more than the intervals
        for run, intervals in found.intervals:
            if is_shipped(run.folder):
                console.print(f"{run.folder.name}: the intervals that come with it are kept")
                continue
            text = replaced_text(run, intervals)
            if text is not None:
                console.print(text)
            save_intervals(run, intervals)


app = single(main, EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.evaluate")
