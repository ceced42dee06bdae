"""`python -m factory.verify DATASET`: is every byte and every frame as it should be."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from factory._checks import CHECKS
from factory._screen import fail, make_console
from factory.errors import InputError
from factory.reader import open_dataset

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Example[/bold]

  python -m factory.verify datasets/quick-ogden.zarr

Exit codes: 0 no fault, 1 faults found, 2 bad input.
"""


@app.command(epilog=EXAMPLES)
def main(
    dataset: Annotated[Path, typer.Argument(help="The finished store.")],
    show: Annotated[int, typer.Option(min=1, help="Faults to print for each check.")] = 5,
) -> None:
    """Checks checksums, shapes, finite values, statuses and physics of a finished dataset."""
    console = make_console()
    try:
        data = open_dataset(dataset)
    except InputError as error:
        fail(error)
    table = Table(title=str(dataset))
    table.add_column("check")
    table.add_column("faults", justify="right")
    listed: list[str] = []
    total = 0
    for name, check in CHECKS.items():
        try:
            faults = check(data)
        except Exception as error:  # a damaged file can break anywhere in the decoding
            text = " ".join(str(error).split())[:200]
            faults = [f"cannot be read ({type(error).__name__}: {text})"]
        total += len(faults)
        table.add_row(name, str(len(faults)) if faults else "-")
        listed += [f"{name}: {fault}" for fault in faults[:show]]
        if len(faults) > show:
            listed.append(f"{name}: and {len(faults) - show} more")
    console.print(table)
    for line in listed:
        console.print(line, markup=False, highlight=False)
    if total:
        raise typer.Exit(1)
    console.print(f"{data.n_pokes} pokes, {len(data.table['frame_poke'])} frames: no fault")


if __name__ == "__main__":
    app()
