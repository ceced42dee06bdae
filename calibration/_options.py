"""What several commands are asked in the same words."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from calibration.errors import InputError
from tisim import laws

Measured = Annotated[Path, typer.Argument(help="Folder with experiment.yaml.")]
Laws = Annotated[str, typer.Option(help=f"Laws, separated by commas, or all: {', '.join(laws.names())}.")]
Workers = Annotated[int | None, typer.Option(help="Processes. Default: all cores.", min=1)]


def command() -> typer.Typer:
    """An application of one command, that shows faults of the program as Python does."""
    return typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)


def names_in(text: str) -> list[str]:
    """Names that are separated by commas."""
    return [n.strip() for n in text.split(",") if n.strip()]


def laws_in(model: str) -> list[str]:
    """Names of laws, each once; InputError where one is not known, or there is none."""
    names = list(laws.names()) if model == "all" else names_in(model)
    for name in names:
        if name not in laws.names():
            raise InputError(f"--model {name}: expected all or some of {', '.join(laws.names())}")
    if not names:
        raise InputError("--model: expected at least one law")
    return list(dict.fromkeys(names))


def processes(workers: int | None) -> int:
    return workers or os.cpu_count() or 1
