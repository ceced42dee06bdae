"""Progress of long work, as `on_progress` callbacks of calibration receive it."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from calibration.study.calibration import Calibration

log = logging.getLogger("calibration")


@dataclass(frozen=True, kw_only=True)
class Progress:
    """A step of work; `str()` of it is a line for people.

    Attributes
    ----------
    message : str
        Step that was done, or is being done.
    done, total : int
        Pieces of work (fits, photographs) finished, and all of them; total is 0 where it is not known.
    """

    message: str = ""
    done: int = 0
    total: int = 0

    def __str__(self) -> str:
        count = f"{self.done} of {self.total}" if self.total else ""
        return ": ".join(p for p in (count, self.message) if p)


@dataclass(frozen=True, kw_only=True)
class FitProgress(Progress):
    """State of the fits of a study.

    Attributes
    ----------
    generations : mapping
        Generations done by an unfinished fit, by its name (MATERIAL-LAW).
    best : mapping
        Its lowest cost so far (chi-square with the prior's share).
    ended : mapping
        Calibrations of the finished fits, by name.
    """

    generations: Mapping[str, int] = field(default_factory=dict)
    best: Mapping[str, float] = field(default_factory=dict)
    ended: Mapping[str, Calibration] = field(default_factory=dict)


OnProgress = Callable[[Progress], None]
OnMessage = Callable[[str], None]  # progress of one piece of work, as a sentence


def to_log(progress: Progress) -> None:
    """The callback where none is given: one line in the log "calibration", level INFO."""
    log.info("%s", progress)
