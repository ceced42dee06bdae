"""State of a fit: free coordinates of the baseline and amplitudes of effects; its linearisation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._effect import Candidate

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """Point in the parameter space of a fit.

    Attributes
    ----------
    u : free coordinates of the baseline, shape (n,).
    amplitudes : amplitudes of the effects that are present [SI].
    """

    u: Array
    amplitudes: Mapping[Candidate, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class Linearisation:
    """Whitened residuals and their derivatives at a state.

    Attributes
    ----------
    state : point of linearisation.
    z : whitened residuals, shape (m,); standard normal at the true parameters of the true model.
    by_u : derivatives by the coordinates u, shape (m, n).
    columns : derivatives by the candidates' amplitudes [1/SI], shape (m, c).
    candidates : candidates of the columns.
    alias_tolerance : fraction of a column's length that must remain after projection, or else the candidate
        counts as an alias; None for the default (`calibration.diagnosis.engine.screening`).
    """

    state: State
    z: Array
    by_u: Array
    columns: Array
    candidates: tuple[Candidate, ...]
    alias_tolerance: float | None = None
