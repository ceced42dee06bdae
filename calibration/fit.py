"""`python -m calibration.fit`: material parameters from an experiment, by CMA-ES and Gauss-Newton."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from calibration._command import plain_ends
from calibration._options import Laws, Measured, Workers, command, laws_in, names_in, processes
from calibration._screen import FitScreen, law_table
from calibration.diagnosis.rig import Rig, read_rig
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Experiment, read
from calibration.search import CmaOptions
from calibration.study import (
    Calibration,
    FitOptions,
    ObjectiveName,
    OnSetup,
    Task,
    run,
    stopped,
    usable,
    write_card,
)
from calibration.study.report import write_report

app = command()

EXAMPLES = """
[bold]Examples[/bold]

One law for every material of the experiment:

  python -m calibration.fit measured/bench --model ogden

All six laws, a table that compares them, report.html and cards:

  python -m calibration.fit measured/bench --model all --out calibrations/bench

Two laws, one material, cards where factory.build looks for them:

  python -m calibration.fit measured/bench --model neo-hookean,ogden --material S1 --cards datasets/materials

Corrected for what a diagnosis found in rig and camera:

  python -m calibration.fit measured/bench --rig diagnoses/bench/cards/rig.yaml --out calibrations/bench-rig

As the paper did it, by the overlap of bodies instead of the likelihood (no error bars):

  python -m calibration.fit measured/bench --objective dice --out calibrations/bench-dice

Stopped or killed, the same command goes on where it was; what is known so far is written when it is stopped.

Exit codes: 0 fitted, 1 some fit did not converge, 2 bad input, 130 stopped by Ctrl-C.
"""


@app.command(epilog=EXAMPLES)
def main(
    experiment: Measured,
    model: Laws = "all",
    material: Annotated[
        str | None, typer.Option(help="Materials, separated by commas. Default: all of the experiment.")
    ] = None,
    terms: Annotated[int, typer.Option(help="Terms of a series law (Ogden).", min=1, max=3)] = 1,
    objective: Annotated[
        str, typer.Option(help="likelihood, or dice: the overlap of bodies, as in the paper.")
    ] = "likelihood",
    rig: Annotated[
        Path | None,
        typer.Option(
            help="rig.yaml of a diagnosis of photographed beams: faults of rig and camera to correct for."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. Default: calibrations/EXPERIMENT.")
    ] = None,
    cards: Annotated[Path | None, typer.Option(help="Folder of the cards. Default: OUT/cards.")] = None,
    seed: Annotated[int, typer.Option(help="Seed of CMA-ES.")] = 1,
    population: Annotated[
        int | None, typer.Option(help="Candidates a generation. Default: 4 + 3 ln n.", min=4)
    ] = None,
    generations: Annotated[int, typer.Option(help="At most so many generations.", min=1)] = 60,
    restarts: Annotated[int, typer.Option(help="Restarts with twice the population.", min=0)] = 0,
    polish: Annotated[bool, typer.Option(help="Gauss-Newton polish and error bars.")] = True,
    held_out: Annotated[bool, typer.Option(help="Predict each beam from the others.")] = True,
    workers: Workers = None,
    overwrite: Annotated[bool, typer.Option(help="Start anew instead of going on.")] = False,
) -> None:
    """Fit constitutive laws to beams and coupons; writes fits, cards and report.html."""
    with plain_ends():
        data = read(experiment)
        names = laws_in(model)
        wanted = _materials(material, data)
        minimised = _objective(objective)
        setup = _rig(rig, data, minimised, wanted)
        folder = out or Path("calibrations") / (experiment.resolve().name)
        _check_folder(folder, overwrite)
        options = FitOptions(
            cma=CmaOptions(seed=seed, population=population, max_generations=generations, restarts=restarts),
            gauss_newton=polish and minimised == "likelihood",  # Dice is not smooth where it is best
            leave_one_out=held_out,
        )
        tasks = [
            Task(
                experiment=experiment.resolve(),
                digest=data.digest,
                material=m,
                law=law,
                terms=terms if law == "ogden" else 1,
                options=options,
                folder=folder / "fits",
                objective=minimised,
                setup=setup,
            )
            for law in names
            for m in wanted
        ]
        console = Console()
        if setup is not None:
            console.print(setup.sentence, markup=False, highlight=False)
        results = _fit(tasks, OnSetup.of(data, setup), console, processes(workers), folder, cards)
    raise typer.Exit(0 if all(r.status == "converged" for r in results) else 1)


def _fit(
    tasks: list[Task], data: Experiment, console: Console, workers: int, folder: Path, cards: Path | None
) -> list[Calibration]:
    with plain_ends(f"Stopped. The same command goes on; the best so far is in {folder}."):
        try:
            with FitScreen(console) as screen:
                results = run(tasks, workers=workers, told=screen.update)
        except KeyboardInterrupt:
            _write(stopped(tasks, data), data, console, folder, cards)
            raise
        _write(results, data, console, folder, cards)
    return results


def _write(
    results: list[Calibration], data: Experiment, console: Console, folder: Path, cards: Path | None
) -> None:
    if not results:
        console.print("No fit has found anything yet: no cards, no report.")
        return
    console.print(law_table(results))
    for name in dict.fromkeys(r.material for r in results):
        mine = [r for r in results if r.material == name]
        if any(usable(r) for r in mine):
            console.print(f"card: {write_card(cards or folder / 'cards', mine, data)}")
        else:
            console.print(f"{name}: no card, since no law has a finished fit")
    console.print(f"report: {write_report(folder, results, data)}")


def _objective(name: str) -> ObjectiveName:
    if name == "likelihood":
        return "likelihood"
    if name == "dice":
        return "dice"
    raise InputError(f"--objective {name}: expected likelihood or dice")


def _rig(path: Path | None, data: Experiment, minimised: ObjectiveName, materials: list[str]) -> Rig | None:
    """What is known of the rig; InputError where these fits cannot be corrected by it."""
    if path is None:
        return None
    if minimised != "likelihood":
        raise InputError(f"--rig {path}: expected --objective likelihood, overlaps of bodies know no rig")
    marked = [t.id for t in data.trials if isinstance(t, BeamTrial) and t.material in materials and t.markers]
    if marked:
        raise InputError(
            f"--rig {path}: corrects outlines, not markers: expected none, but trial {marked[0]} has some"
        )
    return read_rig(path).on(data)


def _materials(wanted: str | None, data: Experiment) -> list[str]:
    used = {t.material for t in data.trials}
    if wanted is None:
        return [m for m in data.materials if m in used]
    names = names_in(wanted)
    for name in names:
        if name not in used:
            raise InputError(f"--material {name}: expected some of {', '.join(sorted(used))}")
    return names


def _check_folder(folder: Path, overwrite: bool) -> None:
    """Refuse a folder that holds something else; with overwrite, remove our own fits only."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: expected a folder to write to")
    if overwrite and (folder / "fits").is_dir():
        shutil.rmtree(folder / "fits")
    folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder}: expected a folder that can be written to")


if __name__ == "__main__":
    app()
