"""`python -m factory.release DATASET --out FILE.zarr.zip`: write a dataset as one file for publication."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factory.cli import Plugins, import_plugins, make_app, make_console, shown_errors, size_text
from factory.errors import InputError
from tisim.options import Version

EXAMPLES = """
[bold]Example[/bold]

  python -m factory.release datasets/quick-ogden.zarr --out quick-ogden.zarr.zip

  sha256sum -c quick-ogden.zarr.zip.sha256

The same store gives the same bytes. Stopped or killed, the same command begins anew.

Exit codes: 0 written and compared with the manifest, 2 bad input or a damaged store, 130 stopped by Ctrl-C.
"""


def main(
    dataset: Annotated[Path, typer.Argument(help="Finished dataset.")],
    out: Annotated[Path, typer.Option(help="The zip to write: FILE.zarr.zip.")],
    plugin: Plugins = None,
    version: Version = False,
) -> None:
    """Write a finished dataset as one Zarr zip (not compressed again) with its sha256 beside it."""
    del version
    try:
        with shown_errors(f"{dataset}: cannot release"):
            import_plugins(plugin)

            from factory.reader import open_dataset
            from factory.store.archive import release_store
            from tisim.parallel.termination import terminable

            if dataset.is_file():
                raise InputError(f"{dataset}: expected the folder of a store, got a file")
            data = open_dataset(dataset)
            with terminable():
                released = release_store(dataset, out)
            console = make_console()
            waiting = len(data.waiting)
            missing = data.n_pokes - int(data.attributes["pokes_done"]) - waiting
            if missing:
                console.print(
                    f"{dataset}: {missing} of {data.n_pokes} pokes failed; the zip has their errors"
                )
            if waiting:
                console.print(f"{dataset}: {waiting} of {data.n_pokes} pokes are not simulated yet")
            console.print(
                f"{released.path}: {released.files} files, {size_text(released.size)}, as the manifest says"
            )
            console.print(f"{released.sums}: {released.sha256}")
    except KeyboardInterrupt:
        typer.echo("Stopped. Nothing is left of the zip; the same command begins anew.", err=True)
        raise typer.Exit(130) from None


app = make_app(main, EXAMPLES)

if __name__ == "__main__":
    app()
