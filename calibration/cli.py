"""Shared by the commands of calibration: options, progress, tables, error sentences, exit codes."""

from __future__ import annotations

import contextlib
import csv
import errno
import math
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer
from rich.box import SIMPLE
from rich.console import Console
from rich.live import Live
from rich.markup import escape
from rich.table import Table

from calibration._files import check_no_experiment
from calibration.errors import InputError, OptionError
from tisim import laws
from tisim.parallel.termination import terminable

if TYPE_CHECKING:
    from calibration.progress import FitProgress, OnProgress, Progress
    from calibration.study import Calibration

# Generations that a search takes as a rule, for the time left only.
_USUAL = 45

# package: the extra of tisim that brings it
EXTRAS = {
    "cv2": "photo",
    "openpyxl": "lab",
    "pooch": "fetch",
    "trimesh": "mesh",
    "rtree": "mesh",
    "manifold3d": "mesh",
    "pytetwild": "mesh",
}

VERBS = {
    "new": "an experiment from photographs, outlines or files of testing machines",
    "reconstruct": "photographs to outlines, mid lines and bodies",
    "fit": "material parameters of constitutive laws, with error bars, cards and a report",
    "diagnose": "what the simulation of an experiment lacks: names the cause, or says why not",
    "predict": "measured against predicted for trials that were not used, with intervals and skill",
    "export": "a material card for SOFA, FEBio, Abaqus, CalculiX, MuJoCo or Newton, with what is lost",
    "fetch": "public measurements from their sources, as experiments",
    "table": "the paper's table of calibration results for an experiment",
}


Measured = Annotated[Path, typer.Argument(help="Folder with experiment.yaml.")]
Laws = Annotated[str, typer.Option(help=f"Laws, separated by commas, or all: {', '.join(laws.names())}.")]
Workers = Annotated[int | None, typer.Option(help="Number of processes. Default: one per core.", min=1)]
Seed = Annotated[int, typer.Option(help="Seed of the random numbers, 0 or more.")]


def command() -> typer.Typer:
    """An application of one command, that shows faults of the program as Python does."""
    return typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)


def names_in(text: str) -> list[str]:
    """Names that are separated by commas; one with a comma is in double quotes."""
    return [n.strip() for n in next(csv.reader([text], skipinitialspace=True), []) if n.strip()]


@contextlib.contextmanager
def plain_ends(stopped: str = "Stopped: nothing was written.") -> Iterator[None]:
    """Ends of a command: InputError, and a file or disk that cannot be used, become one sentence on stderr
    and exit code 2; Ctrl-C and SIGTERM become the sentence `stopped` and exit code 130.

    Use it around all that a command does, as `with plain_ends(): ...` or as a decorator below
    `@app.command()`. Errors of any other kind are faults of the program and pass through.
    """
    try:
        with terminable():
            yield
    except OptionError as error:
        _end(f"error: {error.option}", 2)
    except ModuleNotFoundError as error:
        extra = EXTRAS.get((error.name or "").split(".")[0])
        if extra is None:
            raise
        _end(f"error: the package {error.name} is not installed: pip install 'tisim[{extra}]'", 2)
    except InputError as error:
        _end(f"error: {error}", 2)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            where = f" at {error.filename}" if error.filename else ""
            _end(f"error: no space is left on the disk{where}: free some, the same command goes on", 2)
        where = f" {error.filename}" if error.filename else ""
        _end(f"error: cannot use{where}: {error.strerror or error}", 2)
    except KeyboardInterrupt:
        _end(stopped, 130)


def _end(sentence: str, code: int) -> NoReturn:
    typer.echo(" ".join(sentence.split()), err=True)
    raise typer.Exit(code)


def check_folder(folder: Path, result: str, overwrite: bool) -> None:
    """Refuse the folder of an experiment, and of a `result` ("diagnosis": diagnosis.json) that is to stay."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"--out {folder}: expected a folder, found a file")
    check_no_experiment(folder)
    if (folder / f"{result}.json").exists() and not overwrite:
        raise InputError(f"--out {folder}: holds a {result} already; add --overwrite to replace it")


def elapsed(console: Console) -> OnProgress:
    """An `on_progress` callback that prints each message after the time since now."""
    begun = time.monotonic()

    def show(progress: Progress) -> None:
        console.print(
            f"[dim]{time.monotonic() - begun:6.1f} s[/dim]  {escape(str(progress))}", highlight=False
        )

    return show


class FitScreen:
    """A live table: fits done, generation and best cost of the running ones, time left."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self.live = Live(console=console, refresh_per_second=2, transient=True)
        self.begun = time.monotonic()
        self.before: int | None = None
        self.shown: set[str] = set()

    def __enter__(self) -> FitScreen:
        self.live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.live.__exit__(kind, error, trace)

    def update(self, progress: Any) -> None:
        """An `on_progress` callback of fits."""
        state: FitProgress = progress
        if self.before is None:
            self.before = len(state.ended)
        for name in state.ended.keys() - self.shown:
            self.console.print(escape(f"{name}: {_one_line(state.ended[name])}"), highlight=False)
            self.shown.add(name)
        table = Table(title=f"{len(state.ended)} of {state.total} fits, {self._left(state)}")
        for column in ("fit", "generation", "best chi-square"):
            table.add_column(column)
        for name, count in state.generations.items():
            if count:
                best = state.best.get(name)
                table.add_row(escape(name), str(count), "no answer yet" if best is None else f"{best:.1f}")
        self.live.update(table)

    def _left(self, state: FitProgress) -> str:
        parts = sum(min(0.9, n / _USUAL) for n in state.generations.values())
        done = len(state.ended) - (self.before or 0) + parts
        if done < 0.3:
            return "time left not known yet"
        todo = state.total - len(state.ended) - parts
        left = (time.monotonic() - self.begun) / done * todo
        return f"about {left / 60:.0f} min left" if left > 90 else f"about {left:.0f} s left"


def _one_line(r: Calibration) -> str:
    modulus = f", G {r.shear_modulus / 1e3:.3f} kPa" if r.shear_modulus == r.shear_modulus else ""
    return f"{r.status}{modulus}" + (f"; {r.reason}" if r.reason else "")


def law_table(results: Sequence[Calibration]) -> Table:
    """Materials and laws: moduli, misfit, held-out prediction and unidentified constants (kPa and mm).

    Columns of photographed beams are left out where there are none; held out is the worst of them.
    """
    from calibration.study.assessment import display_name

    beams = any(r.rms is not None or r.held_out for r in results)
    table = Table(title="Calibration", box=SIMPLE, pad_edge=False, collapse_padding=True)
    for column in ("material", "law", "status", "G / kPa", "chi2/n"):
        table.add_column(column, no_wrap=column != "status", min_width=11 if column == "status" else None)
    for column in (*(("rms / mm", "held out / mm") if beams else ()), "not identified"):
        table.add_column(column, min_width=5)
    for r in results:
        status = escape(r.status) if r.status == "converged" else f"[red]{escape(r.status)}[/red]"
        cells = [escape(r.material), escape(r.label), status]
        if not r.parameters:
            table.add_row(*cells, "-", "-", *(("-", "-") if beams else ()), escape(r.message))
            continue
        sd = r.shear_modulus_sd
        digits = 2 if not 0.0 < sd < 50.0 else 4 - math.floor(math.log10(sd))  # two of the sd in kPa
        value = f"{r.shear_modulus / 1e3:.{digits}f}"
        cells.append(value + (f" +- {sd / 1e3:.{digits}f}" if sd == sd else ""))
        cells.append(f"{r.reduced_chi2:.2f}" if r.mean_dice is None else f"Dice {r.mean_dice:.4f}")
        if beams:
            cells.append("-" if r.rms is None else f"{r.rms * 1e3:.3f}")
            cells.append(f"{max(h.rms for h in r.held_out) * 1e3:.2f}" if r.held_out else "-")
        unseen = [e for e in r.estimates if e.seen != "identified"]
        words = [f"{display_name(e.name)}{' (held)' if e.seen == 'held' else ''}" for e in unseen]
        table.add_row(*cells, ", ".join(words))
    return table
