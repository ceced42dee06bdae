"""Progress of long work: one callback, `on_progress`, for training, adaptation and evaluation alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Progress:
    """State of the work.

    Attributes
    ----------
    stage : "training", "adaptation" or "evaluation".
    done, total : epochs, with the fraction of the current one, or steps.
    text : the current step, in words.
    values : the log line of the epoch that has just ended, else None.
    """

    stage: str
    done: float
    total: float
    text: str = ""
    values: Mapping[str, Any] | None = None


OnProgress = Callable[[Progress], None]


def ignore(_progress: Progress) -> None:
    """Callback that does nothing."""
