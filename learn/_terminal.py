"""Terminal output of the commands: errors as one sentence, tables that fit, log messages."""

from __future__ import annotations

import contextlib
import logging
import signal
import sys
import time
from collections.abc import Iterator
from typing import NoReturn

import typer
from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar
from rich.table import Table
from rich.text import Text

from learn.errors import InputError
from learn.progress import OnProgress, Progress

LINE_SECONDS = 20.0  # between lines of progress where the output is no terminal

_PACKAGES = {
    "torch",
    "fsspec",
    "aiohttp",
    "zarr",
    "numcodecs",
    "scipy",
    "matplotlib",
    "jinja2",
    "yaml",
    "pydantic",
}


def make_console() -> Console:
    """Console on stdout without markup; wide if it is not a terminal, so that tables and paths stay whole."""
    width = None if sys.stdout.isatty() else 170
    return Console(soft_wrap=True, width=width, markup=False, highlight=False, emoji=False)


def fail(message: str, code: int = 2) -> NoReturn:
    """Print a message on stderr and exit with the code."""
    typer.echo(message, err=True)
    raise typer.Exit(code)


@contextlib.contextmanager
def plain_errors() -> Iterator[None]:
    """Show InputError, failed file operations and missing packages as one sentence, with exit code 2."""
    try:
        yield
    except ImportError as error:
        name = (error.name or "").partition(".")[0]
        if name not in _PACKAGES:
            raise
        fail(f"error: the package {name} is not installed: pip install 'tisim[learn]'")
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        fail(f"error: cannot use{where}: {error.strerror or error}")
    except InputError as error:
        fail(f"error: {error}")


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Make SIGTERM raise KeyboardInterrupt, as Ctrl-C does."""

    def interrupt(_number: int, _frame: object) -> NoReturn:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def duration(seconds: float) -> str:
    """Duration as text in s, min or h."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


@contextlib.contextmanager
def progress_bar(console: Console) -> Iterator[OnProgress]:
    """Callback that shows progress with the time left: a bar on a terminal, else a line every 20 s."""
    bar = Bar(
        BarColumn(),
        TextColumn("{task.completed:.0f} of {task.total:.0f} steps"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )
    task = bar.add_task("steps", total=None)
    began = line = time.monotonic()

    def update(state: Progress) -> None:
        nonlocal line
        bar.update(task, completed=state.done, total=state.total)
        now = time.monotonic()
        if not console.is_terminal and now - line > LINE_SECONDS:
            line = now
            left = duration((state.total - state.done) * (now - began) / state.done)
            console.print(f"{state.done:.0f} of {state.total:.0f} steps, about {left} left")

    with bar:
        yield update


def print_table(console: Console, title: str, heads: list[str], rows: list[list[str]]) -> None:
    """Print a table that fits the console: unchanged, else transposed, else in pieces of a few columns."""
    if not _fits(console, heads, rows) and len(rows) < len(heads):
        heads, *rows = ([str(cell) for cell in column] for column in zip(heads, *rows, strict=True))
    widths = [
        max(len(cell) for cell in column)
        for column in zip(*([_wrapped(h) for h in heads], *rows), strict=True)
    ]
    first = 1
    while first < len(heads):
        last, used = first, widths[0] + 3
        while last < len(heads) and (last == first or used + widths[last] + 3 <= console.width - 1):
            used += widths[last] + 3
            last += 1
        table = Table(title=Text(title))
        table.add_column(Text(heads[0]), no_wrap=True, min_width=widths[0])
        for head, width in zip(heads[first:last], widths[first:last], strict=True):
            table.add_column(Text(head), justify="right", min_width=width)
        for row in rows:
            table.add_row(*(Text(cell) for cell in (row[0], *row[first:last])))
        console.print(table)
        first = last


def _fits(console: Console, heads: list[str], rows: list[list[str]]) -> bool:
    """True if every column has room for its widest cell and for the longest word of its heading."""
    columns = zip(*([_wrapped(head) for head in heads], *rows), strict=True)
    return sum(max(len(cell) for cell in column) + 3 for column in columns) + 1 <= console.width


def _wrapped(head: str) -> str:
    return max(head.split() or [""], key=len)


class _ToConsole(logging.Handler):
    """Log handler that prints the library's messages on the console, one per line."""

    def __init__(self, console: Console) -> None:
        super().__init__()
        self._console = console

    def emit(self, record: logging.LogRecord) -> None:
        self._console.print(record.getMessage())


def log_to(console: Console) -> None:
    logger = logging.getLogger("learn")
    logger.handlers = [_ToConsole(console)]
    logger.setLevel(logging.INFO)
