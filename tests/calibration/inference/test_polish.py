"""A polish ends when its steps bring no improvement."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calibration.inference import polish
from calibration.inference.polish import STALLED

Array = NDArray[np.float64]


class Slope:
    """One residual of 2 whose slope promises to remove it; each step lowers chi-square by `gain` alone."""

    parametrisation = SimpleNamespace(bounds=np.array([[-1e3, 1e3]]), spread=np.array([1.0]), names=("x",))

    def __init__(self, gain: float) -> None:
        self.chi2, self.gain, self.at = 4.0 + gain, gain, np.full(1, np.nan)

    def linearise(self, u: Array, *, rough: bool = False) -> bool:
        del u, rough
        return True

    def residuals(self, U: Array) -> Array:
        if len(U) == 1:
            self.at, self.chi2 = U[0], self.chi2 - self.gain
        return np.sqrt(self.chi2) - 0.1 * (U - self.at)


class Wall:
    """One residual, 1 - 0.1 x, that is least beyond the bound x = 0.5."""

    parametrisation = SimpleNamespace(bounds=np.array([[-1.0, 0.5]]), spread=np.array([1.0]), names=("x",))

    def linearise(self, u: Array, *, rough: bool = False) -> bool:
        del u, rough
        return True

    def residuals(self, U: Array) -> Array:
        return np.asarray(1.0 - 0.1 * U)


def test_what_lies_beyond_a_bound_is_no_gain() -> None:
    """At 0.49 a step to the bound gains 0.002 of chi-square; a free one would gain 0.9."""
    problem: Any = Wall()
    end = polish(problem, np.array([0.49]))
    assert end.converged
    assert end.steps == 1


@pytest.mark.parametrize(("gain", "steps"), [(0.003, STALLED + 1), (0.03, 30)])
def test_it_ends_where_ten_steps_gain_next_to_nothing(gain: float, steps: int) -> None:
    problem: Any = Slope(gain)
    end = polish(problem, np.zeros(1), max_steps=30)
    assert not end.converged
    assert end.steps == steps
    said = f"{STALLED} steps lowered chi-square by" if steps < 30 else "not converged in 30 steps"
    assert end.message.startswith(said)
