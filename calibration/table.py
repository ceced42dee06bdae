"""`python -m calibration.table`: the paper's table of calibration results for an experiment."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from calibration.cli import FitScreen, Laws, Measured, Workers, check_folder, command, plain_ends
from calibration.errors import InputError
from tisim.options import Version

if TYPE_CHECKING:
    from calibration.experiment import Experiment
    from calibration.study import Calibration
    from calibration.study.paper_table import Row

app = command()

EXAMPLES = """
[bold]Examples[/bold]

All six laws; fits that are missing in calibrations/clean are made first:

  python -m calibration.table datasets/measured/bench/clean

Fits of your own, no new ones:

  python -m calibration.table datasets/measured/bench/clean --fits fits/of-today --no-run --model ogden

Fits that calibration.fit corrected for what is known of rig and camera:

  python -m calibration.table datasets/measured/bench/grips-short --fits on-rig --rig diagnosed/cards/rig.yaml

Exit codes: 0 written, 1 written and some law has no figures, 2 bad input, 130 stopped by Ctrl-C.
"""


@app.command(epilog=EXAMPLES)
def main(
    experiment: Measured,
    fits: Annotated[
        Path | None,
        typer.Option(help="Folder that calibration.fit wrote. Default: calibrations/EXPERIMENT."),
    ] = None,
    model: Laws = "all",
    rig: Annotated[
        Path | None,
        typer.Option(
            help="rig.yaml with which the fits were made: beams and photographs are simulated on this rig."
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder of table.csv and table.md. Default: that of the fits.")
    ] = None,
    run_missing: Annotated[
        bool, typer.Option("--run/--no-run", help="Run missing fits, or leave their rows empty.")
    ] = True,
    workers: Workers = None,
    version: Version = False,  # noqa: ARG001 - shown before anything else
) -> None:
    """Table of calibration results of photographed beams beside the paper's: table.csv and table.md."""
    console = Console()
    with plain_ends():
        from rich.progress import track

        from calibration.api import read_experiment
        from calibration.fit_plan import known_rig, law_names, processes
        from calibration.study import OnSetup
        from calibration.study.paper_table import fits_folder, measured, read_fit, row

        data = read_experiment(experiment)
        names = law_names(model)
        materials = _materials(data, experiment)
        setup = known_rig(rig, data, materials)
        data = OnSetup.of(data, setup)
        home = fits or Path("calibrations") / experiment.resolve().name
        folder = fits_folder(home) if fits else home / "fits"
        target = out or home
        check_folder(target, "table", overwrite=True)  # fits may take hours
        found = {(law, m): read_fit(folder, data, m, law) for law in names for m in materials}
        bodies = {m: measured(data, m) for m in materials}
        if run_missing:
            _fill(found, data, folder, processes(workers), console, rig=rig)
        rows = [
            row(law, fit, data, m, bodies[m], workers=workers)
            for (law, m), fit in track(
                list(found.items()), description="bodies", console=console, transient=True
            )
        ]
        target.mkdir(parents=True, exist_ok=True)
        said = _command(experiment, fits, model, rig, out, run_missing)
        _write(rows, target, console, command=said, data=data)
    raise typer.Exit(0 if all(r.measures for r in rows) else 1)


def _materials(data: Experiment, folder: Path) -> list[str]:
    """Materials with traced beams of known weight; InputError where there is none, or a weight is missing."""
    from calibration.study.paper_table import traced_beams

    main = folder / "experiment.yaml"
    found = [m for m in data.materials if traced_beams(data, m)]
    if not found:
        raise InputError(
            f"{main}: expected at least one beam with an outline, found trials of kind"
            f" {', '.join(data.counts)}:"
            " the paper's table compares the bodies of photographed beams; calibration.fit writes a report of"
            " every kind"
        )
    for m in found:
        if data.materials[m].density is None:
            raise InputError(
                f"{main}: materials.{m}.density_kg_m3: expected, since beams of an unknown weight cannot be"
                " simulated"
            )
    return found


def _fill(
    found: dict[tuple[str, str], Calibration | None],
    data: Experiment,
    folder: Path,
    workers: int,
    console: Console,
    *,
    rig: Path | None,
) -> None:
    """Make the fits that are missing, as calibration.fit makes them without other options than --rig."""
    from calibration.study import OnSetup, run, tasks_for

    missing = [key for key, fit in found.items() if fit is None]
    setup = data.setup if isinstance(data, OnSetup) else None
    tasks = [
        task
        for law, m in missing
        for task in tasks_for(
            data, law_names=[law], materials=[m], folder=folder, setup=setup, setup_file=str(rig or "")
        )
    ]
    if not tasks:
        return
    with FitScreen(console) as screen:
        results = run(tasks, workers=workers, on_progress=screen.update)
    found.update(zip(missing, results, strict=True))


def _write(rows: list[Row], target: Path, console: Console, *, command: str, data: Experiment) -> None:
    from calibration.study import OnSetup
    from calibration.study.paper_table import averages
    from calibration.study.paper_table_files import AS_STATED, rich_table, write_csv, write_markdown

    whole = [*rows, *averages(rows)]
    order = list(dict.fromkeys(r.law for r in rows))
    whole.sort(key=lambda r: order.index(r.law))  # stable: a law's average stands after its mixtures
    console.print(rich_table(whole))
    write_csv(target / "table.csv", whole)
    source = f"Experiment {data.name!r} (sha256 {data.digest[:16]})."
    setup = f"beams and photographs {data.setup.sentence}" if isinstance(data, OnSetup) else AS_STATED
    write_markdown(target / "table.md", whole, command=command, source=source, setup=setup)
    console.print(f"{target / 'table.csv'}, {target / 'table.md'}", soft_wrap=True)


def _command(
    experiment: Path, fits: Path | None, model: str, rig: Path | None, out: Path | None, run_missing: bool
) -> str:
    parts = ["python", "-m", "calibration.table", str(experiment)]
    parts += ["--fits", str(fits)] if fits else []
    parts += ["--model", model] if model != "all" else []
    parts += ["--rig", str(rig)] if rig else []
    parts += ["--out", str(out)] if out else []
    parts += [] if run_missing else ["--no-run"]
    return shlex.join(parts)


if __name__ == "__main__":
    app()
