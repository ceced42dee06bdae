"""`python -m learn.train DATASET`: trains a surrogate."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import Annotated

import torch
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from learn._screen import duration, make_console, plain_errors, terminable
from learn.data import open_store
from learn.models import MODELS
from learn.training import RECIPES, DivergedError, Recipe, Trainer, load_recipe
from learn.training import Progress as State
from learn.training._distributed import make_team
from learn.training.recipe import check_recipe

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

A dataset of few shapes, in minutes:

  python -m learn.train datasets/quick-ogden.zarr --recipe quick

Our model on unseen shapes, first of five folds:

  python -m learn.train datasets/paper-ogden.zarr --recipe fast --fold 0

The paper's model and settings, on two GPUs:

  torchrun --nproc-per-node 2 -m learn.train datasets/paper-ogden.zarr --recipe paper

Stopped or killed, the same command with --resume goes on to the same result.

Exit codes: 0 trained, 1 diverged (the last good checkpoint stands), 2 bad input, 130 stopped by Ctrl-C.
"""

_LINE_SECONDS = 20.0  # between lines where the output is no terminal


@app.command(epilog=EXAMPLES)
def main(
    dataset: Annotated[str, typer.Argument(help="The store: a folder or an fsspec URL.")],
    recipe: Annotated[str, typer.Option(help=f"{', '.join(RECIPES)}, or a YAML file.")] = "fast",
    model: Annotated[str | None, typer.Option(help=f"Instead of the recipe's: {', '.join(MODELS)}.")] = None,
    fold: Annotated[int | None, typer.Option(help="Instead of the recipe's: 0 to 4.")] = None,
    split: Annotated[str | None, typer.Option(help="Instead of the recipe's: shape or site.")] = None,
    seed: Annotated[int | None, typer.Option(help="Instead of the recipe's.")] = None,
    epochs: Annotated[int | None, typer.Option(help="Instead of the recipe's.")] = None,
    out: Annotated[Path | None, typer.Option(help="The run's folder. Default: runs/ and what it is.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on where an earlier run stopped.")] = False,
    device: Annotated[str, typer.Option(help="auto, cpu or cuda.")] = "auto",
    threads: Annotated[int | None, typer.Option(min=1, help="CPU threads. Default: one a core.")] = None,
) -> None:
    """Trains a surrogate and keeps the epoch that does best on the validation part."""
    torch.set_num_threads(threads or os.cpu_count() or 1)
    torch.use_deterministic_algorithms(True, warn_only=True)
    console = make_console()
    with plain_errors():
        changes = {"model": model, "fold": fold, "split": split, "seed": seed, "epochs": epochs}
        chosen = _changed(load_recipe(recipe), {k: v for k, v in changes.items() if v is not None})
        store = open_store(dataset)
        folder = out or Path("runs") / f"{chosen.name}-{chosen.model}-{store.law}-{chosen.fold}-{chosen.seed}"
        team = make_team(device)
        screen = _Screen(console, folder, chosen, quiet=not team.leads)
        try:
            with terminable(), screen.bar:
                trainer = Trainer(store, chosen, folder, team=team, resume=resume, watch=screen.update)
                screen.begin(trainer)
                trainer.train()
        except DivergedError as error:
            good = "the last good checkpoint stands" if (folder / "last.pt").exists() else "nothing was kept"
            typer.echo(f"diverged: {error}; {good} in {folder}", err=True)
            raise typer.Exit(1) from None
        except KeyboardInterrupt:
            typer.echo(f"Stopped; the same command with --resume goes on ({folder}).", err=True)
            raise typer.Exit(130) from None
        finally:
            team.close()
        screen.end()


def _changed(recipe: Recipe, changes: dict[str, object]) -> Recipe:
    return check_recipe({**recipe.model_dump(), **changes}, "the command line")


class _Screen:
    """A bar on a terminal, or a line now and then."""

    def __init__(self, console: Console, folder: Path, recipe: Recipe, *, quiet: bool) -> None:
        self._console, self._folder, self._recipe, self._quiet = console, folder, recipe, quiet
        self.bar = Progress(
            TextColumn("{task.fields[epoch]}"),
            BarColumn(),
            TextColumn("{task.fields[text]}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            console=console,
            disable=quiet or not console.is_terminal,
        )
        self._task = self.bar.add_task("train", total=recipe.epochs, epoch="", text="", left="")
        self._text = ""
        self._began = self._line = time.monotonic()
        self._first = 0

    def begin(self, trainer: Trainer) -> None:
        self._began, self._first = time.monotonic(), trainer.epoch
        if not self._quiet:
            parts = ", ".join(f"{len(v)} {k}" for k, v in trainer.split.groups.items())
            size = sum(p.numel() for p in trainer.model.parameters())
            self._console.print(
                f"{self._recipe.model}, {size} parameters; {len(trainer.split.train)} frames to train on; "
                f"groups: {parts}"
            )

    def update(self, state: State) -> None:
        if self._quiet:
            return
        now = time.monotonic()
        done = state.epoch + state.frames / state.frames_all
        fresh = done - self._first
        left = (
            f"about {duration((state.epochs - done) * (now - self._began) / fresh)} left" if fresh > 0 else ""
        )
        if state.line is not None:
            line = state.line
            self._text = (
                f"loss {line['train_loss']:.4f}, validation {line['validation_mean_mm']:.4f} mm mean, "
                f"force {line['validation_force_relative']:.1%}"
            )
        epoch = f"epoch {min(state.epoch + 1, state.epochs)} of {state.epochs}"
        self.bar.update(self._task, completed=done, epoch=epoch, text=self._text, left=left)
        last = state.epoch == state.epochs
        if not self._console.is_terminal and state.line and (now - self._line > _LINE_SECONDS or last):
            self._line = now
            self._console.print(f"{state.epoch} of {state.epochs} epochs: {self._text}, {left}")

    def end(self) -> None:
        if not self._quiet:
            self._console.print(
                f"{self._folder}: best.pt, last.pt, log.jsonl; next: python -m learn.evaluate {self._folder}"
            )


if __name__ == "__main__":
    app()
