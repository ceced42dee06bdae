"""An indentation's equilibrium holds for the sum of forces, not only for each node."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tisim.nonlinear.contact_newton import contact_newton
from tisim.result import Status

Array = NDArray[np.float64]


class Linear:
    can_stiffen = False

    def reset(self) -> None: ...

    def stiffen(self) -> None: ...

    def relax(self) -> None: ...


class Springs:
    """Nodes on unit springs [N/m] under an indenter force of 1 N; each step halves the displacement."""

    def __init__(self) -> None:
        self.linear = Linear()

    def potential(self, x: Array) -> tuple[float, float]:
        return 0.5 * float((x * x).sum()), 1.0

    def residual(self, x: Array) -> tuple[Array, float]:
        return x.copy(), 1.0

    def linearise(self, x: Array) -> tuple[Array, float]:
        return self.residual(x)

    def step(self, residual: Array, *, forcing: float) -> Array:  # noqa: ARG002
        return -0.5 * residual

    def advance(self, x: Array, step: Array) -> Array:
        return x + step

    def residual_norm(self, x: Array) -> float:
        return float(np.linalg.norm(x))

    def rod_force(self) -> float:
        return 1.0


@pytest.mark.parametrize(("alike", "kept", "steps"), [(True, True, 7), (True, False, 4), (False, True, 4)])
def test_residuals_that_all_point_one_way_are_no_frame(alike: bool, kept: bool, steps: int) -> None:
    nodes, tolerance = 4000, 5e-4
    x = np.zeros((nodes, 3))
    x[:, 2] = 1e-4 if alike else 1e-4 * (-1.0) ** np.arange(nodes)
    outcome = contact_newton(Springs(), x, tolerance=tolerance, max_iterations=20, kept=kept)  # type: ignore[arg-type]
    assert outcome.status is Status.CONVERGED
    assert outcome.residual <= tolerance
    assert (abs(outcome.x.sum()) <= 0.005) == (not alike or kept)
    # the residual norm is below the tolerance after 6.3e-3 has been halved four times
    assert outcome.iterations == steps
