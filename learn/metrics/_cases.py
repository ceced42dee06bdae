"""What a metric sees: predictions beside the truth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Cases:
    """f frames, n points. SI units.

    truth, predicted: displacement (f, n, 3) [m]. force, force_predicted (f,) [N]. away: distance of each
    point's rest position from the rod's tip at first touch (f, n) [m]. depth (f,) [m]. poke: (f,) which
    poke each frame is of. softness: (f,) name. spread (f, n) [m], force_spread (f,) of ln(force): how far the
    members of an ensemble differ, 0 of one model.
    """

    truth: NDArray[np.float32]
    predicted: NDArray[np.float32]
    force: Floats
    force_predicted: Floats
    away: Floats
    depth: Floats
    poke: NDArray[np.int64]
    softness: NDArray[np.str_]
    spread: Floats = field(default_factory=lambda: np.zeros(0))
    force_spread: Floats = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not self.spread.size:
            object.__setattr__(self, "spread", np.zeros(self.away.shape))
        if not self.force_spread.size:
            object.__setattr__(self, "force_spread", np.zeros(self.depth.shape))

    @property
    def distance_mm(self) -> Floats:
        """Euclidean distance of predicted and true positions [mm], (f, n)."""
        wrong = self.predicted.astype(np.float64) - self.truth
        return np.asarray(np.sqrt((wrong**2).sum(axis=2)) * 1e3)

    def where(self, keep: NDArray[np.bool_]) -> Cases:
        """Some of the frames."""
        return Cases(**{name: getattr(self, name)[keep] for name in self.__dataclass_fields__})


def join_cases(parts: Sequence[Cases]) -> Cases:
    """The frames of all parts, in their order."""
    names = Cases.__dataclass_fields__
    return Cases(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


@dataclass(frozen=True, kw_only=True)
class Metric:
    """values: one number a frame (or a poke), NaN where it says nothing; percent: printed as such."""

    name: str
    units: str
    text: str
    values: Callable[[Cases], Floats]
    percent: bool = False
    digits: int = 3


METRICS: dict[str, Metric] = {}


def metric(
    name: str, *, units: str, text: str, percent: bool = False, digits: int = 3
) -> Callable[[Callable[[Cases], Floats]], Callable[[Cases], Floats]]:
    """Registers a function of cases as a metric."""

    def register(function: Callable[[Cases], Floats]) -> Callable[[Cases], Floats]:
        METRICS[name] = Metric(
            name=name, units=units, text=text, values=function, percent=percent, digits=digits
        )
        return function

    return register
