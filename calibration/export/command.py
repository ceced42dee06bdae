"""`python -m calibration.export`: a material card for another program, with what is lost on the way."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from calibration.cli import command, plain_ends
from tisim.options import Version

app = command()

EXAMPLES = """
[bold]Examples[/bold]

The paper's beam of card S1 in CalculiX, run there and compared:

  python -m calibration.export datasets/materials/S1.yaml --to calculix --out S1-calculix --check

The beam that a card was calibrated on, for MuJoCo:

  python -m calibration.export fitted/cards/S0.yaml --to mujoco --out S0-mujoco
    --experiment datasets/measured/bench/clean

Exit codes: 0 written, 1 written but --check found another beam than stated (or none is stated), 2 bad
input or a program that did not solve the beam, 130 stopped.
"""
TARGETS = "sofa, febio, abaqus, calculix, mujoco, newton"


@app.command(epilog=EXAMPLES)
def main(
    card: Annotated[Path, typer.Argument(help="A material card, MATERIAL.yaml.")],
    to: Annotated[str, typer.Option(help=f"Program: {TARGETS}.")],
    out: Annotated[Path, typer.Option(help="Folder to write: new or empty.")],
    law: Annotated[
        str | None, typer.Option(help="One of the card's laws. Default: the one that the card names.")
    ] = None,
    experiment: Annotated[
        Path | None,
        typer.Option(help="Folder with experiment.yaml: its beam is the scene. Default: the paper's."),
    ] = None,
    trial: Annotated[
        str | None, typer.Option(help="The beam's trial. Default: the first of the card's material.")
    ] = None,
    scene: Annotated[bool, typer.Option(help="Write the beam as well.")] = True,
    refinement: Annotated[float, typer.Option(help="Factor by which the beam's elements are smaller.")] = 1.0,
    most_loss: Annotated[
        float,
        typer.Option(
            help="Largest relative rms difference in stress at which another law may replace the card's."
        ),
    ] = 0.5,
    check: Annotated[
        bool, typer.Option(help="Run the program on the beam and compare: calculix, mujoco, newton.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option(help="Replace an earlier export in the folder; other files stay.")
    ] = False,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Export a material card and its beam to another program, with what is lost and how much."""
    console = Console()
    with plain_ends():
        from calibration.export._export import export_card
        from calibration.export._readme import constants
        from calibration.export._response import percent

        found = export_card(
            card, to=to, out=out, law=law, experiment=experiment, trial=trial, scene=scene,
            refinement=refinement, most_loss=most_loss, check=check, overwrite=overwrite,
        )  # fmt: skip

        def show(text: str, style: str = "") -> None:
            console.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

        show(f"{found.job.name} for {to}: {constants(found.job.form)}", "bold")
        for sentence in found.lost or ("Nothing of the law and its parts is lost.",):
            show(f"- {sentence}")
        for remark in found.remarks:
            show(f"- {remark[0].upper()}{remark[1:].removesuffix('.')}.")
        show(f"Written: {', '.join(map(str, found.files))}")
        if (run := found.checked) is not None:
            words = "as stated" if found.within else "BEYOND what is stated"
            compared = "not compared with an expected one, which tisim did not find, but is"
            if isfinite(run.from_expected):
                compared = (
                    f"{percent(run.from_expected)} from what was expected, {words} (at most"
                    f" {percent(run.limit)}), and"
                )
            show(
                f"Run: the beam's end is {compared} {percent(run.from_reference)} from the card's beam in"
                " tisim.",
                "bold",
            )
    if not found.within:
        raise typer.Exit(1)
