"""How a short thick bar bends: a few shapes that hold its statics exactly and its lowest modes closely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from tisim import Circle, Rectangle

Array = NDArray[np.float64]

SHEARED = {"rectangle": 15.0 / 17.5, "circle": 0.9}  # Cowper's coefficients at a Poisson ratio of 1/2
YOUNG = 3.0  # over the shear modulus, of what keeps its volume
POINTS = 12  # of the Gauss quadrature along the bar


@dataclass(frozen=True, eq=False)
class Shapes:
    """Timoshenko's cantilever of unit length under a tip force, a tip moment and loads p = 1, x, x^2: moment
    and shear force (k, n) of each at n places, in a unit in which the tip force is one."""

    turn: Array  # (k, n): integral of the moment: section's rotation
    moment: Array
    shear: Array


def _polynomials() -> list[tuple[Polynomial, Polynomial, Polynomial]]:
    """turn, moment, shear of each load."""
    found = []
    one, x = Polynomial([1.0]), Polynomial([0.0, 1.0])
    for shear in (one, *((1.0 - x ** (m + 1)) / (m + 1) for m in range(3))):
        whole = shear.integ()
        moment = whole(1.0) - whole
        found.append((moment.integ(), moment, shear))
    found.insert(1, (x, one, Polynomial([0.0])))
    return found


def _coefficients() -> Array:
    """(3, k, degree + 1): of turn, moment and shear."""
    found = [[p.coef for p in shape] for shape in _polynomials()]
    degree = max(len(c) for shape in found for c in shape)
    return np.array([[np.pad(shape[i], (0, degree - len(shape[i]))) for shape in found] for i in range(3)])


_COEFFICIENTS = _coefficients()


def shapes_at(places: Array) -> Shapes:
    """places (n,): parts of the length."""
    powers = np.vander(places, _COEFFICIENTS.shape[2], increasing=True).T
    turn, moment, shear = _COEFFICIENTS @ powers
    return Shapes(turn, moment, shear)


@dataclass(frozen=True, kw_only=True)
class Section:
    """area [m2]; inertia, second moment about y [m4]; fourth: fourth moment over the second [m2]; sheared:
    Cowper's coefficient."""

    area: float
    inertia: float
    fourth: float
    sheared: float


def section_of(shape: Circle | Rectangle) -> Section:
    if isinstance(shape, Circle):
        r = shape.radius
        return Section(
            area=np.pi * r**2, inertia=np.pi * r**4 / 4.0, fourth=r**2 / 2.0, sheared=SHEARED["circle"]
        )
    w, h = shape.width, shape.height
    return Section(area=w * h, inertia=w * h**3 / 12.0, fourth=0.15 * h**2, sheared=SHEARED["rectangle"])


def gauss() -> tuple[Array, Array, Array]:
    """Places on (0, 1), weights, and the matrix (n, n) that integrates from 0 to each place."""
    x, w = np.polynomial.legendre.leggauss(POINTS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    powers = np.vander(x, increasing=True)
    upto = x[:, None] * powers / np.arange(1, POINTS + 1)
    return np.asarray(x), np.asarray(w), np.asarray(np.linalg.solve(powers.T, upto.T).T, dtype=np.float64)
