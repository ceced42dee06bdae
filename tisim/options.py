"""Options that the commands share, those of factory and calibration too."""

from __future__ import annotations

from typing import Annotated

import typer


def _show_version(wanted: bool) -> None:
    if wanted:
        import tisim

        typer.echo(f"tisim {tisim.__version__}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option("--version", help="Show the version and exit.", callback=_show_version, is_eager=True),
]
