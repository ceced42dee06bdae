"""The progress of a training on the terminal."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from learn._terminal import LINE_SECONDS, duration

if TYPE_CHECKING:
    from learn.progress import Progress as State
    from learn.training import Recipe, Trainer


class TrainingScreen:
    """Progress of a training: a bar on a terminal, otherwise a line every `LINE_SECONDS`."""

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
        fresh, total = state.done - self._first, int(state.total)
        left = (
            f"about {duration((total - state.done) * (now - self._began) / fresh)} left" if fresh > 0 else ""
        )
        if state.values is not None:
            line = state.values
            self._text = (
                f"loss {line['train_loss']:.4f}, validation {line['validation_mean_mm']:.4f} mm mean, "
                f"force {line['validation_force_relative']:.1%}"
            )
        epoch = f"epoch {min(int(state.done) + 1, total)} of {total}"
        self.bar.update(self._task, completed=state.done, epoch=epoch, text=self._text, left=left)
        last = state.done >= total
        if not self._console.is_terminal and state.values and (now - self._line > LINE_SECONDS or last):
            self._line = now
            self._console.print(f"{state.done:.0f} of {total} epochs: {self._text}, {left}")

    def end(self) -> None:
        if not self._quiet:
            self._console.print(
                f"{self._folder}: best.pt, last.pt, dataset.npz, log.jsonl; "
                f"next: python -m learn.evaluate {self._folder}"
            )
