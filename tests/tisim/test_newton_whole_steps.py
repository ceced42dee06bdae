"""Newton's method on systems that take full steps: it ends when an element inverts."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tisim.nonlinear.newton import newton
from tisim.result import Status

Array = NDArray[np.float64]


class Whole:
    """One node on a cubic spring, inverted beyond `edge`; every step leads directly to `aim`."""

    def __init__(self, *, aim: float, edge: float) -> None:
        self.aim, self.edge = aim, edge
        self.min_jacobian = 1.0
        self.asked = 0

    def potential(self, x: Array) -> tuple[float, float]:  # noqa: ARG002
        self.asked += 1
        return 0.0, 1.0

    def linearise(self, x: Array) -> tuple[Array, float]:
        self.min_jacobian = 1.0 if x[0, 0] < self.edge else 1e-5
        return x - 1.0, 1.0

    def step(self, residual: Array, *, forcing: float) -> Array:  # noqa: ARG002
        return np.where(np.arange(3) == 0, self.aim, 1.0)[None] - 1.0 - residual

    def second_step(self, residual: Array) -> Array | None:  # noqa: ARG002
        return None

    def advance(self, x: Array, step: Array) -> Array:
        return x + step

    def searches(self) -> bool:
        return False

    def residual_norm(self, x: Array) -> float:
        return float(np.linalg.norm(x - 1.0))

    def largest_step(self) -> float:
        return np.inf


def test_whole_steps_ask_for_no_potential() -> None:
    system = Whole(aim=1.0, edge=2.0)
    outcome = newton(system, np.zeros((1, 3)), tolerance=1e-9, max_iterations=5)
    assert outcome.status is Status.CONVERGED
    assert outcome.x == pytest.approx(1.0)
    assert system.asked == 0


def test_an_element_that_turns_over_ends_the_iteration_where_it_was_sound() -> None:
    start = np.zeros((1, 3))
    outcome = newton(Whole(aim=3.0, edge=2.0), start, tolerance=1e-9, max_iterations=5)
    assert outcome.status is Status.INVERTED
    assert np.array_equal(outcome.x, start)
    assert outcome.iterations == 1
