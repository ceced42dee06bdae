"""`python -m calibration.new`: from a lab's own files to an experiment."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from typing import Annotated, Any

import typer

from calibration._files import write_whole
from calibration.cli import command, plain_ends
from calibration.errors import InputError, OptionError
from tisim.options import Version

app = command()

EXAMPLES = """
[bold]Examples[/bold]

What a machine's file holds, as it is understood:

  python -m calibration.new pull.csv --show

An experiment from files, with questions; an answers file asks none:

  python -m calibration.new pull.csv squeeze.txt beam.jpg --out lab

  python -m calibration.new --yes datasets/lab-files/answers.yaml --out lab

The checkerboard for photographs, to print at 100 %:

  python -m calibration.new --board board.pdf --squares 9x6 --square-mm 10

Exit codes: 0 done, 2 bad input and nothing written, 130 stopped by Ctrl-C.
"""


@app.command(epilog=EXAMPLES)
@plain_ends()
def main(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Photographs, traced outlines, displacements of markers, records of machines"
            " (docs/how-to/lab-files.md)."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder to write: new or empty.")] = None,
    yes: Annotated[
        Path | None, typer.Option(help="YAML file with the answers; no questions are asked.")
    ] = None,
    show: Annotated[
        bool, typer.Option("--show", help="Show how the files are read, and write nothing.")
    ] = False,
    board: Annotated[Path | None, typer.Option(help="PDF to write with the checkerboard to print.")] = None,
    squares: Annotated[str, typer.Option(help="Squares of the board along its two sides.")] = "9x6",
    square_mm: Annotated[float, typer.Option(help="Side of a square of the board in mm.")] = 10.0,
    page: Annotated[str, typer.Option(help="Page of the board: a4, a3 or letter.")] = "a4",
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Make an experiment from photographs, traced outlines, markers or the files of testing machines: asks
    for what is missing, proposes standard deviations, checks units by plausibility, and reads what it wrote.
    """
    given = list(files or [])
    if yes is not None and given:
        raise InputError("--yes: expected no files beside it, the answers name them")
    if show:
        _show(given)
        return
    alone = yes is None and not given
    printed = None if board is None else _board(board, squares, square_mm, page)
    if out is None and not (printed and alone):
        raise OptionError("out", None, "missing, expected the folder to write")
    if alone and not printed:
        raise InputError("expected files, or answers by --yes FILE, or --board FILE")
    if not alone:
        assert out is not None
        _build(given, out, yes)
    if board is not None and printed is not None:  # last: a command that fails has written nothing
        write_whole(board, printed)
        size = f"{squares.lower().replace('x', ' x ')} squares of {square_mm:g} mm"
        typer.echo(f"{board}: {size} on {page}; print at 100 %")


def _show(files: list[Path]) -> None:
    from calibration.lab_files import read_lab_file
    from calibration.new._interview import describe

    if not files:
        raise OptionError("show", None, "expected files beside it")
    for file in files:
        typer.echo(describe(file, *read_lab_file(file)))


def _board(path: Path, squares: str, square_mm: float, page: str) -> bytes:
    """The PDF of the board; what would keep it from being written there is refused."""
    from pydantic import ValidationError

    from calibration.experiment._yaml import first_reason
    from calibration.new._answers import BoardAnswers
    from calibration.new._board import board_pdf

    if path.suffix.lower() != ".pdf" or path.is_dir():
        raise OptionError("board", path, "expected a file .pdf")
    if not os.access(path.absolute().parent, os.W_OK):
        raise OptionError("board", path, "expected a file in a folder that is there and can be written to")
    try:
        columns, rows = (int(n) for n in squares.lower().split("x"))
    except ValueError:
        raise OptionError("squares", squares, "expected two whole numbers, 9x6 for instance") from None
    try:
        board = BoardAnswers.model_validate(
            {"squares": (columns, rows), "square_mm": square_mm, "page": page}
        )
    except ValidationError as error:
        place, reason = first_reason(error)
        given = {"squares": squares, "square_mm": f"{square_mm:g}", "page": page}
        raise OptionError(str(place[0]), given[str(place[0])], reason) from None
    return board_pdf(board, "--square-mm")


def _build(files: list[Path], out: Path, yes: Path | None) -> None:
    from calibration.new._answers import validate
    from calibration.new._asking import Nobody, Terminal
    from calibration.new._build import build, check_target, dump
    from calibration.new._interview import interview
    from calibration.new._read import read_answers

    check_target(out)
    if yes is not None:
        asker = Nobody(yes)
        made = build(read_answers(yes, asker), yes.parent, out, asker)
    else:
        raw: dict[str, Any] = {}
        try:
            interview(files, out.absolute().name, raw)
            made = build(validate(raw), Path.cwd(), out, Terminal(raw), raw)
        except (InputError, KeyboardInterrupt):
            if raw.get("trials"):
                said = "Nothing is written. An answers file that says what you said (--yes FILE):"
                typer.echo(f"\n{said}\n{dump(raw)}")
            raise
    for text in made.defaults:
        typer.echo(f"not stated, taken: {text}")
    counts = ", ".join(f"{n} {kind}{'s' if n > 1 else ''}" for kind, n in made.experiment.counts.items())
    photos = any(c.photo is not None for t in made.experiment.trials for c in getattr(t, "captures", ()))
    after = "reconstruct" if photos else "fit"
    typer.echo(
        f"{made.folder}: {counts}; next: python -m calibration.{after} {shlex.quote(str(made.folder))}"
    )
