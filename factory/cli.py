"""Common code of the commands: applications, console, log, and errors of one sentence.

Imported before everything else of the factory, so that `--help` does not wait for the simulator.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from factory.errors import InputError, describe_os_error, one_line

if TYPE_CHECKING:
    from rich.console import Console


def make_app(command: Callable[..., None], epilog: str) -> typer.Typer:
    """Application of a single command, `python -m factory.NAME`."""
    app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)
    app.command(epilog=epilog)(command)
    return app


Plugins = Annotated[
    list[str] | None,
    typer.Option(
        "--plugin",
        metavar="MODULE",
        help="Import a Python module first: it registers laws or inclusion shapes. Repeatable.",
    ),
]


def import_plugins(modules: Sequence[str] | None) -> None:
    """Import modules that register laws or inclusion shapes; InputError names the one that fails."""
    for name in modules or ():
        try:
            importlib.import_module(name)
        except Exception as error:
            raise InputError(f"--plugin {name}: {type(error).__name__}: {one_line(error)}") from None


def make_console() -> Console:
    """A console on stdout that prints names as they are: no markup, no emoji codes.

    It is wide where stdout is no terminal, so that tables and paths stay whole.
    """
    from rich.console import Console

    width = None if sys.stdout.isatty() else 140
    return Console(soft_wrap=True, width=width, markup=False, emoji=False, highlight=False)


class _ToStderr(logging.Handler):
    """Log handler that writes to the current stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        typer.echo(self.format(record), err=True)


@contextlib.contextmanager
def shown_errors(doing: str) -> Iterator[None]:
    """Show the library's log on stderr, and errors that users can correct as one sentence with exit code 2.

    Parameters
    ----------
    doing : str
        Start of the sentence for an OSError, e.g. "cannot use".
    """
    logger, handler = logging.getLogger("factory"), _ToStderr()
    before = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    try:
        yield
    except InputError as error:
        fail(error)
    except BrokenPipeError:
        raise  # the reader of our output is gone: not an input error
    except OSError as error:
        fail(InputError(describe_os_error(error, doing)))
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before)


def fail(error: InputError) -> NoReturn:
    """Print the error on stderr and exit with code 2."""
    typer.echo(f"error: {error}", err=True)
    raise typer.Exit(2)


def duration(seconds: float) -> str:
    """Duration as text in s, min or h."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def counted(number: int, noun: str) -> str:
    """Number with its noun: "1 poke", "2 pokes"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def sides_text(blocks: Iterable[Sequence[float]]) -> str:
    """Sides of blocks, each as one number or as its least and largest: "100 x 70.1 to 130 x 32"."""
    ends = [(f"{min(side):g}", f"{max(side):g}") for side in zip(*blocks, strict=True)]
    return " x ".join(low if low == high else f"{low} to {high}" for low, high in ends)


def size_text(count: float) -> str:
    """Size as text in B, kB, MB or GB."""
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"
