"""What became of one simulated poke."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class PokeRun:
    """One simulated poke.

    trials: whose records it answers; change: the shape coordinate moved for a derivative, "" for the poke
    itself. asked, reached: depth [m]. dropped: measured points beyond `reached`. status: of `tisim.Status`.
    """

    trials: tuple[str, ...]
    change: str
    status: str
    message: str
    asked: float
    reached: float
    dropped: int
    core_seconds: float

    @property
    def short(self) -> bool:
        """It did not reach its record's depth."""
        return self.reached < self.asked - 1e-9

    def __str__(self) -> str:
        what = f"poke {', '.join(self.trials)}" + (f" ({self.change} moved)" if self.change else "")
        if not self.short:
            return f"{what}: {self.status} at {self.reached * 1e3:.2f} mm"
        return (
            f"{what}: {self.status} at {self.reached * 1e3:.2f} of {self.asked * 1e3:.2f} mm;"
            f" {self.dropped} measured points beyond it are not used"
        )
