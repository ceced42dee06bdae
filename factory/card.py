"""`python -m factory.card DATASET --out FOLDER`: write page, tables, pictures and checksums of a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from factory.cli import Plugins, import_plugins, make_app, make_console, shown_errors
from tisim.options import Version

EXAMPLES = """
[bold]Examples[/bold]

  python -m factory.card datasets/quick-ogden.zarr --out quick-card

  python -m factory.card datasets/quick-ogden.zarr --out quick-card --licence CC-BY-4.0 --author "A. Person"

Writes card.md (with the front matter of Hugging Face), features.csv, softness.csv, features.png, poke.png,
manifest.json and SHA256SUMS.

Exit codes: 0 written, 1 written, but factory.verify finds faults (the card states them), 2 bad input or a
damaged store.
"""


def main(
    dataset: Annotated[Path, typer.Argument(help="Finished dataset, or its zip.")],
    out: Annotated[Path, typer.Option(help="Folder to write.")],
    licence: Annotated[str, typer.Option(help="Licence of the dataset, an SPDX identifier.")] = "Apache-2.0",
    author: Annotated[
        list[str] | None,
        typer.Option(help="Author to cite; repeatable. Default: the tisim authors.", show_default=False),
    ] = None,
    date: Annotated[
        str | None,
        typer.Option(
            metavar="YYYY-MM-DD",
            help="Date of the dataset. Default: that of its manifest.",
            show_default=False,
        ),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Write into a folder that is not empty.")
    ] = False,
    plugin: Plugins = None,
    version: Version = False,
) -> None:
    """Check a finished dataset and write its card: content, method, accuracy, cost, citation."""
    del version
    with shown_errors("cannot write the card:"):
        import_plugins(plugin)

        from factory.publishing.facts import AUTHOR, gather
        from factory.publishing.files import FILES, check_out, write_card

        check_out(dataset, out, overwrite=overwrite)
        facts = gather(dataset, licence=licence, authors=tuple(author or (AUTHOR,)), date=date)
        write_card(facts, out)
        console = make_console()
        console.print(f"{out}: {', '.join(FILES)}")
    if facts.found.total:
        faults = {name: len(found) for name, found in facts.found.faults.items() if found}
        text = ", ".join(f"{name}: {count}" for name, count in faults.items())
        console.print(f"the card states faults ({text}); python -m factory.verify {dataset} lists them")
        raise typer.Exit(1)


app = make_app(main, EXAMPLES)

if __name__ == "__main__":
    app()
