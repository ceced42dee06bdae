"""`python -m calibration.predict`: measured against predicted, for trials that were not used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from calibration.cli import Seed, Workers, check_folder, command, elapsed, names_in, plain_ends
from calibration.errors import InputError
from tisim.options import Version

if TYPE_CHECKING:
    from calibration.results import PredictionResult

app = command()

EXAMPLES = """
[bold]Examples[/bold]

The cards of a diagnosis against another experiment: report.html, prediction.png and prediction.json

  python -m calibration.predict diagnoses/creeps/cards datasets/measured/bench/clean

Fit to some trials of one experiment, predict the others (by id, material=, specimen=, length= or mode=):

  python -m calibration.predict datasets/measured/bench/creeps --calibrate "S1-c*" --predict "S1-b*"

Exit codes: 0 predicted, 2 bad input, 130 stopped.
"""


@app.command(epilog=EXAMPLES)
def main(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="[CARDS] EXPERIMENT",
            help="Folder of material cards (or one card), without --calibrate; folder with experiment.yaml.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. Default: predictions/EXPERIMENT.")
    ] = None,
    calibrate: Annotated[
        str | None,
        typer.Option(
            help="Trials to fit, in place of cards: ids with * and ?, or material=, specimen=, length= (mm),"
            " mode=; several by commas."
        ),
    ] = None,
    predict: Annotated[
        str | None, typer.Option(help="Trials to predict, named alike. Default with cards: all.")
    ] = None,
    baseline: Annotated[
        Path | None, typer.Option(help="Cards of the baseline, in place of the baseline stated in CARDS.")
    ] = None,
    domain: Annotated[
        str | None,
        typer.Option("--domain", "--kind", help="Kind of measurement, if the experiment has several."),
    ] = None,
    law: Annotated[
        str, typer.Option(help="Law of the baseline of --calibrate: auto, or a name with terms (ogden:2).")
    ] = "auto",
    extend: Annotated[
        str,
        typer.Option(
            help="Effects that extend the model of --calibrate, by commas. Default: by a diagnosis."
        ),
    ] = "",
    specimen_scatter: Annotated[
        float | None,
        typer.Option(
            help="Relative sd of the modulus between specimens of a material, for named specimens that cards"
            " predict. Default: 0.15."
        ),
    ] = None,
    seed: Seed = 0,
    workers: Workers = None,
    overwrite: Annotated[bool, typer.Option(help="Replace an earlier prediction.")] = False,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Predict trials that no fit has used, by the baseline and the extended model; writes report.html."""
    console = Console()
    with plain_ends():
        cards, experiment = _paths(paths, calibrate)
        folder = out or Path("predictions") / experiment.resolve().name
        check_folder(folder, "prediction", overwrite)
        from calibration import api

        data = api.read_experiment(experiment)
        found = api.predict(
            data,
            cards,
            calibrate=calibrate,
            predict=predict,
            baseline=baseline,
            domain=domain,
            law=law,
            extend=names_in(extend),
            specimen_scatter=specimen_scatter,
            seed=seed,
            workers=workers,
            on_progress=elapsed(console),
        )
        _show(found, found.write(folder), console)


def _paths(paths: list[Path], calibrate: str | None) -> tuple[Path | None, Path]:
    if calibrate is None and len(paths) != 2:
        raise InputError("expected CARDS EXPERIMENT, or EXPERIMENT with --calibrate and --predict")
    if calibrate is not None and len(paths) != 1:
        raise InputError(f"--calibrate {calibrate}: expected EXPERIMENT alone, without cards")
    return (paths[0] if len(paths) == 2 else None), paths[-1]


def _show(found: PredictionResult, report: Path, console: Console) -> None:
    console.print()
    console.print(found.sentence, style="bold", markup=False, highlight=False, soft_wrap=True)
    for note in found.prediction.notes:
        console.print(note, markup=False, highlight=False, soft_wrap=True)
    table = Table(box=SIMPLE, pad_edge=False, collapse_padding=True)
    for k, heading in enumerate(found.head()):
        table.add_column(heading, min_width=18 if k == 0 else None)
    for row in found.rows():
        table.add_row(*map(escape, row))
    console.print(table)
    console.print(f"Report: {report}, {found.prediction.seconds:.0f} s", markup=False, soft_wrap=True)


if __name__ == "__main__":
    app()
