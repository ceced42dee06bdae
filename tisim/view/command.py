"""`python -m tisim.view`: results and pokes of datasets in three dimensions: a page, a GIF or an MP4."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NoReturn

import typer

from tisim.options import Version

EXAMPLES = """
[bold]Examples[/bold]

  python -m tisim.view beam.vtu

  python -m tisim.view poke.pvd --out poke.html --open

  python -m tisim.view datasets/quick-ogden.zarr --poke 3 --gif poke-3.gif

  python -m tisim.view poke.pvd --gif poke.gif --colour "von Mises stress"

Exit codes: 0 written, 2 bad input.
"""

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)


@app.command(epilog=EXAMPLES)
def main(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...",
            help="Result of tisim.write (a .vtu, one .vtu per frame, or a .pvd), or a dataset.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(help="The page to write. Default: FILE's name with .html, here.")
    ] = None,
    poke: Annotated[
        int | None, typer.Option(help="Index of the poke in a dataset. Default: the first simulated one.")
    ] = None,
    gif: Annotated[Path | None, typer.Option(help="Write an animated GIF.")] = None,
    mp4: Annotated[
        Path | None, typer.Option(help="Write an MP4 video; needs ffmpeg, or tisim\\[video].")
    ] = None,
    colour: Annotated[
        str | None,
        typer.Option(help="Quantity that colours GIF and MP4, as named on the page. Default: displacement."),
    ] = None,
    seconds: Annotated[float, typer.Option(help="Duration of GIF and MP4 \\[s].")] = 4.0,
    width: Annotated[int, typer.Option(help="Width of GIF and MP4 in pixels.")] = 800,
    show: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Show results in three dimensions: one HTML page that opens from disk, without a server.

    With --gif or --mp4 alone, no page is written.
    """
    from tisim.view import view_of_file

    try:
        # before the files are read, and never by a change of the name: name.v2 is not name.gif
        for option, path, ending in (("--out", out, ".html"), ("--gif", gif, ".gif"), ("--mp4", mp4, ".mp4")):
            if path is not None and path.suffix.lower() != ending:
                raise ValueError(f"{option} {path}: expected a name that ends in {ending}")
        view = view_of_file(*files, poke=poke)
        written = [
            view.animate(path, colour=colour, seconds=seconds, width=width)
            for path in (gif, mp4)
            if path is not None
        ]
        if out is not None or show or not written:
            page = out or Path(f"{_bare(files[0].resolve().name)}.html")
            written.append(view.open(page) if show else view.save(page))
    except (ValueError, OSError) as error:
        _fail(error)
    for path in written:
        typer.echo(f"{path}: {path.stat().st_size / 1e6:.2f} MB, {view.title}")


def _bare(name: str) -> str:
    """A file's name without the ending of a store or a result."""
    for ending in (".zip", ".zarr", ".vtu", ".pvd", ".inp", ".msh"):
        name = name.removesuffix(ending)
    return name


def _fail(error: ValueError | OSError) -> NoReturn:
    said = str(error)
    if isinstance(error, OSError) and error.strerror:
        said = f"cannot use {error.filename}: {error.strerror}"
    typer.echo(f"error: {' '.join(said.split())}", err=True)
    raise typer.Exit(2)
