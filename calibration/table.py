"""`python -m calibration.table`: the paper's table of calibration results for an experiment."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

from calibration._command import plain_ends
from calibration._options import Laws, Measured, Workers, command, laws_in, processes
from calibration._screen import FitScreen
from calibration.errors import InputError
from calibration.experiment import Experiment, read
from calibration.study import Calibration, FitOptions, Task, run
from calibration.table_of_paper import (
    Row,
    averages,
    fits_folder,
    measured,
    read_fit,
    rich_table,
    row,
    traced_beams,
    write_csv,
    write_markdown,
)

app = command()

EXAMPLES = """
[bold]Examples[/bold]

All six laws; fits that are missing in calibrations/bench are made first:

  python -m calibration.table measured/bench

Fits of your own, no new ones:

  python -m calibration.table measured/bench --fits fits/of-today --no-run --model neo-hookean,ogden

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
    out: Annotated[
        Path | None, typer.Option(help="Folder of table.csv and table.md. Default: that of the fits.")
    ] = None,
    run_missing: Annotated[
        bool, typer.Option("--run/--no-run", help="Make fits that are missing, or leave their rows empty.")
    ] = True,
    workers: Workers = None,
) -> None:
    """Table of calibration results, ours beside the paper's; writes table.csv and table.md."""
    with plain_ends():
        data = read(experiment)
        names = laws_in(model)
        materials = [m for m in data.materials if traced_beams(data, m)]
        if not materials:
            raise InputError(f"{experiment / 'experiment.yaml'}: expected at least one beam with an outline")
        for m in materials:
            if data.materials[m].density is None:
                raise InputError(
                    f"{experiment / 'experiment.yaml'}: materials.{m}.density_kg_m3: expected, since beams of"
                    " an unknown weight cannot be simulated"
                )
        home = fits or Path("calibrations") / experiment.resolve().name
        folder = fits_folder(home) if fits else home / "fits"
        found = {(law, m): read_fit(folder, data, m, law) for law in names for m in materials}
        bodies = {m: measured(data, m) for m in materials}
        console = Console()
        if run_missing:
            _fill(found, data, experiment, folder, processes(workers), console)
        rows = [
            row(law, fit, data, m, bodies[m], workers=workers)
            for (law, m), fit in track(
                list(found.items()), description="bodies", console=console, transient=True
            )
        ]
        target = out or home
        target.mkdir(parents=True, exist_ok=True)
        _write(rows, target, console, command=_command(experiment, fits, model, out, run_missing), data=data)
    raise typer.Exit(0 if all(r.measures for r in rows) else 1)


def _fill(
    found: dict[tuple[str, str], Calibration | None],
    data: Experiment,
    experiment: Path,
    folder: Path,
    workers: int,
    console: Console,
) -> None:
    """Make the fits that are missing, as calibration.fit makes them without options."""
    missing = [key for key, fit in found.items() if fit is None]
    tasks = [
        Task(
            experiment=experiment.resolve(),
            digest=data.digest,
            material=m,
            law=law,
            terms=1,
            options=FitOptions(),
            folder=folder,
        )
        for law, m in missing
    ]
    if not tasks:
        return
    with FitScreen(console) as screen:
        found.update(zip(missing, run(tasks, workers=workers, told=screen.update), strict=True))


def _write(rows: list[Row], target: Path, console: Console, *, command: str, data: Experiment) -> None:
    whole = [*rows, *averages(rows)]
    order = list(dict.fromkeys(r.law for r in rows))
    whole.sort(key=lambda r: order.index(r.law))  # stable: a law's average stands after its mixtures
    console.print(rich_table(whole))
    write_csv(target / "table.csv", whole)
    source = f"Experiment {data.name!r} (sha256 {data.digest[:16]})."
    write_markdown(target / "table.md", whole, command=command, source=source)
    console.print(f"{target / 'table.csv'}, {target / 'table.md'}", soft_wrap=True)


def _command(experiment: Path, fits: Path | None, model: str, out: Path | None, run_missing: bool) -> str:
    parts = ["python", "-m", "calibration.table", str(experiment)]
    parts += ["--fits", str(fits)] if fits else []
    parts += ["--model", model] if model != "all" else []
    parts += ["--out", str(out)] if out else []
    parts += [] if run_missing else ["--no-run"]
    return shlex.join(parts)


if __name__ == "__main__":
    app()
