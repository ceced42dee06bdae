"""`python -m factory.build`: build a dataset of simulated pokes."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from factory.bundled import recipe_names
from factory.cli import Plugins, import_plugins, make_app, make_console, shown_errors
from factory.errors import InputError
from tisim import laws
from tisim.options import Version
from tisim.parallel.termination import terminable

if TYPE_CHECKING:
    from rich.console import Console

    from factory.building.build import Built

EXAMPLES = """
[bold]Examples[/bold]

A small dataset in minutes:

  python -m factory.build --model ogden --recipe quick

The paper's, 11 shapes x 3 material levels x 40 pokes; first what it would take:

  python -m factory.build --model ogden --dry-run

  python -m factory.build --model ogden

With calibrated materials, of the recipe's names or of others:

  python -m factory.build --model ogden --recipe quick --materials fitted/cards

  python -m factory.build --model ogden --recipe quick --materials fitted/cards --levels Eco,Dragon

Elsewhere, or on the workers of a dask cluster (tisim must be installed there):

  python -m factory.build --model mooney-rivlin --out /data/mr.zarr --workers 8

  python -m factory.build --model ogden --cluster tcp://10.0.0.5:8786

Stopped or killed, the same command goes on where it was. With what there is so far, one of each shape and
material level after another, to look at or to train on:

  python -m factory.build --model ogden --partial

Exit codes: 0 built, 1 built but some pokes failed, 2 bad input or target, 130 stopped by Ctrl-C.
"""

RECIPES = ", ".join(recipe_names())
MODELS = ", ".join(laws.all_names())


def main(
    model: Annotated[str, typer.Option(help=f"Constitutive law: {MODELS}, or one that a plugin registers.")],
    recipe: Annotated[str, typer.Option(help=f"A recipe by name ({RECIPES}) or a YAML file.")] = "paper",
    out: Annotated[
        Path | None,
        typer.Option(
            help="The store to write. Default: datasets/RECIPE-MODEL.zarr under the current folder; with "
            "--materials, datasets/RECIPE-MODEL-FOLDER.zarr.",
            show_default=False,
        ),
    ] = None,
    materials: Annotated[
        Path | None,
        typer.Option(
            help="Folder of material cards. Default: those of the paper. Where it has none of the recipe's "
            "material levels, its own cards are the levels.",
            show_default=False,
        ),
    ] = None,
    levels: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,NAME,...", help="Material levels (names of cards), in place of the recipe's."
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume/--overwrite",
            help="Go on where an earlier run stopped, or simulate everything again "
            "(an old store stays until the new one is complete).",
        ),
    ] = True,
    partial: Annotated[
        bool,
        typer.Option(
            "--partial",
            help="Simulate nothing: write the store of the pokes that a stopped run has finished, the others "
            "marked as not done. The same command without it goes on.",
        ),
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Number of worker processes. Default: one per core.", show_default=False),
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Print the plan and exit.")] = False,
    cluster: Annotated[
        str | None,
        typer.Option(help="Address of a dask scheduler, or 'local' for one on this machine."),
    ] = None,
    cluster_timeout: Annotated[
        float,
        typer.Option(
            min=1.0,
            metavar="SECONDS",
            help="With --cluster: give up after this time without a scheduler or without a worker.",
        ),
    ] = 300.0,
    plugin: Plugins = None,
    version: Version = False,
) -> None:
    """Build a dataset of simulated pokes: a Zarr store, and a preview picture beside it."""
    del version
    target = out
    try:
        with shown_errors("cannot use"):
            import_plugins(plugin)

            from factory.building.build import build_dataset, check_target, warn_of_full_disk
            from factory.building.report import Screen, derived_levels, effect_lines, estimate, plan_table
            from factory.plan.dataset import make_plan
            from factory.recipe.model import load_recipe
            from tisim.parallel.pool import cores

            console = make_console()
            wanted = None if levels is None else split_names(levels)
            plan = make_plan(load_recipe(recipe), model, materials, levels=wanted)
            target = (out or default_target(plan.recipe.name, model, materials)).absolute()
            count = workers or cores()
            if partial and not resume:
                raise InputError("--partial: expected without --overwrite, which would discard what is there")
            check_target(target, overwrite=not resume)
            expected = estimate(plan, target, count, overwrite=not resume)
            if dry_run:
                console.print(plan_table(plan, target, expected, count))
                return
            for name in derived_levels(plan):
                console.print(f"material {name}: its card has no parameters of {model}: small-strain moduli.")
            for name, text in effect_lines(plan):
                console.print(f"effect in {name}: {text}")
            warn_of_full_disk(target, 2 * expected.size)
            with terminable(), Screen(plan, target, console, expected) as screen:
                built = build_dataset(
                    plan,
                    target,
                    overwrite=not resume,
                    partial=partial,
                    workers=count,
                    cluster=cluster,
                    cluster_timeout=cluster_timeout,
                    on_progress=screen.update,
                )
                screen.finish(built)
    except KeyboardInterrupt:
        _report_stopped(target)
    if built.errors:
        _report_failed(built, console, partial=partial)
        raise typer.Exit(1)


def split_names(text: str) -> list[str]:
    """Names with commas between; one that has a comma itself stands in double quotes."""
    return [name.strip() for name in next(csv.reader([text], skipinitialspace=True), [])]


def default_target(recipe: str, model: str, materials: Path | None) -> Path:
    """Default store: datasets/RECIPE-MODEL.zarr, with materials datasets/RECIPE-MODEL-FOLDER.zarr."""
    name = f"{recipe}-{model}"
    if materials is not None:
        folder = materials.absolute()
        part = folder.parent.name if folder.name in ("cards", "materials") else folder.name
        word = re.sub(r"[^A-Za-z0-9._-]+", "-", part).strip("-.")
        name += f"-{word or 'materials'}"
    return Path("datasets") / f"{name}.zarr"


def _report_stopped(target: Path | None) -> NoReturn:
    kept = 0
    if target is not None:
        from factory.store.staging import Staging

        kept = len(Staging(target.absolute()).finished())
    typer.echo(
        f"Stopped. {kept} finished pokes are kept; the same command (without --overwrite) goes on.",
        err=True,
    )
    raise typer.Exit(130)


def _report_failed(built: Built, console: Console, *, partial: bool) -> None:
    index, text = next(iter(built.errors.items()))
    console.print(
        f"{len(built.errors)} of {built.total} pokes failed (first: poke {index}: {text}); "
        f"the same command{' without --partial' if partial else ''} tries them again.",
        style="yellow",
    )


app = make_app(main, EXAMPLES)

if __name__ == "__main__":
    app()
