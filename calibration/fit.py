"""`python -m calibration.fit`: material parameters from an experiment, by CMA-ES and Gauss-Newton."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from calibration.cli import FitScreen, Laws, Measured, Seed, Workers, command, law_table, names_in, plain_ends
from calibration.fit_request import FitRequest
from tisim.options import Version

if TYPE_CHECKING:
    from calibration.fit_plan import FitPlan
    from calibration.results import Fits

app = command()

EXAMPLES = """
[bold]Examples[/bold]

One law for every material of the experiment:

  python -m calibration.fit datasets/measured/bench/clean --model ogden

All six laws, a table that compares them, report.html and cards:

  python -m calibration.fit datasets/measured/bench/clean --model all --out calibrations/clean

One law, one material, cards where factory.build looks for them:

  python -m calibration.fit datasets/measured/coupons --model ogden --material M1 --cards datasets/materials

Relaxation and softening beside the law, from ramps, holds and cycles of homogeneous tests with a clock:

  python -m calibration.fit EXPERIMENT --model ogden --time prony --damage mullins

The relaxation that was found in coupons, held in a fit to beams:

  python -m calibration.fit BEAMS --model neo-hookean --start fitted/cards/M1.yaml

Corrected for what a diagnosis found in rig and camera:

  python -m calibration.fit datasets/measured/bench/grips-short --rig diagnosed/cards/rig.yaml

As the paper did it, by the overlap of bodies instead of the likelihood (no error bars):

  python -m calibration.fit datasets/measured/bench/clean --objective dice --out calibrations/clean-dice

Stopped or killed, the same command goes on where it was; what is known so far is written when it is stopped.

Exit codes: 0 every fit converged, 1 some did not or lacks fit, 2 bad input, 130 stopped by Ctrl-C.
"""


@app.command(epilog=EXAMPLES)
def main(
    experiment: Measured,
    model: Laws = "all",
    material: Annotated[
        str | None,
        typer.Option(
            help="Materials, separated by commas (double quotes around a name with one). Default: all."
        ),
    ] = None,
    terms: Annotated[
        int, typer.Option(help="Terms of a series law (Ogden).", min=1, max=3)
    ] = FitRequest.terms,
    time: Annotated[
        str | None,
        typer.Option(
            help="Relaxation beside the law, from tests over time (a column time_s, photographs at several"
            " times, released cantilevers): prony (the data choose the number of terms), prony:1 to prony:3,"
            " or prony:spectrum (two stated times a decade). Moduli are then long-time ones."
        ),
    ] = None,
    damage: Annotated[
        str | None,
        typer.Option(
            help="Softening beside the law, from homogeneous or compression tests that unload: mullins."
        ),
    ] = None,
    fibres: Annotated[
        bool,
        typer.Option(
            "--fibres",
            help="One family of fibres beside the law, at the same angle in all homogeneous tests.",
        ),
    ] = FitRequest.fibres,
    objective: Annotated[
        str, typer.Option(help="likelihood, or dice: the overlap of bodies, as in the paper.")
    ] = FitRequest.objective,
    free_bulk_ratio: Annotated[
        bool,
        typer.Option(
            "--free-bulk-ratio",
            help="Fit K/G too, from photographed beams. Default: fixed at 300, as in a diagnosis.",
        ),
    ] = FitRequest.free_bulk_ratio,
    rig: Annotated[
        Path | None,
        typer.Option(
            help="rig.yaml of a diagnosis of photographed beams: faults of rig and camera to correct for."
        ),
    ] = None,
    start: Annotated[
        Path | None,
        typer.Option(
            help="Material card, or folder of cards, with viscosity, softening or fibres: held in the fit as"
            " they are, or where --time, --damage or --fibres asks for them, the start of its search."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. Default: calibrations/EXPERIMENT.")
    ] = None,
    cards: Annotated[Path | None, typer.Option(help="Folder of the cards. Default: OUT/cards.")] = None,
    seed: Seed = FitRequest.seed,
    population: Annotated[
        int | None, typer.Option(help="Candidates per generation. Default: 4 + 3 ln n.", min=4)
    ] = None,
    generations: Annotated[
        int, typer.Option(help="Largest number of generations.", min=1)
    ] = FitRequest.generations,
    restarts: Annotated[
        int, typer.Option(help="Restarts with twice the population.", min=0)
    ] = FitRequest.restarts,
    polish: Annotated[bool, typer.Option(help="Gauss-Newton polish and error bars.")] = FitRequest.polish,
    held_out: Annotated[bool, typer.Option(help="Predict each beam from the others.")] = FitRequest.held_out,
    workers: Workers = None,
    overwrite: Annotated[
        bool, typer.Option(help="Discard earlier results and start again.")
    ] = FitRequest.overwrite,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Fit constitutive laws to all measurements of an experiment; writes fits, cards and report.html."""
    console = Console()
    with plain_ends():
        from calibration.fit_plan import plan_fit

        request = FitRequest(
            model=model,
            materials=None if material is None else names_in(material),
            terms=terms,
            time=time,
            damage=damage,
            fibres=fibres,
            objective=objective,
            free_bulk_ratio=free_bulk_ratio,
            rig=rig,
            start=start,
            out=out or Path("calibrations") / experiment.resolve().name,
            seed=seed,
            population=population,
            generations=generations,
            restarts=restarts,
            polish=polish,
            held_out=held_out,
            workers=workers,
            overwrite=overwrite,
        )
        plan = plan_fit(experiment, request)
        if plan.rig is not None:
            console.print(plan.rig.sentence, markup=False, highlight=False)
    with plain_ends(f"Stopped. The same command goes on; the best so far is in {plan.folder}."):
        try:
            with FitScreen(console) as screen:
                found = plan.run(screen.update)
        except KeyboardInterrupt:
            _write(plan, plan.stopped(), console, cards)
            raise
        _write(plan, found, console, cards)
    raise typer.Exit(0 if found.converged else 1)


def _write(plan: FitPlan, found: Fits, console: Console, cards: Path | None) -> None:
    if not len(found):
        console.print("No fit has found anything yet: no cards, no report.")
        return
    from calibration.study.calibration import shared_notes

    every = plan.with_earlier(found)
    for sentence in every.headlines:
        console.print(sentence, markup=False, highlight=False, soft_wrap=True, style="bold")
    for note, fits in shared_notes(found).items():
        names = "; ".join(f"{r.material}, {r.label}" for r in fits)
        console.print(f"{names}: {note}", markup=False, highlight=False, soft_wrap=True)
    console.print(law_table(every))
    earlier = every.results[len(found) :]
    if earlier:
        names = ", ".join(f"{r.material} {r.label}" for r in earlier)
        console.print(f"fitted by an earlier run: {escape(names)}", highlight=False, soft_wrap=True)
    folder = cards or plan.folder / "cards"
    for path in every.write_cards(folder):
        console.print(f"card: {escape(str(path))}", highlight=False, soft_wrap=True)
    report = every.write_report(plan.folder)
    console.print(f"report: {escape(str(report))}", highlight=False, soft_wrap=True)


if __name__ == "__main__":
    app()
