"""`python -m calibration.diagnose`: what the simulation of an experiment gets wrong, and why."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from calibration.cli import Measured, Seed, Workers, check_folder, command, elapsed, names_in, plain_ends
from tisim.options import Version

if TYPE_CHECKING:
    from calibration.results import DiagnosisResult

app = command()

EXAMPLES = """
[bold]Examples[/bold]

Beams photographed by a lab: verdict, report.html, pictures, cards and diagnosis.json

  python -m calibration.diagnose datasets/measured/bench/creeps --out diagnoses/creeps

Would another cause have done as well? Take the named one out of the catalogue:

  python -m calibration.diagnose datasets/measured/bench/creeps --without creep --out diagnoses/without-creep

Exit codes: 0 diagnosed (whatever the verdict), 1 the baseline did not converge, 2 bad input, 130 stopped.
"""


@app.command(epilog=EXAMPLES)
def main(
    experiment: Measured,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. Default: diagnoses/EXPERIMENT.")
    ] = None,
    domain: Annotated[
        str | None,
        typer.Option(
            "--domain",
            "--kind",
            help="Kind of measurement, if the experiment has several: outlines, indentation, homogeneous,"
            " compression or release.",
        ),
    ] = None,
    without: Annotated[
        str, typer.Option(help="Effects to leave out of the catalogue, separated by commas.")
    ] = "",
    simulator: Annotated[
        str, typer.Option(help="Simulator whose own faults are looked for as well: tisim, or another's name.")
    ] = "tisim",
    law: Annotated[
        str,
        typer.Option(
            help="Law of the baseline, of homogeneous tests: auto, or a name with the terms of a series law"
            " (ogden:2)."
        ),
    ] = "auto",
    gain: Annotated[bool, typer.Option(help="Measure the improvement on held-out data.")] = True,
    leave_out_rows: Annotated[
        bool,
        typer.Option(help="Leave out rows of homogeneous tests at which the time decreases."),
    ] = False,
    noise: Annotated[
        str,
        typer.Option(
            help="Noise where the data contradict what the lab states: stated, or data (their own scatter)."
        ),
    ] = "stated",
    seed: Seed = 0,
    workers: Workers = None,
    overwrite: Annotated[bool, typer.Option(help="Replace an earlier diagnosis.")] = False,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Diagnose an experiment: find the effect that its simulation lacks, or state why none is named."""
    console = Console()
    with plain_ends():
        from calibration import api

        folder = out or Path("diagnoses") / experiment.resolve().name
        data = api.read_experiment(experiment, leave_out_rows=leave_out_rows)
        check_folder(folder, "diagnosis", overwrite)
        found = api.diagnose(
            data,
            domain=domain,
            without=names_in(without),
            simulator=simulator,
            law=law,
            gain=gain,
            noise=noise,
            seed=seed,
            workers=workers,
            on_progress=elapsed(console),
        )
        report = found.write(folder)
        _show(found, report, console)
    raise typer.Exit(0 if found.baseline_converged else 1)


def _show(found: DiagnosisResult, report: Path, console: Console) -> None:
    console.print()
    first, *rest = repr(found).splitlines()
    console.print(first, style="bold", markup=False, highlight=False, soft_wrap=True)
    for line in rest:
        console.print(line, markup=False, highlight=False, soft_wrap=True)
    console.print(f"Report: {report}, {found.diagnosis.seconds:.0f} s", markup=False, soft_wrap=True)


if __name__ == "__main__":
    app()
