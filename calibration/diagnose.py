"""`python -m calibration.diagnose`: what the simulation of an experiment gets wrong, and why."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from calibration._command import plain_ends
from calibration.diagnosis import KINDS, SIMULATORS, Diagnosis, Rules, diagnose, model_of
from calibration.diagnosis.card import write_cards
from calibration.diagnosis.report import write_report
from calibration.errors import InputError
from calibration.experiment import read

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

Beams photographed by a lab: verdict, report.html, pictures, cards and diagnosis.json

  python -m calibration.diagnose measured/bench/creeps --out diagnoses/creeps

Would another cause have done as well? Take the named one out of the catalogue:

  python -m calibration.diagnose measured/bench/creeps --without creep --out diagnoses/without-creep

Exit codes: 0 diagnosed (whatever the verdict), 1 the baseline did not converge, 2 bad input, 130 stopped.
"""


@app.command(epilog=EXAMPLES)
def main(
    experiment: Annotated[Path, typer.Argument(help="Folder with experiment.yaml.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. Default: diagnoses/EXPERIMENT.")
    ] = None,
    kind: Annotated[
        str | None, typer.Option(help=f"{', '.join(KINDS)}: where the experiment has several.")
    ] = None,
    without: Annotated[str, typer.Option(help="Effects to leave out of the catalogue, by commas.")] = "",
    simulator: Annotated[
        str, typer.Option(help=f"Whose faults are looked for as well: {', '.join(SIMULATORS)}.")
    ] = "ours",
    gain: Annotated[bool, typer.Option(help="Measure the gain on held-out data.")] = True,
    seed: Annotated[int, typer.Option(help="Seed of the bootstrap.")] = 0,
    workers: Annotated[int | None, typer.Option(help="Processes. Default: all cores.", min=1)] = None,
    overwrite: Annotated[bool, typer.Option(help="Replace an earlier diagnosis.")] = False,
) -> None:
    """Find what the simulation of an experiment gets wrong: name the cause, or say why not."""
    console = Console()
    with plain_ends():
        data = read(experiment)
        folder = out or Path("diagnoses") / experiment.resolve().name
        _check_folder(folder, overwrite)
        left_out = [n.strip() for n in without.split(",") if n.strip()]
        model = model_of(data, kind=kind, without=left_out, simulator=simulator, workers=workers)
        begun = time.monotonic()

        def tell(what: str) -> None:
            console.print(f"[dim]{time.monotonic() - begun:6.1f} s[/dim]  {what}")

        try:
            found = diagnose(model, rules=Rules(seed=seed), gain=gain, tell=tell)
        except ValueError as error:  # no equilibrium of the baseline anywhere
            raise InputError(f"{experiment}: the baseline cannot be calibrated: {error}") from error
        folder.mkdir(parents=True, exist_ok=True)
        write_report(found, model, folder, title=data.name)
        write_cards(folder / "cards", found, data)
        # last, and in one piece: a folder with a diagnosis.json is complete
        part = folder / "diagnosis.json.part"
        text = json.dumps(found.to_json(), indent=1, ensure_ascii=False, allow_nan=False)
        part.write_text(text + "\n", encoding="utf-8")
        part.replace(folder / "diagnosis.json")
        _show(found, folder, console)
    raise typer.Exit(0 if found.finding.baseline.converged else 1)


def _check_folder(folder: Path, overwrite: bool) -> None:
    if folder.exists() and not folder.is_dir():
        raise InputError(f"--out {folder}: expected a folder, found a file")
    if (folder / "diagnosis.json").exists() and not overwrite:
        raise InputError(f"--out {folder}: holds a diagnosis already; add --overwrite to replace it")


def _show(found: Diagnosis, folder: Path, console: Console) -> None:
    console.print()
    console.print(f"[bold]{found.sentence()}[/bold]")
    for cause in found.causes():
        for name, value in cause["parameters"].items():
            console.print(
                f"  {cause['effect']} ({cause['scope']}): {name} {value['value']:.4g} +- {value['sd']:.2g}"
            )
    if found.next_experiment:
        console.print(f"Next: {found.next_experiment}.")
    console.print(f"Report: {folder / 'report.html'}, {found.seconds:.0f} s")


if __name__ == "__main__":
    app()
