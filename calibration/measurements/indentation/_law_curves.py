"""Force-depth curves of a law for any of its parameters, from simulations near one of them.

The force is exactly proportional to the shear modulus (quasi-static, without gravity) and smooth in the other
parameters of the law, its shape x. To first order about a simulated shape x0,

    F(depth) = G f(depth) exp(sum_i dlnF/dx_i (x_i - x0_i)).

The shape coordinates are the law's search coordinates without the overall modulus, transformed so that the
force is nearly log-linear in them: G/K in place of K/G (the force of a nearly incompressible block decreases
linearly in G/K), and the logarithms of several shear moduli relative to the first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.indentation._curve import Curve
from calibration.measurements.indentation._curve_cache import CurveCache, CurveRequest
from calibration.measurements.indentation._record import Record
from calibration.measurements.indentation._scene import BULK_RATIO, SHEAR, Geometry
from calibration.parameters import Parametrisation
from tisim import Material

Array = NDArray[np.float64]

# Curves are simulated again if a change of shape changes some force by more than this, relative: the error of
# second order is then far below the mesh error.
NEAR = 2e-3
# Least step in G/K for a derivative: a few per cent of the force, far above the solver's tolerance.
COMPLIANCE_STEP = 0.02
STEP = 0.5  # step in other coordinates, over their spread


@dataclass(frozen=True, eq=False, kw_only=True)
class ShapeCurve:
    """Curve of a geometry at the shape x0, with its derivatives by the shape.

    Attributes
    ----------
    base : curve at x0.
    derivatives : derivatives of ln F by the shape coordinates, at the depths of `base`, shape (n, f).
    reached : depth that all of its simulations reached [m].
    short : status of the simulation that ended first, as in " (bulk_ratio moved): status"; "" if all were
        complete.
    """

    base: Curve
    derivatives: Array
    reached: float
    short: str

    def at(self, change: Array) -> Curve:
        """Curve at another shape, x - x0 = change (n,)."""
        factor = np.exp(change @ self.derivatives)
        return replace(self.base, along=factor * self.base.along, across=factor[:, None] * self.base.across)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Taken:
    """Simulated curves; shape : x0, (n,). steps : finite-difference steps of the derivatives, (n,)."""

    shape: Array
    steps: Array
    curves: Mapping[Geometry, ShapeCurve]


class LawCurves:
    """Curves of the materials of one law, for the geometries of some records.

    Parameters
    ----------
    law : the law in search coordinates. If it holds K/G, materials have that of a diagnosis. Its parts and
        their coordinates, which follow those of the law, are ignored.
    records : records whose geometries and depths are simulated.
    curves : cache of simulated curves.
    """

    def __init__(self, law: Parametrisation, records: Sequence[Record], curves: CurveCache) -> None:
        self.law = law.without_parts()
        law = self.law
        self._records = tuple(records)
        self._cache = curves
        self._moduli = np.array([c.start is None for c in law.coordinates])
        self._first = int(np.argmax(self._moduli))
        self._free = [
            k
            for k, c in enumerate(law.coordinates)
            if k != self._first and not (c.name == "bulk_ratio" and c.held)
        ]
        self._taken: _Taken | None = None

    @property
    def taken(self) -> bool:
        """True if curves were simulated."""
        return self._taken is not None

    def take(self, own: Array) -> None:
        """Simulate at the law's coordinates (n,), unless the shape is close to that of the last simulations.

        Raises
        ------
        ValueError
            If there is no equilibrium, or the law has no such material. The curves stay unchanged.
        """
        own = own[: len(self.law.coordinates)]
        shape = self._shape(own)
        if self._taken is not None and self._near(self._taken, shape):
            return
        moved = [self._moved(own, k) for k in self._free]
        steps = np.array([(self._shape(m) - shape)[i] for i, m in enumerate(moved)])
        deepest: dict[Geometry, float] = {}
        for r in self._records:
            deepest[r.geometry] = max(r.deepest, deepest.get(r.geometry, 0.0))
        requests = [self._request(g, d, at) for g, d in deepest.items() for at in (own, *moved)]
        found = iter(self._cache.fetch(requests))
        curves = {
            g: self._with_derivatives(next(found), [next(found) for _ in moved], steps, d)
            for g, d in deepest.items()
        }
        self._taken = _Taken(shape=shape, steps=steps, curves=curves)

    def curve(self, record: Record, own: Array) -> Curve:
        """Curve of a record's geometry at the law's coordinates (n,)."""
        taken = self._known()
        return taken.curves[record.geometry].at(self._shape(own) - taken.shape)

    def of(self, record: Record) -> ShapeCurve:
        """Curve of a record's geometry from the last simulations."""
        return self._known().curves[record.geometry]

    def _known(self) -> _Taken:
        if self._taken is None:
            raise RuntimeError("call update_nuisances of an IndentationModel of a law before use")
        return self._taken

    def _near(self, taken: _Taken, shape: Array) -> bool:
        change = shape - taken.shape
        if not (np.abs(change) <= np.abs(taken.steps)).all():
            return False
        return all(
            float(np.abs(change @ c.derivatives).max(initial=0.0)) <= NEAR for c in taken.curves.values()
        )

    def _shape(self, own: Array) -> Array:
        """Shape coordinates x (n,) of law coordinates."""
        found = []
        for k in self._free:
            if self.law.coordinates[k].name == "bulk_ratio":
                found.append(np.exp(-own[k]))
            else:
                found.append(own[k] - own[self._first] if self._moduli[k] else own[k])
        return np.array(found)

    def _moved(self, own: Array, k: int) -> Array:
        """The law's coordinates with coordinate `k` perturbed by a step that stays in its range."""
        c, found = self.law.coordinates[k], own.copy()
        if c.name == "bulk_ratio":
            x = float(np.exp(-own[k]))
            step = max(COMPLIANCE_STEP, 0.5 * x)
            found[k] = -np.log(x + step if 1.0 / (x + step) >= c.low else 0.5 * x)
        else:
            step = STEP * c.spread
            found[k] += step if c.value(own[k] + step) <= c.high else -step
        return found

    def _request(self, geometry: Geometry, depth: float, own: Array) -> CurveRequest:
        material = self._material(own)
        if self.law.law == "neo-hookean" and np.isclose(self._bulk_ratio(own), BULK_RATIO, rtol=1e-12):
            return CurveRequest(geometry=geometry, depth=depth)
        parameters = " ".join(f"{n} {np.asarray(v).tolist()}" for n, v in material.parameters.items())
        return CurveRequest(
            geometry=geometry,
            depth=depth,
            name=f"{self.law.label} {parameters}",
            change=lambda poke, mesh: replace(poke, material=material, mesh=mesh),
        )

    def _material(self, own: Array) -> Material:
        """Material at the law's coordinates, scaled to the shear modulus of all simulations (SHEAR)."""
        found = own.copy()
        for k, c in enumerate(self.law.coordinates):
            if c.name == "bulk_ratio":
                found[k] = np.log(self._bulk_ratio(own))
        found[self._moduli] += np.log(SHEAR / self.law.moduli(found).shear_modulus)
        return self.law.material(found)

    def _bulk_ratio(self, own: Array) -> float:
        for k, c in enumerate(self.law.coordinates):
            if c.name == "bulk_ratio" and not c.held:
                return float(np.exp(own[k]))
        return BULK_RATIO

    def _with_derivatives(
        self, base: Curve, moved: Sequence[Curve], steps: Array, depth: float
    ) -> ShapeCurve:
        reached, short = base.reached, "" if base.reached >= depth - 1e-9 else f": {base.status}"
        derivatives = np.zeros((len(moved), base.depth.size))
        for i, (other, step) in enumerate(zip(moved, steps, strict=True)):
            sound = (base.along > 0.0) & (other.at(base.depth) > 0.0)
            derivatives[i, sound] = np.log(other.at(base.depth)[sound] / base.along[sound]) / step
            if other.reached < min(reached, depth - 1e-9):
                name = self.law.coordinates[self._free[i]].name
                reached, short = other.reached, f" ({name} moved): {other.status}"
        return ShapeCurve(base=base, derivatives=derivatives, reached=reached, short=short)


def nearest_modulus(material: str, records: Sequence[Record], curves: Sequence[Curve]) -> float:
    """Least-squares shear modulus [Pa] of a material's records, at least 100 Pa.

    curves : force over shear modulus of each record.
    """
    mine = [(r, c.at(r.depth)) for r, c in zip(records, curves, strict=True) if r.material == material]
    top = sum(float(unit @ r.force) for r, unit in mine)
    bottom = sum(float(unit @ unit) for _, unit in mine)
    return max(top / bottom, 100.0)
