"""`python -m calibration`: the commands of this package."""

from __future__ import annotations

import sys

from rich.console import Console
from rich.table import Table

from calibration.cli import VERBS, command
from tisim.options import Version

app = command()


@app.command()
def main(
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """List the commands of calibration; each has a --help of its own."""
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, purpose in VERBS.items():
        table.add_row(f"python -m calibration.{name}", purpose)
    Console(soft_wrap=not sys.stdout.isatty()).print(table)


if __name__ == "__main__":
    app()
