"""What the commands share: a console, errors as one sentence, durations as people say them."""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Iterator
from typing import NoReturn

import typer
from rich.console import Console

from learn.errors import InputError


def make_console() -> Console:
    """stdout; wide where it is no terminal, so that tables and paths stay whole."""
    return Console(soft_wrap=True, width=None if sys.stdout.isatty() else 170)


def fail(error: InputError) -> NoReturn:
    """The sentence on stderr, exit code 2."""
    typer.echo(f"error: {error}", err=True)
    raise typer.Exit(2)


@contextlib.contextmanager
def plain_errors() -> Iterator[None]:
    """InputError and failed file operations as one sentence, exit code 2."""
    try:
        yield
    except InputError as error:
        fail(error)
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        fail(InputError(f"cannot use{where}: {error.strerror or error}"))


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Lets SIGTERM end the work as Ctrl-C does."""

    def interrupt(_number: int, _frame: object) -> NoReturn:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def duration(seconds: float) -> str:
    """Seconds as people say them."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
