"""Measured curves with predictions of baseline and extension: selection for figures, and labels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import rms_of
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._state import State

Array = NDArray[np.float64]

MOST = 24  # largest number of trials in a figure of bars
NAMED, PARTIAL = "extended", "nearest of the library, not named"


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnCurve:
    """Residuals of a trial's curve in one SI unit.

    Attributes
    ----------
    name : name of the trial.
    left_before : measured minus simulated with the baseline, shape (k,).
    left_after : the same with the extension; None if there is no extension.
    sd : standard deviation of each point, shape (k,).
    """

    name: str
    left_before: Array
    left_after: Array | None
    sd: Array

    @property
    def extended(self) -> bool:
        return self.left_after is not None

    def left(self, which: str) -> Array:
        """Residuals of "before" (baseline) or "after" (extension)."""
        return np.asarray(getattr(self, f"left_{which}"))

    def rms(self, which: str) -> float:
        return float(np.sqrt(np.mean(self.left(which) ** 2)))

    @property
    def size(self) -> float:
        """rms residual of the baseline in standard deviations."""
        return float(np.sqrt(np.mean((self.left_before / self.sd) ** 2)))


def rms_of_all(curves: Sequence[DrawnCurve], which: str) -> float:
    return rms_of(c.left(which) for c in curves)


def shown_explanation(diagnosis: Diagnosis) -> Explanation | None:
    """Explanation that is drawn as the extension.

    It is the chosen explanation, else the nearest one, else the best one if the data are unexplained and the
    p-value of the best cause is below 0.01. None otherwise.
    """
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
    """Predictions of each record by the baseline and by the extension (`shown_explanation`).

    Parameters
    ----------
    diagnosis : Diagnosis
    evaluate : callable
        Predictions at a state, one per record.

    Returns
    -------
    list of tuple
        One pair per record; the second entry is None in all pairs if there is no extension to show.
    """
    before = evaluate(diagnosis.finding.baseline.state)
    shown = shown_explanation(diagnosis)
    if shown is None:
        return [(b, None) for b in before]
    return list(zip(before, evaluate(shown.fit.state), strict=True))


def legend_of(diagnosis: Diagnosis) -> str:
    """Legend of the extension's curves; "" if there are none."""
    shown = shown_explanation(diagnosis)
    if shown is None:
        return ""
    names = " + ".join(shown.names)
    return f"{NAMED if diagnosis.chosen is not None else PARTIAL} ({names})"


Drawn = TypeVar("Drawn", bound=DrawnCurve)


def most_telling(curves: Sequence[Drawn], most: int = MOST) -> tuple[list[Drawn], int]:
    """The `most` curves with the largest residuals, in their original order, and the number of others."""
    largest = sorted(curves, key=lambda d: -d.size)[:most]
    return [d for d in curves if d in largest], len(curves) - len(largest)


def missing(count: int) -> str:
    """Sentence for a caption on trials that are not drawn; "" if there are none."""
    if count == 1:
        return " 1 trial that departs less is not drawn."
    return f" {count} trials that depart less are not drawn." if count else ""
