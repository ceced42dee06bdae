"""`python -m calibration.reconstruct`: from photographs to outlines, mid lines and bodies."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar
from rich.table import Table

from calibration.cli import command, plain_ends
from calibration.errors import InputError
from tisim.options import Version

if TYPE_CHECKING:
    from calibration.progress import Progress
    from calibration.results import Reconstruction

app = command()

EXAMPLES = """
[bold]Examples[/bold]

  python -m calibration.reconstruct datasets/measured/photographs --out traced

  python -m calibration.fit traced

How to photograph: docs/how-to/photograph.md. Stopped or killed, the same command goes on where it was.

Exit codes: 0 done, 2 bad input or photographs that cannot be used, 130 stopped by Ctrl-C.
"""


@app.command(epilog=EXAMPLES)
@plain_ends("Stopped: what is traced is kept; the same command goes on.")
def main(
    experiment: Annotated[Path, typer.Argument(help="Folder with experiment.yaml (format 1).")],
    out: Annotated[
        Path | None, typer.Option(help="Folder to write. Default: EXPERIMENT's name with -traced, here.")
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume/--overwrite",
            help="Keep what is already traced, or trace all again, also over another experiment.",
        ),
    ] = True,
    skip_bad: Annotated[
        bool,
        typer.Option("--skip-bad", help="Leave out photographs that cannot be used, instead of stopping."),
    ] = False,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Trace every photograph of an experiment: outline, mid line, swept body and a strip of pictures each,
    and an experiment.yaml that names the outlines."""
    from calibration.api import reconstruct

    console = Console(soft_wrap=True, width=None if sys.stdout.isatty() else 140)
    try:
        with _Screen(console) as screen:
            found = reconstruct(
                experiment, out=out, resume=resume, skip_bad=skip_bad, on_progress=screen.update
            )
    except InputError as error:
        for sentence in getattr(error, "problems", {}).values():
            typer.echo(f"error: {sentence}", err=True)
        raise
    for sentence in found.problems.values():
        typer.echo(f"error: {sentence}", err=True)
    console.print(_table(found))
    left = f", {len(found.problems)} left out" if found.problems else ""
    console.print(
        f"{found.folder}: {len(found.figures)} captures{left}, pictures in {found.folder / 'pictures'}; next:"
        f" python -m calibration.fit {shlex.quote(str(found.folder))}",
        markup=False,
    )


class _Screen:
    """A bar on a terminal, a line a capture elsewhere."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self.bar = Bar(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        self.task = self.bar.add_task("photographs", total=None)

    def __enter__(self) -> _Screen:
        self.bar.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self.bar.stop()

    def update(self, progress: Progress) -> None:
        """An `on_progress` callback."""
        self.bar.update(self.task, completed=progress.done, total=progress.total or None)
        if not self.console.is_terminal:
            self.console.print(progress.message, markup=False)


def _table(found: Reconstruction) -> Table:
    table = Table(title="Captures")
    for column in found.HEAD:
        table.add_column(column, justify="left" if column == "capture" else "right")
    for cells in found.rows():
        table.add_row(*(escape(c) for c in cells))
    return table


if __name__ == "__main__":
    app()
