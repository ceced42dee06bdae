"""Common code of learn's commands: their applications, and the options that several of them have.

It imports nothing slow, so that `--help` is fast and needs no torch. Each command imports its modules when it
runs.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from learn import __version__
from learn.errors import InputError


def single(command: Callable[..., Any], epilog: str) -> typer.Typer:
    """Program of a single command, for `python -m learn.COMMAND`."""
    program = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)
    program.command(epilog=epilog)(command)
    return program


def load_plugins(files: list[Path]) -> None:
    """Import Python files that register metrics or models. InputError if one fails."""
    for number, file in enumerate(files):
        spec = importlib.util.spec_from_file_location(f"learn_plugin_{number}", file)
        if not file.is_file() or spec is None or spec.loader is None:
            raise InputError(f"--plugin {file}: expected a Python file")
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        try:
            spec.loader.exec_module(module)
        except InputError:
            raise
        except Exception as error:  # whatever the file does
            raise InputError(
                f"--plugin {file}: {type(error).__name__}: {' '.join(str(error).split())}"
            ) from error


def check_folder(folder: Path, option: str = "--out") -> None:
    """Raise InputError if the folder that a command is to write is a file."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{option} {folder}: expected the name of a folder, this is a file")


def _show_version(value: bool) -> None:
    if value:
        typer.echo(f"tisim {__version__}")
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
]
Plugins = Annotated[
    list[Path] | None,
    typer.Option(
        "--plugin", metavar="FILE", help="Python file that registers a metric or a model; repeatable."
    ),
]
Dataset = Annotated[str | None, typer.Option(help="Path of the dataset, if it has moved since training.")]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Number of CPU threads. Default: OMP_NUM_THREADS, else one per core."),
]
Device = Annotated[str, typer.Option(help="auto, cpu or cuda.")]
Runs = Annotated[
    list[Path], typer.Argument(help="Folders of runs, trained on one dataset.", metavar="RUN...")
]


def set_threads(threads: int | None) -> None:
    """Set torch's number of threads; None: OMP_NUM_THREADS, else one per core that this process may use.

    torchrun sets OMP_NUM_THREADS for its processes: with all cores in each they would slow each other down.
    """
    import torch

    if threads is None and os.environ.get("OMP_NUM_THREADS"):
        return  # torch has read it
    mine = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    torch.set_num_threads(threads or mine or 1)
