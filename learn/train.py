"""`python -m learn.train`: train a surrogate on a dataset of pokes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from learn._options import Device, Plugins, Threads, Version, load_plugins, set_threads, single
from learn._terminal import fail, make_console, plain_errors, terminable
from learn._training_screen import TrainingScreen

EXAMPLES = """
[bold]Examples[/bold]

A dataset of few shapes, in minutes:

  python -m learn.train datasets/quick-ogden.zarr --recipe quick

The surrogate on unseen shapes, first of five folds:

  python -m learn.train datasets/paper-ogden.zarr --recipe fast --fold 0

The paper's model and settings, on two GPUs:

  torchrun --nproc-per-node 2 -m learn.train datasets/paper-ogden.zarr --recipe paper

Stopped or killed, the same command with --resume goes on to the same result.

Exit codes: 0 trained, 1 diverged (the last good checkpoint stands), 2 bad input or no room to write,
130 stopped by Ctrl-C.
"""


def main(
    dataset: Annotated[str, typer.Argument(help="Dataset: a folder, a zip or an fsspec URL.")],
    recipe: Annotated[str, typer.Option(help="fast, quick, cegnn, paper, or a YAML file.")] = "fast",
    model: Annotated[
        str | None,
        typer.Option(help="Model, in place of the recipe's: invariant-gnn, invariant-gnn-small, cegnn."),
    ] = None,
    fold: Annotated[int | None, typer.Option(help="Fold, in place of the recipe's: 0 to 4.")] = None,
    split: Annotated[
        str | None, typer.Option(help="Split by shape or by site, in place of the recipe's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed, in place of the recipe's.")] = None,
    epochs: Annotated[int | None, typer.Option(help="Number of epochs, in place of the recipe's.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="The run's folder. Default: runs/RECIPE-MODEL-LAW-FOLD-SEED.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue an interrupted run.")] = False,
    device: Device = "auto",
    threads: Threads = None,
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Train a surrogate on a dataset; the epoch with the lowest validation error is kept."""
    console = make_console()
    with plain_errors():
        import torch

        from learn.data import open_store
        from learn.training import DivergedError, Trainer, load_recipe, make_process_group
        from learn.training.recipe import check_recipe

        load_plugins(plugin or [])
        set_threads(threads)
        os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")  # deterministic matrix products on a GPU
        torch.use_deterministic_algorithms(True, warn_only=True)
        changes = {"model": model, "fold": fold, "split": split, "seed": seed, "epochs": epochs}
        given = {key: value for key, value in changes.items() if value is not None}
        chosen = check_recipe({**load_recipe(recipe).model_dump(), **given}, "the command line")
        store = open_store(dataset)
        folder = out or Path("runs") / f"{chosen.name}-{chosen.model}-{store.law}-{chosen.fold}-{chosen.seed}"
        group = make_process_group(device)
        screen = TrainingScreen(console, folder, chosen, quiet=not group.is_main)
        try:
            with terminable(), screen.bar:
                trainer = Trainer(
                    store, chosen, folder, process_group=group, resume=resume, on_progress=screen.update
                )
                screen.begin(trainer)
                trainer.train()
        except DivergedError as error:
            good = "the last good checkpoint stands" if (folder / "last.pt").exists() else "nothing was kept"
            fail(f"diverged: {error}; {good} in {folder}", 1)
        except KeyboardInterrupt:
            next_step = (
                "the same command with --resume goes on"
                if (folder / "last.pt").exists()
                else "no epoch was finished: the same command begins again"
            )
            fail(f"Stopped; {next_step} ({folder}).", 130)
        except OSError as error:
            good = (
                "the last good checkpoint stands: the same command with --resume goes on"
                if (folder / "last.pt").exists()
                else "nothing was kept"
            )
            fail(f"error: cannot write {error.filename or folder}: {error.strerror or error}; {good}")
        finally:
            group.close()
        screen.end()


app = single(main, EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.train")
