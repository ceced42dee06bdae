"""Stress-strain curves of a compressed cylinder for any parameters of a law, interpolated between FEM runs.

A common factor on all moduli scales the stress, so that a curve divided by G depends on K/G and the law's
shape constant only: one or two coordinates, on Chebyshev nodes, between which the logarithm of the stress is
interpolated by polynomials. Free platens need no FEM: the body stays homogeneous.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BarycentricInterpolator, CubicSpline

import tisim
from calibration.measurements.homogeneous import nominal_stress
from calibration.parameters import parametrisation

Array = NDArray[np.float64]
Platens = Literal["bonded", "free"]

# Strains of the computed curves; the first one is below the range of the data.
STRAINS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.63, 0.66)
# Search range of the shape constants, narrower than for homogeneous tests: outside, runs fail.
SHAPES = {"second_share": (-0.2, 0.5), "alpha": (1.0, 6.0), "locking": (1.5, 8.0)}
BULK_RATIO = (20.0, 2000.0)
# Range of K/G in a fit: a silicone's is in the thousands, and below about 100 it affects the stress at large
# strain, where it would compensate errors of the law or of the platens.
FITTED_BULK_RATIO = (100.0, 2000.0)
_NODES = {"bulk_ratio": 3, "second_share": 4, "alpha": 5, "locking": 4}


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A cylinder; radius and height at rest [m]."""

    radius: float
    height: float


@dataclass(frozen=True, eq=False, kw_only=True)
class PressCurves:
    """Curves of one law with bonded or free platens.

    Attributes
    ----------
    law, platens, cylinder : arguments of `press_curves`.
    names : coordinates other than the shear modulus, in the order of the law.
    nodes : Chebyshev nodes of each coordinate, in the variables of the interpolation (`_inside`).
    stretches : stretches of the table, decreasing, shape (k,).
    table : ln of the stress relative to the homogeneous incompressible neo-Hookean's, shape (nodes ..., k).
    reached : smallest stretch that all runs reached.
    runs, runs_short : number of runs, and of those that stopped before the last strain.
    """

    law: str
    platens: Platens
    cylinder: Cylinder
    names: tuple[str, ...]
    nodes: tuple[Array, ...]
    stretches: Array
    table: Array  # ln of stress over G and over the homogeneous incompressible Neo-Hookean's, nodes... x k
    reached: float
    runs: int
    runs_short: int

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Search ranges of the coordinates other than the shear modulus, as values."""
        return [FITTED_BULK_RATIO if name == "bulk_ratio" else SHAPES[name] for name in self.names]

    def stress(self, stretch: ArrayLike, values: dict[str, float]) -> Array:
        """Nominal stress [Pa], negative, at stretches in [reached, 1).

        values : "shear_modulus" [Pa] and the coordinates in `names`. ValueError if a stretch is too small.
        """
        stretch = np.asarray(stretch, dtype=float)
        if stretch.size and stretch.min() < self.reached - 1e-9:
            raise ValueError(f"{self.law}: no curve below stretch {self.reached:g}, asked {stretch.min():g}")
        table = self.table
        for name, nodes in zip(self.names, self.nodes, strict=True):
            table = np.asarray(BarycentricInterpolator(nodes, table)(_inside(name, values[name])))
        spline = CubicSpline(self.stretches[::-1], table[::-1])
        return -values["shear_modulus"] * _plain(stretch) * np.exp(spline(stretch))

    def material(self, values: dict[str, float]) -> tisim.Material:
        return tisim.Material(law=self.law, parameters=parametrisation(self.law).assemble(values))


def press_curves(
    law: str, platens: Platens, cylinder: Cylinder, *, refinement: float = 1.0, workers: int | None = 1
) -> PressCurves:
    """Simulate a law at its nodes: 3 curves for a law of two moduli, 12 to 15 with a shape constant.

    If runs stop early, the curves end at the smallest strain that a run reached.

    Parameters
    ----------
    law : name of the law.
    platens : "bonded" or "free".
    cylinder : dimensions at rest.
    refinement : mesh refinement of `tisim.Press`.
    workers : number of processes of `tisim.simulate`.

    Raises
    ------
    ValueError
        If a run stops before the second strain.
    """
    names = tuple(c.name for c in parametrisation(law).coordinates if c.name != "shear_modulus")
    nodes = tuple(_chebyshev(name) for name in names)
    stretches = 1.0 - np.array(STRAINS)
    corners = [
        {"shear_modulus": 1e4} | {n: _outside(n, float(v)) for n, v in zip(names, values, strict=True)}
        for values in product(*nodes)
    ]
    materials = [tisim.Material(law=law, parameters=parametrisation(law).assemble(c)) for c in corners]
    if platens == "free":
        found = [nominal_stress(m, "uniaxial", stretches) for m in materials]
    else:
        scenes = [
            tisim.Press(
                material=material,
                radius=cylinder.radius,
                height=cylinder.height,
                stretches=tuple(stretches),
                refinement=refinement,
            )
            for material in materials
        ]
        results = tisim.simulate(scenes, workers=workers)
        found = [r.nominal_stress for r in results if r.nominal_stress is not None]
    counts = [int(np.argmin(np.append(np.isfinite(f) & (f < 0.0), False))) for f in found]
    least = min(counts)
    if least < 2:
        raise ValueError(f"{law}, {platens} platens: a run stops before a strain of {STRAINS[1]:g}")
    table = np.log(np.array([-f[:least] / 1e4 for f in found]) / _plain(stretches[:least]))
    return PressCurves(
        law=law,
        platens=platens,
        cylinder=cylinder,
        names=names,
        nodes=nodes,
        stretches=stretches[:least],
        table=table.reshape(*(len(n) for n in nodes), least),
        reached=float(stretches[least - 1]),
        runs=len(found),
        runs_short=sum(count < len(stretches) for count in counts),
    )


def _plain(stretch: Array) -> Array:
    """Nominal stress (compressive) of an incompressible neo-Hookean cylinder, G = 1, between free platens."""
    return stretch**-2 - stretch


def _range(name: str) -> tuple[float, float]:
    return BULK_RATIO if name == "bulk_ratio" else SHAPES[name]


def _inside(name: str, value: float) -> float:
    """Variable in which a curve is closest to a polynomial: a compliance in place of a stiffness."""
    return {"bulk_ratio": 1.0 / value, "locking": value**-2}.get(name, value)


def _outside(name: str, u: float) -> float:
    return {"bulk_ratio": 1.0 / u, "locking": abs(u) ** -0.5}.get(name, u)


def _chebyshev(name: str) -> Array:
    low, high = (_inside(name, v) for v in _range(name))
    n = _NODES[name]
    x = np.cos(np.pi * np.arange(n) / (n - 1))
    return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * x)
