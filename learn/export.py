"""`python -m learn.export`: a trained surrogate as ONNX files, checked."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from learn._options import Dataset, Plugins, Version, check_folder, load_plugins, single
from learn._terminal import make_console, plain_errors

EXAMPLES = """
[bold]Example[/bold]

  python -m learn.export runs/quick --out surrogate

encoder.onnx: rigid (n, levels) -> code, vectors, clear, layers: once an interior.
poke.onnx: these four, start, direction, depth, modulus -> displacement, force. SI units.
For the paper's model, in double precision, poke.onnx alone: profile (n, levels), start, direction, depth.
model.json: the points, the indenter, and the domain of validity (trained ranges).

Needs the packages of 'tisim\\[export]'.

Exit codes: 0 written and checked, 2 bad input or a check that failed.
"""


def main(
    run: Annotated[Path, typer.Argument(help="Folder of a run, or covers.")],
    dataset: Dataset = None,
    out: Annotated[Path | None, typer.Option(help="Default: onnx/ in the run, or covers-onnx/.")] = None,
    shape: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Shape of the dataset for whose block the files are; needed if the blocks differ.",
            show_default=False,
        ),
    ] = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Export a run as ONNX on a grid of the dataset, and check it on test pokes."""
    console = make_console()
    with plain_errors():
        from learn.onnx_bundle import write_bundle
        from learn.predictor import load
        from learn.pretrained import results_of

        load_plugins(plugin or [])
        folder = out or results_of(run, "onnx")
        check_folder(folder)
        predictor = load(run, dataset=dataset)
        files, wrong, pokes = write_bundle(
            predictor.run, predictor.store, folder, predictor.domain, shape=shape
        )
        console.print(
            f"{', '.join(str(path) for path in files)} and model.json; "
            f"{wrong:.1e} off torch over {pokes} pokes"
        )


app = single(main, EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.export")
