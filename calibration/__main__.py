"""`python -m calibration`: the commands of this package."""

from __future__ import annotations

import sys

import typer
from rich.console import Console
from rich.table import Table

from calibration.cli import VERBS, command, installed_version

app = command()


@app.command()
def main(
    version: bool = typer.Option(False, "--version", help="Show the version and exit."),
) -> None:
    """List the commands of calibration; each has a --help of its own."""
    if version:
        typer.echo(f"tisim {installed_version()}")
        return
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, purpose in VERBS.items():
        table.add_row(f"python -m calibration.{name}", purpose)
    Console(soft_wrap=not sys.stdout.isatty()).print(table)


if __name__ == "__main__":
    app()
