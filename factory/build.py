"""`python -m factory.build`: builds a dataset of simulated pokes."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console

from factory._build import Built, build, check_target
from factory._estimate import estimate
from factory._parts import building_folder
from factory._screen import Screen, effect_lines, fail, make_console, plan_table
from factory.errors import InputError, describe_os_error
from factory.materials import LAWS
from factory.plan import make_plan
from factory.recipe import load_recipe, recipe_names

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

A small dataset in minutes:

  python -m factory.build --model ogden --recipe quick

The paper's, 11 shapes x 3 softness levels x 40 pokes; first what it would take:

  python -m factory.build --model ogden --dry-run

  python -m factory.build --model ogden

Elsewhere, or on the workers of a dask cluster (tisim must be installed there):

  python -m factory.build --model mooney-rivlin --out /data/mr.zarr --workers 8

  python -m factory.build --model ogden --cluster tcp://10.0.0.5:8786

Stopped or killed, the same command goes on where it was.

Exit codes: 0 built, 1 built but some pokes failed, 2 bad input or target, 130 stopped by Ctrl-C.
"""


@app.command(epilog=EXAMPLES)
def main(
    model: Annotated[str, typer.Option(help=f"Constitutive law: {', '.join(LAWS)}.")],
    recipe: Annotated[
        str, typer.Option(help=f"A recipe by name ({', '.join(recipe_names())}) or a YAML file.")
    ] = "paper",
    out: Annotated[
        Path | None, typer.Option(help="The store to write. Default: datasets/RECIPE-MODEL.zarr.")
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume/--overwrite",
            help="Go on where an earlier run stopped, or simulate everything again "
            "(what is there stays until the new store is complete).",
        ),
    ] = True,
    workers: Annotated[int | None, typer.Option(min=1, help="Worker processes. Default: one a core.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only print the plan.")] = False,
    cluster: Annotated[
        str | None,
        typer.Option(help="Address of a dask scheduler, or 'local' for one on this machine."),
    ] = None,
    materials: Annotated[
        Path | None, typer.Option(help="Folder of material cards. Default: datasets/materials.")
    ] = None,
) -> None:
    """Builds a dataset of simulated pokes: a Zarr store with a preview picture beside it."""
    console = make_console()
    target = out
    try:
        plan = make_plan(load_recipe(recipe), model, materials)
        target = (out or Path("datasets") / f"{plan.recipe.name}-{model}.zarr").absolute()
        count = workers or os.cpu_count() or 1
        expected = estimate(plan, target, count)
        if dry_run:
            check_target(target)
            console.print(plan_table(plan, target, expected, count))
            return
        for name, text in effect_lines(plan):
            console.print(f"effect in {name}: {text}", markup=False)
        with _terminable(), Screen(plan, target, console, expected) as screen:
            built = build(
                plan, target, overwrite=not resume, workers=count, cluster=cluster, watch=screen.update
            )
            screen.finish(built)
    except InputError as error:
        fail(error)
    except OSError as error:
        fail(InputError(describe_os_error(error, "cannot use")))
    except KeyboardInterrupt:
        _say_stopped(target)
    if built.errors:
        _say_failed(built, console)
        raise typer.Exit(1)


@contextlib.contextmanager
def _terminable() -> Iterator[None]:
    """Lets SIGTERM end the build as Ctrl-C does."""

    def interrupt(_number: int, _frame: object) -> NoReturn:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _say_stopped(target: Path | None) -> NoReturn:
    kept = len(list((building_folder(target) / "parts").glob("poke-*.npz"))) if target else 0
    typer.echo(
        f"Stopped. {kept} finished pokes are kept; the same command (without --overwrite) goes on.",
        err=True,
    )
    raise typer.Exit(130)


def _say_failed(built: Built, console: Console) -> None:
    index, text = next(iter(built.errors.items()))
    console.print(
        f"{len(built.errors)} of {built.total} pokes failed (first: poke {index}: {text}); "
        "the same command tries them again.",
        style="yellow",
        markup=False,
    )


if __name__ == "__main__":
    app()
