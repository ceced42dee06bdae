"""Curves of a law: force over shear modulus at any of its materials, from simulations near one of them.

The force is exactly proportional to the shear modulus (quasi-static, without gravity) and smooth in the rest
of the law, its shape x; to first order about a shape x0 that is simulated,

    F(depth) = G f(depth) exp(sum_i dlnF/dx_i (x_i - x0_i)).

Shape coordinates are the law's search coordinates but the overall modulus, each as the force is most nearly
log-linear in it: G/K in place of K/G (the force of a near-incompressible block falls linearly in G/K), and of
several shear moduli the logarithms relative to the first.
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

# Curves are taken again where the shape has changed some force by more than this, relative: what is left out,
# of second order in it, is then far below the mesh's error.
NEAR = 2e-3
# Step in G/K for a derivative: at least this, a few per cent of force, far above the solver's tolerance.
COMPLIANCE_STEP = 0.02
STEP = 0.5  # in other coordinates, in their spread


@dataclass(frozen=True, eq=False, kw_only=True)
class ShapeCurve:
    """A geometry's curve at the shape x0, and how it changes with the shape.

    Attributes
    ----------
    base : at x0.
    derivatives : of ln F by the shape coordinates, at the depths of `base`, shape (n, f).
    reached : depth that all of its simulations reached [m].
    short : what became of a simulation that ended before its depth, as in "(bulk_ratio moved): status"; "".
    """

    base: Curve
    derivatives: Array
    reached: float
    short: str

    def at(self, change: Array) -> Curve:
        """At another shape, x - x0 = change (n,)."""
        factor = np.exp(change @ self.derivatives)
        return replace(self.base, along=factor * self.base.along, across=factor[:, None] * self.base.across)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Taken:
    """shape : x0, (n,). steps : of the derivatives, (n,)."""

    shape: Array
    steps: Array
    curves: Mapping[Geometry, ShapeCurve]


class LawCurves:
    """Curves of the materials of one law, for the geometries of some records.

    Parameters
    ----------
    law : in search coordinates; where it holds K/G, materials have that of a diagnosis. Parts beside it are
        left out, and their coordinates, which follow its own, do not count.
    records : whose geometries and depths are simulated.
    curves : simulates, and remembers.
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
        """True if there are curves yet."""
        return self._taken is not None

    def take(self, own: Array) -> None:
        """Simulate at the law's coordinates (n,), unless the shape is near enough to where it was done last.

        Raises
        ------
        ValueError : there is no equilibrium, or the law has no such material. Curves stay as they were.
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
        """Of a record's geometry at the law's coordinates (n,)."""
        taken = self._known()
        return taken.curves[record.geometry].at(self._shape(own) - taken.shape)

    def of(self, record: Record) -> ShapeCurve:
        """As taken last."""
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
        """Shape coordinates x (n,)."""
        found = []
        for k in self._free:
            if self.law.coordinates[k].name == "bulk_ratio":
                found.append(np.exp(-own[k]))
            else:
                found.append(own[k] - own[self._first] if self._moduli[k] else own[k])
        return np.array(found)

    def _moved(self, own: Array, k: int) -> Array:
        """The law's coordinates with one of them a step further, towards the inside of its range."""
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
        """With the shear modulus of all simulations."""
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
    """Shear modulus [Pa] whose forces are nearest to those of a material's records; 100 Pa at least. curves :
    of each record, over the shear modulus."""
    mine = [(r, c.at(r.depth)) for r, c in zip(records, curves, strict=True) if r.material == material]
    top = sum(float(unit @ r.force) for r, unit in mine)
    bottom = sum(float(unit @ unit) for _, unit in mine)
    return max(top / bottom, 100.0)
