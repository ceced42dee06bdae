"""What people see while fits run, and the table that compares laws (kPa and mm)."""

from __future__ import annotations

import time
from types import TracebackType

from rich.console import Console
from rich.live import Live
from rich.table import Table

from calibration.study import Calibration, Progress

# Generations that a search takes as a rule, for the time left only.
_USUAL = 45


class FitScreen:
    """A live table: fits done, generation and best cost of the running ones, time left."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self.live = Live(console=console, refresh_per_second=2, transient=True)
        self.begun = time.monotonic()
        self.before: int | None = None
        self.told: set[str] = set()

    def __enter__(self) -> FitScreen:
        self.live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.live.__exit__(kind, error, trace)

    def update(self, progress: Progress) -> None:
        """Show where the fits stand."""
        if self.before is None:
            self.before = len(progress.ended)
        for name in progress.ended.keys() - self.told:
            r = progress.ended[name]
            self.console.print(f"{name}: {r.status}, G {r.shear_modulus / 1e3:.3f} kPa {r.message}".rstrip())
            self.told.add(name)
        table = Table(title=f"{len(progress.ended)} of {progress.total} fits, {self._left(progress)}")
        for column in ("fit", "generation", "best chi-square"):
            table.add_column(column)
        for name, count in progress.generations.items():
            if count:
                best = progress.best.get(name)
                table.add_row(name, str(count), "no answer yet" if best is None else f"{best:.1f}")
        self.live.update(table)

    def _left(self, progress: Progress) -> str:
        parts = sum(min(0.9, n / _USUAL) for n in progress.generations.values())
        done = len(progress.ended) - (self.before or 0) + parts
        if done < 0.3:
            return "time left not known yet"
        todo = progress.total - len(progress.ended) - parts
        left = (time.monotonic() - self.begun) / done * todo
        return f"about {left / 60:.0f} min left" if left > 90 else f"about {left:.0f} s left"


def law_table(results: list[Calibration]) -> Table:
    """Materials and laws: moduli, misfit, held-out prediction and what was not settled."""
    table = Table(title="Calibration")
    for column in ("material", "law"):
        table.add_column(column, no_wrap=True)
    for column in ("status", "G / kPa", "chi2/n", "rms / mm", "held out / mm", "not settled"):
        table.add_column(column)
    for r in results:
        if not r.parameters:
            table.add_row(r.material, r.label, r.status, "-", "-", "-", "-", r.message)
            continue
        sd = r.shear_modulus_sd
        modulus = f"{r.shear_modulus / 1e3:.2f}" + (f" +- {sd / 1e3:.2f}" if sd == sd else "")
        held = ", ".join(f"{h.rms * 1e3:.2f}" for h in r.held_out)
        table.add_row(
            r.material,
            r.label,
            r.status,
            modulus,
            f"{r.reduced_chi2:.2f}" if r.mean_dice is None else f"Dice {r.mean_dice:.4f}",
            "-" if r.rms is None else f"{r.rms * 1e3:.3f}",
            held or "-",
            ", ".join(e.name for e in r.estimates if e.seen != "identified"),
        )
    return table
