"""`python -m learn`: all commands of this package, each from its module."""

from __future__ import annotations

import typer

from learn import adapt, bench, evaluate, export, predict, train
from learn._options import Version
from learn.page import command as page

app = typer.Typer(
    name="learn",
    help="Surrogates of the poke response: train, evaluate, adapt, predict, export, page, bench.",
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)
app.command("train", epilog=train.EXAMPLES)(train.main)
app.command("evaluate", epilog=evaluate.EXAMPLES)(evaluate.main)
app.command("adapt", epilog=adapt.EXAMPLES)(adapt.main)
app.command("predict", epilog=predict.EXAMPLES)(predict.main)
app.command("export", epilog=export.EXAMPLES)(export.main)
app.command("bench", epilog=bench.EXAMPLES)(bench.main)
app.command("page", epilog=page.EXAMPLES)(page.main)


@app.callback()
def _main(_version: Version = False) -> None:
    pass
