"""The curve of a pressed cylinder at any parameters of a law, interpolated between finite element runs.

All moduli together only scale the stress, so a curve divided by G depends on K/G and the law's shape
constant: one or two coordinates, on Chebyshev nodes, between which the logarithm of the stress is a
polynomial. Free platens need no elements: the body stays homogeneous.
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

# Where curves are computed, as strains; the first is before any data are used.
STRAINS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.63, 0.66)
# Search range of the shape constants, narrower than a search on coupons has: outside, runs fail.
SHAPES = {"second_share": (-0.2, 0.5), "alpha": (1.0, 6.0), "locking": (1.5, 8.0)}
BULK_RATIO = (20.0, 2000.0)
# K/G that a fit may choose: a silicone's is in the thousands, and below some 100 it is felt at large strain,
# where it would hide what the law or the platens do wrong.
FITTED_BULK_RATIO = (100.0, 2000.0)
_NODES = {"bulk_ratio": 3, "second_share": 4, "alpha": 5, "locking": 4}


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """radius and height at rest [m]."""

    radius: float
    height: float


@dataclass(frozen=True, eq=False, kw_only=True)
class PressCurves:
    """Curves of one law between one kind of platens.

    names: of the coordinates besides the shear modulus, "bulk_ratio" first; nodes: of each, as interpolated.
    reached: smallest stretch that all runs reached; runs_short: how many of the `runs` stopped earlier.
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
        """What a fit may choose of the coordinates besides the shear modulus, as values."""
        return [FITTED_BULK_RATIO if name == "bulk_ratio" else SHAPES[name] for name in self.names]

    def stress(self, stretch: ArrayLike, values: dict[str, float]) -> Array:
        """Nominal stress [Pa], negative, at stretches in [reached, 1).

        values: "shear_modulus" [Pa] and the coordinates in `names`. ValueError below `reached`.
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
    """Run a law on its nodes: 3 curves for a law of two moduli, 12 to 15 with a shape constant.

    refinement: of the mesh, as in `tisim.Press`. Where a run stops early, `reached` is where the first did.
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
    """What the logarithm is taken of: incompressible Neo-Hookean of G = 1 in free compression."""
    return stretch**-2 - stretch


def _range(name: str) -> tuple[float, float]:
    return BULK_RATIO if name == "bulk_ratio" else SHAPES[name]


def _inside(name: str, value: float) -> float:
    """The coordinate in which a curve is closest to a polynomial: compliances, not stiffnesses."""
    return {"bulk_ratio": 1.0 / value, "locking": value**-2}.get(name, value)


def _outside(name: str, u: float) -> float:
    return {"bulk_ratio": 1.0 / u, "locking": abs(u) ** -0.5}.get(name, u)


def _chebyshev(name: str) -> Array:
    low, high = (_inside(name, v) for v in _range(name))
    n = _NODES[name]
    x = np.cos(np.pi * np.arange(n) / (n - 1))
    return np.asarray(0.5 * (low + high) + 0.5 * (high - low) * x)
