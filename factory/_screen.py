"""What the build command shows: the plan, progress with time left, and the preview now and then."""

from __future__ import annotations

import io
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import NoReturn, Self

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from factory._build import Built
from factory._build import Progress as State
from factory._estimate import Estimate
from factory._parts import Parts
from factory._preview import Trace, draw_preview, preview_path
from factory._record import Outcome
from factory.errors import InputError
from factory.extension import TAKEN
from factory.plan import Plan

_LINE_SECONDS = 20.0  # between lines where the output is no terminal
_PICTURE_SECONDS = 120.0


def make_console() -> Console:
    """stdout; wide where it is no terminal, so that tables and paths stay whole."""
    return Console(soft_wrap=True, width=None if sys.stdout.isatty() else 140)


def fail(error: InputError) -> NoReturn:
    """The sentence on stderr, exit code 2."""
    typer.echo(f"error: {error}", err=True)
    raise typer.Exit(2)


def duration(seconds: float) -> str:
    """Seconds as people say them."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def size_text(count: float) -> str:
    """Bytes as people say them."""
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} {unit}" if unit == "B" else f"{count:.1f} {unit}"
        count /= 1000
    return f"{count:.1f} GB"


def plan_table(plan: Plan, target: Path, expected: Estimate, workers: int) -> Table:
    """The plan, as --dry-run prints it."""
    protocol = plan.recipe.protocol
    table = Table(title=f"Plan: recipe {plan.recipe.name}, {plan.model}", show_header=False)
    table.add_row("store", str(target))
    table.add_row("uuid", plan.uuid)
    table.add_row(
        "pokes",
        f"{len(plan.pokes)} = {len(plan.inclusions)} shapes x {len(plan.materials)} softness x "
        f"{plan.recipe.pokes_each} ({protocol.shared_sites} shared sites, {protocol.own_sites} own)",
    )
    table.add_row("to do", f"{expected.missing}")
    table.add_row("depth", f"{protocol.depth_mm:g} mm, a frame each {protocol.frame_spacing_mm:g} mm")
    table.add_row("nodes", f"about {expected.nodes} a poke (each has a mesh of its own)")
    source = "measured so far" if expected.measured else "typical of a 2-core machine"
    table.add_row(
        "expected time",
        f"about {duration(expected.seconds)} with {workers} workers "
        f"({expected.poke_seconds:.0f} s a poke, {source})",
    )
    table.add_row("expected size", f"about {size_text(expected.size)}, twice that while it is built")
    for name, material in zip(plan.recipe.softness, plan.materials, strict=True):
        values = ", ".join(f"{key} = {_show(value)}" for key, value in material.parameters.items())
        law = "" if material.law == plan.model else f"{material.law}: "
        table.add_row(f"material {name}", law + values)
    for name, text in effect_lines(plan):
        table.add_row(f"effect in {name}", text)
    return table


def effect_lines(plan: Plan) -> list[tuple[str, str]]:
    """Each effect of the cards: its mixture, and what becomes of it."""
    lines = []
    for card in plan.cards:
        for effect in card.effects:
            left = effect.left_out(card.material)
            word = f"not taken over: {left}" if left else f"taken over {TAKEN[effect.effect][1]}"
            lines.append((card.material, f"{effect.says()}: {word}"))
    return lines


def _show(value: float | tuple[float, ...]) -> str:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else f"{value:g}"


class Screen:
    """Progress of one build on a terminal (a bar) or elsewhere (a line now and then)."""

    def __init__(self, plan: Plan, target: Path, console: Console, expected: Estimate) -> None:
        self._plan, self._target, self._console, self._expected = plan, target, console, expected
        self._traces: dict[int, Trace] = {}
        self._began = self._line = self._picture = time.monotonic()
        self._first = 0
        self._bar = Progress(
            TextColumn("pokes"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[failed]}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            console=console,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("pokes", total=len(plan.pokes), failed="", left="")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def update(self, state: State, parts: Parts) -> None:
        """Called at the start and after each poke."""
        now = time.monotonic()
        if state.outcome is None:
            self._first = state.done
            for index in sorted(parts.done()):
                self._add(index, parts.part(index).read_bytes())
            self._console.print(f"Building {self._target}: {state.done} of {state.total} pokes are done.")
        else:
            self._keep(state.outcome)
        fresh = state.done + state.failed - self._first
        each = (now - self._began) / fresh if fresh else None
        todo = state.total - state.done - state.failed
        remaining = todo * each if each is not None else self._expected.seconds
        left = f"about {duration(remaining)} left"
        self._bar.update(
            self._task,
            completed=state.done,
            failed=f"{state.failed} failed" if state.failed else "",
            left=left,
        )
        if not self._console.is_terminal and (now - self._line > _LINE_SECONDS or todo == 0):
            self._line = now
            failed = f", {state.failed} failed" if state.failed else ""
            self._console.print(f"{state.done} of {state.total} pokes done{failed}, {left}")
        if now - self._picture > _PICTURE_SECONDS:
            self._draw()
            self._picture = time.monotonic()

    def finish(self, built: Built) -> None:
        """The last picture and where everything is."""
        if self._traces or not preview_path(self._target).exists():
            self._draw()
        new = f"{built.fresh} simulated now" if built.fresh else "nothing was left to simulate"
        self._console.print(
            f"{self._target}: {built.total - len(built.errors)} of {built.total} pokes ({new}); "
            f"preview {preview_path(self._target).name}"
        )

    def _keep(self, outcome: Outcome) -> None:
        if outcome.payload is not None:
            self._add(outcome.index, outcome.payload)

    def _add(self, index: int, payload: bytes) -> None:
        with np.load(io.BytesIO(payload)) as part:
            last = part["grid_displacement"][-1] if len(part["depth"]) else None
            self._traces[index] = Trace(
                depth=part["depth"],
                force=np.linalg.norm(part["rod_force"], axis=1),
                grid=last,
            )

    def _draw(self) -> None:
        try:
            draw_preview(self._plan, self._traces, preview_path(self._target))
        except OSError as error:  # a picture is not worth a build
            print(f"no preview picture: {error.strerror or error}", file=sys.stderr)
