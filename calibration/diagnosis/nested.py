"""Measurements with a simulator in which effects are nested, as the search for causes sees them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Candidate, Effect

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """u (n,): the baseline's free coordinates; amplitudes [SI] of the effects that are there."""

    u: Array
    amplitudes: Mapping[Candidate, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Linear:
    """A state's whitened residuals z (m,), their derivatives by u (m, n), and by candidates' amplitudes, one
    column each (m, c). Under the right model z is standard normal but for the coordinates fitted.
    unseen: part of a column's length that differences may leave of an exact alias (None: the usual)."""

    state: State
    z: Array
    by_u: Array
    columns: Array
    candidates: tuple[Candidate, ...]
    unseen: float | None = None


class Nested(Protocol):
    """names: of the coordinates u. points: how many of a residual's rows are measurements.
    patterns: what a departure that nobody thought of might look like, sets of columns (m, k) by name."""

    @property
    def names(self) -> tuple[str, ...]: ...

    @property
    def points(self) -> int: ...

    @property
    def candidates(self) -> tuple[Candidate, ...]: ...

    @property
    def effects(self) -> Mapping[str, Effect]: ...

    @property
    def most_causes(self) -> int:
        """That may be named together: more could stand in for a cause that is not in the catalogue."""

    def start(self) -> Array:
        """Coordinates to begin the baseline's fit from. ValueError where there are none."""

    def residuals(self, states: Sequence[State]) -> Array:
        """(batch, m): whitened residuals, NaN where a state has no answer."""

    def linearise(self, state: State, candidates: Sequence[Candidate]) -> Linear:
        """Derivatives at a state. ValueError where it has no answer."""

    def retake(self, state: State, *, rough: bool = False) -> None:
        """Take nuisances and discretisation errors anew at a state; linearisations from before are void.
        rough: what is dear may be left out."""

    def patterns(self) -> Mapping[str, Array]: ...
