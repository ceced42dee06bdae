"""A marker between the frames of a simulation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]


@dataclass(eq=False)
class Track:
    """A marker between frames, by cubic splines from the release on: displacement (f, 3), turn (f, 3, 3)."""

    time: Array
    displacement: Array
    turn: Array
    _spline: CubicSpline = field(init=False)

    def __post_init__(self) -> None:
        values = np.concatenate([self.displacement, self.turn.reshape(-1, 9)], axis=1)
        values = np.concatenate([np.zeros((1, 12)), values])
        start: tuple[Literal[1], Array] = (1, np.zeros(12))  # let go at rest: no velocity
        self._spline = CubicSpline(np.concatenate([[0.0], self.time]), values, bc_type=(start, "not-a-knot"))

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """Displacement (t, 3), turn (t, 3, 3), whether it has been let go (t,), at times since release."""
        after = (time > 0.0).astype(float)
        values = self._spline(np.clip(time, 0.0, self.time[-1])) * after[:, None]
        return values[:, :3], values[:, 3:].reshape(-1, 3, 3), after
