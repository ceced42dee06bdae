"""Internal stresses of a Prony series, for an isochoric stress that is linear in time over each step.

    Q_i(t + dt) = e_i Q_i(t) + g_i a_i (S(t + dt) - S(t)),
    e_i = exp(-dt/tau_i),    a_i = (1 - e_i) tau_i/dt

is exact for such a stress, and of second order in dt for a smooth one. A step with dt = 0 is a jump: a_i = 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.timed.material import Prony

Array = NDArray[np.float64]


class Memory:
    """Internal stresses of many points; arrays of stresses may have any shape, the same in each call.

    `begin(dt)` gives the terms of a step's stress: S + sum Q = scale S + history. `accept(S)` ends the step.
    """

    def __init__(self, prony: Prony, shape: tuple[int, ...]) -> None:
        self.prony = prony
        self._last = np.zeros(shape)
        self._q = np.zeros((len(prony.times), *shape))
        self._kept = self._gain = np.zeros(len(prony.times))

    def begin(self, dt: float) -> tuple[float, Array]:
        """Factor `scale` of the step's S, and `history`, an array like S."""
        x = dt / self.prony.tau
        self._kept = np.exp(-x)
        self._gain = self.prony.g * (-np.expm1(-x) / x if dt > 0.0 else np.ones_like(x))
        history = np.tensordot(self._kept, self._q, 1) - self._gain.sum() * self._last
        return 1.0 + float(self._gain.sum()), np.asarray(history)

    def accept(self, stress: Array) -> None:
        """End the step with isochoric stress S."""
        ones = (1,) * stress.ndim
        change = self._gain.reshape(-1, *ones) * (stress - self._last)
        self._q = self._kept.reshape(-1, *ones) * self._q + change
        self._last = stress.copy()


def step_times(stops: Array, shortest: float, growth: float) -> Array:
    """Ends of time steps in (0, stops[-1]], including `stops` [s], which are ascending.

    A step is growth (t + shortest/4) at time t, shortened to end at the next stop.
    """
    found: list[float] = []
    now = 0.0
    for stop in stops:
        while now < stop:
            step = growth * (now + 0.25 * shortest)
            left = stop - now
            now = stop if left <= 1.3 * step else now + min(step, 0.5 * left if left < 2.0 * step else step)
            found.append(float(now))
    return np.array(found)
