"""Measured curves before and after the extension: what of them is drawn, and what it is called."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._state import State

Array = NDArray[np.float64]

MOST = 24  # trials of one picture of bars
NAMED, PARTIAL = "extended", "nearest of the library, not named"


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnCurve:
    """What is left of a trial's curve: measured less simulated, (k,), by the baseline and by the extension
    (None where there is none), and each point's own standard deviation, all in one SI unit."""

    name: str
    left_before: Array
    left_after: Array | None
    sd: Array

    @property
    def extended(self) -> bool:
        return self.left_after is not None

    def left(self, which: str) -> Array:
        """which: "before" or "after"."""
        return np.asarray(getattr(self, f"left_{which}"))

    def rms(self, which: str) -> float:
        return float(np.sqrt(np.mean(self.left(which) ** 2)))

    @property
    def size(self) -> float:
        """Its departure from the baseline, in standard deviations."""
        return float(np.sqrt(np.mean((self.left_before / self.sd) ** 2)))


def rms_of_all(curves: Sequence[DrawnCurve], which: str) -> float:
    return float(np.sqrt(np.mean(np.concatenate([c.left(which) for c in curves]) ** 2)))


def shown_explanation(diagnosis: Diagnosis) -> Explanation | None:
    """What stands for the extension: the chosen explanation; where nothing is named, what explains most of an
    unexplained departure."""
    finding = diagnosis.finding
    if diagnosis.chosen is not None:
        return diagnosis.chosen
    if diagnosis.nearest is not None:
        return diagnosis.nearest.explanation
    best = finding.explanations[0] if finding.explanations else None
    return best if finding.verdict == "unexplained" and finding.p_value < 0.01 else None


Evaluated = TypeVar("Evaluated")


def before_and_after(
    diagnosis: Diagnosis, evaluate: Callable[[State], Sequence[Evaluated]]
) -> list[tuple[Evaluated, Evaluated | None]]:
    """What a model predicts of each record by the baseline and by the extension (`shown_explanation`).

    Parameters
    ----------
    diagnosis : Diagnosis
    evaluate : callable
        Predictions at a state, one a record.

    Returns
    -------
    list of tuple
        One pair a record; the second is None, for all records alike, where nothing stands for the extension.
    """
    before = evaluate(diagnosis.finding.baseline.state)
    shown = shown_explanation(diagnosis)
    if shown is None:
        return [(b, None) for b in before]
    return list(zip(before, evaluate(shown.fit.state), strict=True))


def legend_of(diagnosis: Diagnosis) -> str:
    """What the lines after are called; empty where there are none."""
    shown = shown_explanation(diagnosis)
    if shown is None:
        return ""
    names = " + ".join(shown.names)
    return f"{NAMED if diagnosis.chosen is not None else PARTIAL} ({names})"


Drawn = TypeVar("Drawn", bound=DrawnCurve)


def most_telling(curves: Sequence[Drawn], most: int = MOST) -> tuple[list[Drawn], int]:
    """Those that are drawn, in the file's order, and how many depart too little for that."""
    largest = sorted(curves, key=lambda d: -d.size)[:most]
    return [d for d in curves if d in largest], len(curves) - len(largest)


def missing(count: int) -> str:
    """What a caption says of them."""
    if count == 1:
        return " 1 trial that departs less is not drawn."
    return f" {count} trials that depart less are not drawn." if count else ""
