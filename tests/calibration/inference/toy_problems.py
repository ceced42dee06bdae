"""Problems with known solutions, without simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.inference import OfMaterial, Problem
from calibration.parameters import Parametrisation, parametrisation
from tisim import Material

Array = NDArray[np.float64]


class Curve:
    """Measurements y of f(material) with unit noise; the residuals are NaN if `fails(material)`."""

    name = "curve"

    def __init__(
        self,
        f: Callable[[Material], Array],
        y: Array,
        *,
        fails: Callable[[Material], bool] = lambda _: False,
    ) -> None:
        self.f, self.y, self.fails = f, y, fails
        self.batches: list[int] = []

    @property
    def points(self) -> int:
        return len(self.y)

    def size(self) -> int:
        return len(self.y)

    def residuals(self, materials: Sequence[Material]) -> Array:
        self.batches.append(len(materials))
        return np.array(
            [np.full(len(self.y), np.nan) if self.fails(m) else self.y - self.f(m) for m in materials]
        )


def mooney(m: Material) -> Array:
    """Nominal stress [in units of 50 Pa] of an incompressible Mooney-Rivlin strip in closed form."""
    c10, c01 = float(m.parameters["c10"]), float(m.parameters["c01"])  # type: ignore[arg-type]
    s = np.linspace(1.05, 2.5, 30)
    return np.asarray(2.0 * (s - s**-2) * (c10 + c01 / s) / 50.0)


def neo(m: Material) -> Array:
    """Ten measurements of ln(mu), each with standard deviation 0.01."""
    return np.full(10, 100.0 * np.log(float(m.parameters["mu"])))  # type: ignore[arg-type]


def of_curve(law: Parametrisation, curve: Curve) -> Problem:
    return Problem(parametrisation=law, objectives=(OfMaterial(law, curve),))


def mooney_problem(y: Array, **options: object) -> Problem:
    return of_curve(parametrisation("mooney-rivlin"), Curve(mooney, y, **options))  # type: ignore[arg-type]


def neo_problem(y: Array, **options: object) -> Problem:
    return of_curve(parametrisation("neo-hookean"), Curve(neo, y, **options))  # type: ignore[arg-type]
