"""`python -m learn.adapt`: adapt a trained surrogate to a body of one's own, from a few simulated pokes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from learn._options import Device, Plugins, Threads, Version, load_plugins, set_threads, single
from learn._terminal import fail, make_console, plain_errors, print_table, progress_bar, terminable

EXAMPLES = """
[bold]Examples[/bold]

Simulate some pokes of a body (the recipe states its inclusion, indenter and block), and adapt a run to it:

  python -m factory.build --model ogden --recipe my-body.yaml --out my-body.zarr

  python -m learn.adapt covers my-body.zarr --out runs/my-body

covers comes with tisim; the folder of any run of one's own can stand in its place.

The result is a run like others:

  python -m learn.predict runs/my-body poke.yaml

Exit codes: 0 done, 1 diverged, 2 bad input, 130 stopped by Ctrl-C (nothing is written).
"""


def main(
    run: Annotated[
        Path,
        typer.Argument(
            help="Folder of the run to begin from, or covers, a network that comes with tisim.", metavar="RUN"
        ),
    ],
    dataset: Annotated[str, typer.Argument(help="Dataset of the body: a folder, a zip or an fsspec URL.")],
    out: Annotated[Path, typer.Option(help="Folder of the adapted run.")] = Path("runs/adapted"),
    epochs: Annotated[
        int | None, typer.Option(help="Largest number of passes over the pokes. Default: 16.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed. Default: that of the run.")] = None,
    device: Device = "auto",
    threads: Threads = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Adapt a run to a body of one's own: fine-tune it on a few pokes, and calibrate its intervals there."""
    console = make_console()
    with plain_errors():
        from learn.adaptation import adapt, adapt_recipe
        from learn.data import open_store
        from learn.evaluation.report import full_table
        from learn.training import DivergedError, load_run, make_device
        from learn.training.run_folder import check_free

        load_plugins(plugin or [])
        set_threads(threads)
        check_free(out)
        begun = load_run(run)
        changes = {k: v for k, v in (("epochs", epochs), ("seed", seed)) if v is not None}
        recipe = adapt_recipe(begun, changes, "the command line")
        store = open_store(dataset)
        try:
            with terminable(), progress_bar(console) as update:
                found = adapt(begun, store, recipe=recipe, device=make_device(device), on_progress=update)
        except DivergedError as error:
            fail(f"diverged: {error}; nothing was written", 1)
        except KeyboardInterrupt:
            fail("Stopped; nothing was written.", 130)
        found.save(out)
        print_table(console, "Errors", *full_table(found.rows_of_table, "network"))
        console.print(f"{found.points} contact points, {len(found.rows)} frames; {found.verdict}")
        console.print(found.interval_text)
        console.print(
            f"{out}: best.pt, intervals.json, adaptation.json, adaptation.png;"
            f" next: python -m learn.predict {out} POKE.yaml"
        )


app = single(main, EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.adapt")
