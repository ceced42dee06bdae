"""`python -m learn.page`: a trained surrogate as one HTML file, to poke the block in without a server."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from learn._options import Dataset, Plugins, Version, load_plugins, single
from learn._terminal import log_to, make_console, plain_errors

EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.page runs/quick --out poke.html

Only some of the dataset's inclusions to choose from, and more simulated pokes to compare with:

  python -m learn.page runs/quick --shape cube-18 --shape sphere-9 --pokes 8

The run's own part of the page alone, a zip of a megabyte or two, and the page from it:

  python -m learn.page runs/quick --parts poke.zip

  python -m learn.page poke.zip --out poke.html

The file opens from disk in any browser with WebAssembly and WebGL 2: no server, no network.

Needs the packages of 'tisim\\[export]'.

Exit codes: 0 written, 2 bad input, or a page of more than 10 MB gzipped.
"""


POKES = 4  # by default


def main(
    run: Annotated[
        Path,
        typer.Argument(
            help="Folder of a run of invariant-gnn or invariant-gnn-small, covers, or the zip of --parts."
        ),
    ],
    dataset: Dataset = None,
    shape: Annotated[
        list[str] | None,
        typer.Option(
            "--shape",
            metavar="NAME",
            help="Name of an inclusion that the page offers; repeatable. Default: all.",
        ),
    ] = None,
    pokes: Annotated[
        int | None,
        typer.Option(
            min=0,
            max=100,
            help=f"Number of simulated test pokes to compare with. Default: {POKES}, 0 without the dataset.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="The HTML file.")] = Path("poke.html"),
    parts: Annotated[
        Path | None,
        typer.Option(
            help="Write a zip with the run's part of the page, in place of the page.", show_default=False
        ),
    ] = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Write a run as one interactive HTML page that opens from disk."""
    console = make_console()
    log_to(console)
    with plain_errors():
        from learn.errors import InputError
        from learn.page.document import Parts, parts_of
        from learn.predictor import load

        load_plugins(plugin or [])
        for option, path in (("--out", out), ("--parts", parts)):
            if path is not None and path.is_dir():
                raise InputError(f"{option} {path}: expected the name of a file, this is a folder")
        if run.suffix == ".zip":
            if parts is not None or shape or dataset is not None or pokes is not None:
                raise InputError(
                    f"{run}: expected no --parts, --shape, --pokes or --dataset: its content is settled"
                )
            own = Parts.load(run)
        else:
            predictor = load(run, dataset=dataset)
            if pokes is None:
                pokes = POKES if predictor.store.has_fields else 0
                if not pokes:
                    console.print(
                        f"no simulated pokes to compare with: {predictor.store.location} is not here, "
                        "--dataset states where it is"
                    )
            own = parts_of(predictor, shapes=shape, pokes=pokes)
        if parts is not None:
            own.save(parts)
            console.print(f"{parts}: {parts.stat().st_size / 1e6:.1f} MB")
            return
        made = own.write(out)
        shown = f"{made.pokes or 'no'} simulated poke{'' if made.pokes == 1 else 's'}"
        console.print(
            f"{made.path}: {made.size / 1e6:.1f} MB, {made.gzipped / 1e6:.1f} MB gzipped; {made.interiors} "
            f"interiors, {shown} of the test part"
        )


app = single(main, EXAMPLES)
