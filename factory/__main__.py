"""`python -m factory`: the commands of the factory."""

from __future__ import annotations

import typer

from factory import build, card, inspect, release, verify
from tisim.options import Version

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)
for _module in (build, inspect, verify, card, release):
    app.command(_module.__name__.rpartition(".")[2], epilog=_module.EXAMPLES)(_module.main)


@app.callback(invoke_without_command=True)
def main(context: typer.Context, version: Version = False) -> None:
    """Datasets of pokes: build, inspect, verify, describe, publish (also `python -m factory.build`)."""
    del version
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


if __name__ == "__main__":
    app(prog_name="python -m factory")
