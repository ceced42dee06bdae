"""`python -m factory.verify DATASET`: check every byte and every frame of a finished dataset."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from factory.cli import Plugins, counted, import_plugins, make_app, make_console, shown_errors
from factory.errors import InputError
from tisim.options import Version

if TYPE_CHECKING:
    from rich.console import Console

EXAMPLES = """
[bold]Examples[/bold]

  python -m factory.verify datasets/quick-ogden.zarr

Every frame's equilibrium by an assembly of its own, from the stored surface (as long as the build took),
or those of some pokes:

  python -m factory.verify datasets/quick-ogden.zarr --assembly

  python -m factory.verify datasets/paper-ogden.zarr --assembly --pokes 20

Exit codes: 0 no fault, 1 faults found, 2 bad input.
"""


def main(
    dataset: Annotated[Path, typer.Argument(help="Finished dataset.")],
    show: Annotated[int, typer.Option(min=1, help="Number of faults to print per check.")] = 5,
    assembly: Annotated[
        bool,
        typer.Option(
            "--assembly",
            help="Check the equilibrium of every frame too, by an independent assembly of nodal forces.",
        ),
    ] = False,
    pokes: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="With --assembly: number of pokes to check, spread over the dataset.",
            show_default="all",
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="With --assembly: number of worker processes. Default: one per core.",
            show_default=False,
        ),
    ] = None,
    plugin: Plugins = None,
    version: Version = False,
) -> None:
    """Check files, checksums, shapes, finite values, statuses and physics of a finished dataset."""
    del version
    with shown_errors(f"{dataset}: cannot read"):
        import_plugins(plugin)

        from rich.table import Table

        from factory.checks.verification import verify_dataset

        if not assembly and (pokes is not None or workers is not None):
            raise InputError("--pokes and --workers: expected with --assembly")
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
        sound = not found.total
        if sound:
            more = f"; {counted(found.waiting, 'poke')} not simulated yet" if found.waiting else ""
            more += "; next: equilibrium by assembly" if assembly else ""
            console.print(f"{counted(found.pokes, 'poke')}, {counted(found.frames, 'frame')}: no fault{more}")
        if sound and assembly:
            sound = _assembled(dataset, pokes, workers, plugin or [], show, console)
    if not sound:
        raise typer.Exit(1)


def _assembled(
    dataset: Path, pokes: int | None, workers: int | None, plugins: list[str], show: int, console: Console
) -> bool:
    """Check by assembly with progress on stderr and print the result; True if checked without fault.

    A frame without an interior equilibrium counts as one.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    from factory.checks.equilibrium import check_assembly
    from factory.reader import open_dataset
    from tisim.parallel.pool import cores

    bar = Progress(
        TextColumn("assembly"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
    )
    with bar:
        task = bar.add_task("assembly", total=None)
        found = check_assembly(
            open_dataset(dataset),
            pokes=pokes,
            workers=workers or cores(),
            plugins=plugins,
            on_progress=lambda done, total: bar.update(task, completed=done, total=total),
        )
    for fault in found.faults[:show]:
        console.print(f"equilibrium by assembly: {fault}")
    if len(found.faults) > show:
        console.print(f"equilibrium by assembly: and {len(found.faults) - show} more")
    for index, reason in itertools.islice(found.not_checked.items(), show):
        console.print(f"equilibrium by assembly: poke {index} is not checked: {reason}")
    if len(found.not_checked) > show:
        console.print(f"equilibrium by assembly: {len(found.not_checked) - show} more pokes are not checked")
    for index, frame in itertools.islice(found.no_interior.items(), show):
        console.print(
            f"equilibrium by assembly: poke {index}: no equilibrium was found inside the surface of frame"
            f" {frame}; it and later frames are not checked"
        )
    if len(found.no_interior) > show:
        console.print(
            f"equilibrium by assembly: of {len(found.no_interior) - show} more pokes frames are not checked"
        )
    worst = found.largest
    if worst is not None:
        console.print(
            f"equilibrium by assembly of {counted(found.pokes, 'poke')}, {counted(found.frames, 'frame')}: "
            f"{counted(len(found.faults), 'fault')}; largest parts of the rod's force: "
            f"inside {worst.inside:.1g}, free surface {worst.free:.1g}, sum at the rod {worst.rod:.1g}, "
            f"at the base {worst.base:.1g}"
        )
    return not found.faults and not found.no_interior and worst is not None


app = make_app(main, EXAMPLES)

if __name__ == "__main__":
    app()
