"""What the command lines share: bad input and Ctrl-C end them in one sentence, without a traceback."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from typing import NoReturn

import typer

from calibration.errors import InputError


@contextlib.contextmanager
def plain_ends(stopped: str = "Stopped: nothing was written.") -> Iterator[None]:
    """InputError becomes its sentence on stderr and exit code 2, as does a file that cannot be used; Ctrl-C
    and SIGTERM become the sentence `stopped` and exit code 130.

    Use it around all that a command does, as `with plain_ends(): ...` or as a decorator below
    `@app.command()`. Errors of any other kind are faults of the program and pass through.
    """
    try:
        with _terminable():
            yield
    except InputError as error:
        _end(f"error: {error}", 2)
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        _end(f"error: cannot use{where}: {error.strerror or error}", 2)
    except KeyboardInterrupt:
        _end(stopped, 130)


def _end(sentence: str, code: int) -> NoReturn:
    typer.echo(" ".join(sentence.split()), err=True)
    raise typer.Exit(code)


@contextlib.contextmanager
def _terminable() -> Iterator[None]:
    """Lets SIGTERM end the work as Ctrl-C does (signals reach the main thread only)."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(_number: int, _frame: object) -> NoReturn:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
