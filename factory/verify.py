"""`python -m factory.verify DATASET`: check every byte and every frame of a finished dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factory._cli import Plugins, Version, import_plugins, make_app, make_console, shown_errors

EXAMPLES = """
[bold]Example[/bold]

  python -m factory.verify datasets/quick-ogden.zarr

Exit codes: 0 no fault, 1 faults found, 2 bad input.
"""


def main(
    dataset: Annotated[Path, typer.Argument(help="The finished store.")],
    show: Annotated[int, typer.Option(min=1, help="Faults to print for each check.")] = 5,
    plugin: Plugins = None,
    version: Version = False,
) -> None:
    """Check files, checksums, shapes, finite values, statuses and physics of a finished dataset."""
    del version
    with shown_errors(f"{dataset}: cannot read"):
        import_plugins(plugin)

        from rich.table import Table

        from factory._checks import verify_dataset

        found = verify_dataset(dataset)
        console = make_console()
        table = Table(title=str(dataset))
        table.add_column("check")
        table.add_column("faults", justify="right")
        for name, faults in found.faults.items():
            table.add_row(name, str(len(faults)) if faults else "-")
        console.print(table)
        for name, faults in found.faults.items():
            for fault in faults[:show]:
                console.print(f"{name}: {fault}")
            if len(faults) > show:
                console.print(f"{name}: and {len(faults) - show} more")
    if found.total:
        raise typer.Exit(1)
    plural = "" if found.pokes == 1 else "s"
    console.print(f"{found.pokes} poke{plural}, {found.frames} frames: no fault")


app = make_app(main, EXAMPLES)

if __name__ == "__main__":
    app()
